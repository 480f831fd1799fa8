#include "solvers/complementarity/projected_gauss_seidel.h"

#include <algorithm>

#include "core/base/interruption.h"
#include "solvers/laws/natural_residual.h"

namespace taut {

GaussSeidelOutcome ProjectedGaussSeidel::solve(std::span<const RowLaw> laws, std::span<const double> b,
                                               std::span<double> lambda, int max_sweeps, double tolerance) {
  impulses_.gather(lambda);
  GaussSeidelOutcome outcome;
  while (outcome.sweeps < max_sweeps && !outcome.converged) {
    detail::poll_interrupt();
    outcome.residual = 0;
    for (std::size_t r = 0; r < lambda.size(); ++r) {
      const int row = static_cast<int>(r);
      const double diagonal = impulses_.diagonal(row), w = impulses_.rate(row, b[r]);
      const double next = laws[r].project(diagonal, lambda[r], w);
      const double change = next - lambda[r];
      lambda[r] = next;
      impulses_.add(row, change);
      outcome.residual = std::max(outcome.residual, NaturalResidual(diagonal, change).size);
    }
    ++outcome.sweeps;
    outcome.converged = outcome.residual <= tolerance;
  }
  return outcome;
}

}  // namespace taut
