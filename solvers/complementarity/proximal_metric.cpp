#include "solvers/complementarity/proximal_metric.h"

#include <algorithm>

#include "solvers/complementarity/contact_newton_tuning.h"

namespace taut {

void ProximalMetric::begin(int rows) {
  sigma_.assign(rows, 0.0);
  carry_.assign(rows, 1.0);
}

void ProximalMetric::set(const Rows& rows, const ContactProblem& problem, double rho) {
  const std::span<const double> diagonal = problem.diagonal;
  for (int r = 0; r < rows.first_contact_row(); ++r)
    sigma_[r] = (problem.laws[r].bounded() ? rho : ContactNewtonTuning::kEqualityRho) * diagonal[r];
  for (int k = 0; k < rows.contact_count(); ++k) {
    const int row = problem.contacts.first_row(k);
    const auto alike = [&](int from, int count) {
      const double most = *std::max_element(diagonal.begin() + from, diagonal.begin() + from + count);
      std::fill_n(sigma_.begin() + from, count, rho * most);
    };
    const ContactLaws::Cone cone = problem.contacts.cone(k);
    alike(row, ContactLaws::kSpinRow);
    for (int i = 0; i < ContactLaws::kSpinRow; ++i) {
      const double softness = i == 0 ? cone.softness : cone.slip_softness;
      carry_[row + i] = sigma_[row + i] / (sigma_[row + i] + softness);
      sigma_[row + i] += softness;
    }
    if (!cone.twist) continue;
    alike(row + ContactLaws::kSpinRow, 1);
    alike(row + ContactLaws::kRollingRow, 2);
  }
}

}  // namespace taut
