#pragma once

#include "core/world/world.h"
#include "solvers/system/linearized_rows.h"
#include "solvers/system/primal_system.h"

namespace taut {

/// Which of the two matrices is factored for the rows: the Delassus matrix S, or the primal matrix P where it
/// is the smaller one, because contacts are so many, or where so many axes have Coulomb friction that the
/// active set has to give way to Newton's method.  (solvers/system, "Primal matrix")
class PrimalChoice {
 public:
  PrimalChoice() = default;
  /// Counts the axes of these rows that have friction.
  PrimalChoice(const World& world, const Rows& rows);
  /// Decides for the present pattern of the rows.  `primal` is asked for its order if there are rows enough.
  void decide(const LinearizedRows& rows, PrimalSystem& primal);
  /// P, not S.
  bool primal() const { return primal_; }

 private:
  bool primal_pays(const LinearizedRows& rows, PrimalSystem& primal) const;

  int friction_axes_ = 0;  // with Coulomb friction
  bool primal_ = false;
};

}  // namespace taut
