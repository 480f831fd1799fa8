#include "solvers/complementarity/coupled_step.h"

#include <cmath>

namespace taut {

void CoupledStep::reserve(Eigen::Index n) {
  basis_.resize(Tuning::kMostVectors + 1);
  for (Eigen::VectorXd& direction : basis_) direction.resize(n);
  triangle_.resize(Tuning::kMostVectors + 1, Tuning::kMostVectors);
  turns_.resize(Tuning::kMostVectors);
  residual_.resize(Tuning::kMostVectors + 1);
}

void CoupledStep::solve(const ContactProjection& projection, std::span<const double> sigma,
                        const Eigen::VectorXd& gradient, Eigen::VectorXd& step) {
  for (double part = 1; part >= Tuning::kLeastPart; part *= 0.5) {
    solve_part({projection, sigma, part}, gradient, step);
    if (step.dot(gradient) < 0) return;
  }
  step = -gradient;
  system_.solve_bodies(span_of(step));
}

void CoupledStep::solve_part(const Coupling& coupling, const Eigen::VectorXd& gradient,
                             Eigen::VectorXd& step) {
  const double size = gradient.norm();
  auto& R = triangle_;
  auto& g = residual_;
  basis_[0] = -gradient / size;
  g[0] = size;
  int m = 0;
  while (m < Tuning::kMostVectors && std::abs(g[m]) > Tuning::kLinear * size) {
    step = basis_[m];
    system_.solve_bodies(span_of(step));
    basis_[m + 1] = basis_[m];
    R.col(m).setZero();
    g[m + 1] = 0;
    add_coupling(coupling, step, basis_[m + 1]);
    const double rest = orthogonalize(m);
    R(m + 1, m) = rest;
    for (int i = 0; i < m; ++i) R.col(m).applyOnTheLeft(i, i + 1, turns_[i].adjoint());
    turns_[m].makeGivens(R(m, m), R(m + 1, m));
    R.col(m).applyOnTheLeft(m, m + 1, turns_[m].adjoint());
    g.applyOnTheLeft(m, m + 1, turns_[m].adjoint());
    ++m;
    if (!(rest > Tuning::kBreakdown)) break;
    basis_[m] /= rest;
  }
  R.topLeftCorner(m, m).triangularView<Eigen::Upper>().solveInPlace(g.head(m));
  step.setZero();
  for (int i = 0; i < m; ++i) step += g[i] * basis_[i];
  system_.solve_bodies(span_of(step));
}

/// Vector m + 1 without what it has of the others, by Gram–Schmidt twice; what is left.
double CoupledStep::orthogonalize(int m) {
  Eigen::VectorXd& next = basis_[m + 1];
  for (int pass = 0; pass < 2; ++pass)
    for (int i = 0; i <= m; ++i) {
      const double c = basis_[i].dot(next);
      triangle_(i, m) += c;
      next -= c * basis_[i];
    }
  return next.norm();
}

/// sum += part Σ μ/Σ_n W_tᵀ W_n u over the contacts that slip.
void CoupledStep::add_coupling(const Coupling& coupling, const Eigen::VectorXd& u,
                               Eigen::VectorXd& sum) const {
  const Rows& rows = system_.rows();
  using Six = Eigen::Matrix<double, 6, 1>;
  const double* turned = coupling.projection.turned().data();
  for (int k = 0; k < rows.contact_count(); ++k) {
    const double slope = coupling.projection.coupling(k);
    if (slope == 0) continue;
    const Rows::JointRows& contact = rows.joints()[rows.contact_joint(k)];
    const auto sides = std::span(rows.sides()).subspan(contact.first_side, contact.side_count);
    const auto row_of = [&](const auto& side, int row) {
      return Eigen::Map<const Six>(turned + side.whole + 6 * row);
    };
    double rate = 0;
    for (const auto& side : sides) rate += row_of(side, 0).dot(u.segment<6>(6 * side.body));
    rate *= coupling.part * slope / coupling.sigma[contact.first_row];
    for (const auto& side : sides)
      sum.segment<6>(6 * side.body) += rate * row_of(side, ContactLaws::kSlidingRow);
  }
}

}  // namespace taut
