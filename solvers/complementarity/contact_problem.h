#pragma once

#include <Eigen/Core>
#include <span>

#include "solvers/laws/contact_laws.h"
#include "solvers/laws/row_law.h"

namespace taut {

/// What the Newton method for contacts works on: w = S λ + b with the law of each row and contact, and the
/// sizes by which all is measured, which stay the same during a solve.  All spans have one entry a row.
struct ContactProblem {
  ContactLaws& contacts;
  std::span<const RowLaw> laws;
  std::span<const double> b;         ///< rates without λ [m/s or rad/s]
  std::span<double> lambda, w;       ///< a guess, then the result, and its rates
  std::span<const double> diagonal;  ///< S_rr; 1 where a row moves nothing
  std::span<const double> target;    ///< t: rates that equalities and contacts ask for
  double scale = 0;                  ///< size of impulses, the largest √S_rr |λ| and |b|/√S_rr [√J]
};

inline std::span<double> span_of(Eigen::VectorXd& v) {
  return {v.data(), static_cast<std::size_t>(v.size())};
}

}  // namespace taut
