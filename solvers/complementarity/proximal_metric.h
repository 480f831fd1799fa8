#pragma once

#include <span>
#include <vector>

#include "core/constraints/rows.h"
#include "solvers/complementarity/contact_problem.h"

namespace taut {

/// The diagonal metric Σ of a proximal round, one entry a row: ρ S_rr, for equalities a fixed part of S_rr,
/// one value in the three rows of a cone and in the two of a disc, so that they keep their shape.  The
/// compliance of a contact adds to it and stays when ρ goes.  (solvers/complementarity, Eq. 5)
class ProximalMetric {
 public:
  void begin(int rows);
  void set(const Rows& rows, const ContactProblem& problem, double rho);

  std::span<const double> sigma() const { return sigma_; }
  /// What part of Σ is the round's own, and not compliance: the factor of λ̄.
  std::span<const double> carry() const { return carry_; }

 private:
  std::vector<double> sigma_, carry_;
};

}  // namespace taut
