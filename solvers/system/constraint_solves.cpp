#include <algorithm>

#include "solvers/system/constraint_system.h"

// Solves of a ConstraintSystem whose rows depend on each other.  (solvers/system, "Dependent rows")
namespace taut {

/// (S + Σ) x on the rows that are not masked, 0 on the others.
void ConstraintSystem::multiply_factored(std::span<const double> x, std::span<double> out) {
  multiply(x, out);
  const std::span<const double> states = factored_states_;
  for (std::size_t r = 0; r < states.size(); ++r)
    out[r] = states[r] == kMasked ? 0 : out[r] + states[r] * x[r];
}

void ConstraintSystem::project(std::span<double> x) {
  multiply_factored(x, scratch_);
  std::copy(scratch_.begin(), scratch_.end(), x.begin());
  backsolve(x);
}

}  // namespace taut
