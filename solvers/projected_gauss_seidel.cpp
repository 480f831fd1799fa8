#include "solvers/projected_gauss_seidel.h"

#include <algorithm>
#include <cmath>

namespace taut {

ProjectedGaussSeidel::ProjectedGaussSeidel(const ConstraintSystem& system) : system_(system) {
  const Rows& rows = system.rows();
  row_start_.push_back(0);
  for (const Rows::JointRows& joint : rows.joints())
    for (int i = 0; i < joint.row_count; ++i) {
      for (int s = joint.first_side; s < joint.first_side + joint.side_count; ++s)
        if (!system.mass()[rows.sides()[s].body].fixed)
          row_sides_.push_back({rows.sides()[s].body, rows.sides()[s].offset + 6 * i});
      row_start_.push_back(static_cast<int>(row_sides_.size()));
    }
  diagonal_.assign(rows.row_count(), 0.0);
  bodies_.assign(6 * static_cast<std::size_t>(rows.body_count()), 0.0);
}

/// S_rr and Wᵀ λ.
void ProjectedGaussSeidel::gather(std::span<const double> lambda) {
  const double* W = system_.weighted().data();
  std::fill(bodies_.begin(), bodies_.end(), 0.0);
  for (std::size_t r = 0; r < lambda.size(); ++r) {
    diagonal_[r] = 0;
    for (int s = row_start_[r]; s < row_start_[r + 1]; ++s)
      for (int k = 0; k < 6; ++k) {
        const double entry = W[row_sides_[s].offset + k];
        diagonal_[r] += entry * entry;
        bodies_[6 * row_sides_[s].body + k] += entry * lambda[r];
      }
  }
}

GaussSeidelOutcome ProjectedGaussSeidel::solve(std::span<const RowLaw> laws, std::span<const double> b,
                                               std::span<double> lambda, int max_sweeps, double tolerance) {
  const double* W = system_.weighted().data();
  gather(lambda);
  GaussSeidelOutcome outcome;
  while (outcome.sweeps < max_sweeps && !outcome.converged) {
    outcome.residual = 0;
    for (std::size_t r = 0; r < lambda.size(); ++r) {
      double w = b[r];
      for (int s = row_start_[r]; s < row_start_[r + 1]; ++s)
        for (int k = 0; k < 6; ++k) w += W[row_sides_[s].offset + k] * bodies_[6 * row_sides_[s].body + k];
      const double next = laws[r].resolve(diagonal_[r], w - diagonal_[r] * lambda[r]).lambda;
      const double change = next - lambda[r];
      lambda[r] = next;
      for (int s = row_start_[r]; s < row_start_[r + 1]; ++s)
        for (int k = 0; k < 6; ++k)
          bodies_[6 * row_sides_[s].body + k] += W[row_sides_[s].offset + k] * change;
      outcome.residual = std::max(outcome.residual, std::sqrt(diagonal_[r]) * std::abs(change));
    }
    ++outcome.sweeps;
    outcome.converged = outcome.residual <= tolerance;
  }
  return outcome;
}

}  // namespace taut
