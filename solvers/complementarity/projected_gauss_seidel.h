#pragma once

#include <span>

#include "solvers/complementarity/row_impulses.h"
#include "solvers/laws/row_law.h"

namespace taut {

struct GaussSeidelOutcome {
  int sweeps = 0;
  double residual = 0;  ///< largest natural residual in the last sweep, of each row before its change [√J]
  bool converged = false;  ///< residual within the tolerance
};

/// λ ∈ L(w) − c w, w = S λ + b, row by row: each in turn takes the one impulse that its law allows while the
/// others stay.  Never diverges (½ λᵀSλ + bᵀλ + ψ(λ) falls with every row), converges slowly: the iteration
/// of the game engines, here for comparison and as a fall-back.
class ProjectedGaussSeidel {
 public:
  explicit ProjectedGaussSeidel(ConstraintSystem& system) : impulses_(system) {}

  /// S = W Wᵀ with the W of the system's last factorize().  λ is the start and the result; stops when no row
  /// changes by more than `tolerance` [√J].
  GaussSeidelOutcome solve(std::span<const RowLaw> laws, std::span<const double> b, std::span<double> lambda,
                           int max_sweeps, double tolerance);

 private:
  RowImpulses impulses_;
};

}  // namespace taut
