#pragma once

#include <span>
#include <vector>

#include "solvers/common/settings.h"
#include "solvers/common/step_report.h"
#include "solvers/integrators/phase.h"
#include "solvers/integrators/row_values.h"
#include "solvers/integrators/start_jacobian.h"
#include "solvers/system/constraint_system.h"

namespace taut {

/// Diagonal of the box around all bodies, but at least 1 m.
double system_size(std::span<const Pose> poses);

/// Positions of dependent rows: how far they are from closed, and closing what the step's own Newton cannot.
/// (solvers/integrators, "Weak directions")
class PositionProjection {
 public:
  /// All of them must outlive it.
  PositionProjection(ConstraintSystem& system, const Settings& settings, StartJacobian& start, Phase& phase,
                     RowValues& values);

  /// How far the bodies are from closed joints, to first order: the largest move in M⁻¹ Jᵀ S_ε⁻¹ φ [m or
  /// rad].  Leaves S_ε⁻¹ φ in values.delta.
  double distance_to_closure(SubstepReport& report);
  /// Gauss–Newton on the positions alone, q₁ ← q₁ − M⁻¹Jᵀ S⁺ φ with all of it at the iterate.  It converges
  /// quadratically, also along directions that the rows hold weakly, where the fixed J(q₀) of the step's
  /// Newton does not: there J(q₁) − J(q₀) outweighs J itself.
  /// @returns whether φ is within position_tolerance; poses and φ are the best that were found.
  bool close(double h, SubstepReport& report);

 private:
  ConstraintSystem& system_;
  const Settings& settings_;
  StartJacobian& start_;
  Phase& phase_;
  RowValues& values_;
  std::vector<Wrench> move_;  // M times a move of the bodies
  std::vector<Pose> best_;
};

}  // namespace taut
