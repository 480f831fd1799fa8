#pragma once

#include <vector>

#include "solvers/integrators/row_values.h"
#include "solvers/laws/contact_forces.h"
#include "solvers/system/constraint_system.h"

namespace taut {

/// Multipliers of the steps before, as a guess for a start in the same or in another pattern.
class MultiplierGuess {
 public:
  MultiplierGuess(const Rows& rows, const RowValues& values);

  /// To the rows of the same joints, and of the contacts that `contacts` has inherited.
  void give(const Rows& rows, const ContactForces& contacts, RowValues& values) const;

 private:
  std::vector<Rows::JointRows> joints_;
  int contacts_ = 0;
  std::vector<double> forces_, lambda_;
};

}  // namespace taut
