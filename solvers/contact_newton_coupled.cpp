#include <algorithm>
#include <cmath>

#include "solvers/contact_newton.h"

// Rounds in which nothing of Coulomb's law is held fast.  (solvers/README, "Many contacts")
namespace taut {
namespace {

/// Vectors of GMRES, what that leaves of a residual, and what round-off is.
constexpr int kMostVectors = 80;
constexpr double kLinear = 1e-3, kBreakdown = 1e-14;
/// Rounds with lagged quantities before all is tried at once, with compliant contacts and without.
constexpr int kSoftTurns = 3, kTurns = 25;
/// After so many rounds with nothing lagged the residual must have fallen to this part.
constexpr int kLook = 4;
constexpr double kProgress = 0.5;

std::span<double> span_of(Eigen::VectorXd& v) { return {v.data(), static_cast<std::size_t>(v.size())}; }

}  // namespace

/// Some rounds with the lagged slip, which converge from anywhere; then with nothing lagged, as long as that
/// goes well; then with the lagged radius, and so on.
ContactNewton::Mode ContactNewton::next_mode(const Problem& problem, bool met, double residual, double& rho) {
  ++mode_rounds_;
  if (mode_ != Mode::kCoupled) {
    if (mode_rounds_ < (soft_ ? kSoftTurns : kTurns)) return mode_;
    begin_coupled(residual, rho);
    rho = std::max(rho, kNearRho);
    return Mode::kCoupled;
  }
  const bool look = mode_rounds_ % kLook == 0;
  if (met && (!look || residual <= kProgress * looked_residual_)) {
    if (look) looked_residual_ = residual;
    return mode_;
  }
  if (!met || residual > kept_residual_) {
    y_ = kept_;
    read_rates(problem);
    rho = kept_rho_;
  }
  mode_rounds_ = 0;
  lagged_ = lagged_ == Mode::kSlip ? Mode::kRadius : Mode::kSlip;
  return lagged_;
}

/// What there is to go back to.
void ContactNewton::begin_coupled(double residual, double rho) {
  mode_rounds_ = 0;
  kept_ = y_;
  kept_rho_ = rho;
  kept_residual_ = looked_residual_ = residual;
}

/// sum += Σ μ/Σ_n W_tᵀ W_n u over the contacts that slip.
void ContactNewton::add_coupling(const Eigen::VectorXd& u, Eigen::VectorXd& sum) const {
  const Rows& rows = system_.rows();
  using Six = Eigen::Matrix<double, 6, 1>;
  for (int k = 0; k < rows.contact_count(); ++k) {
    if (coupling_[k] == 0) continue;
    const Rows::JointRows& contact = rows.joints()[rows.contact_joint(k)];
    const auto sides = rows.sides().subspan(contact.first_side, contact.side_count);
    const auto row_of = [&](const auto& side, int row) {
      return Eigen::Map<const Six>(turned_.data() + side.offset + 6 * row);
    };
    double rate = 0;
    for (const auto& side : sides) rate += row_of(side, 0).dot(u.segment<6>(6 * side.body));
    rate *= coupling_[k] / sigma_[contact.first_row];
    for (const auto& side : sides) sum.segment<6>(6 * side.body) += rate * row_of(side, 1);
  }
}

/// (H + N) step = −gradient by GMRES [SaadSchultz1986] with H, the symmetric part that has a factor, on the
/// right: (1 + N H⁻¹) z = −gradient, step = H⁻¹ z.
void ContactNewton::coupled_step() {
  const double size = gradient_.norm();
  basis_.resize(kMostVectors + 1);
  Eigen::MatrixXd R = Eigen::MatrixXd::Zero(kMostVectors + 1, kMostVectors);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(kMostVectors + 1);
  std::vector<Eigen::JacobiRotation<double>> turns(kMostVectors);
  basis_[0] = -gradient_ / size;
  g[0] = size;
  int m = 0;
  while (m < kMostVectors && std::abs(g[m]) > kLinear * size) {
    step_ = basis_[m];
    system_.solve_bodies(span_of(step_));
    Eigen::VectorXd& next = basis_[m + 1];
    next = basis_[m];
    add_coupling(step_, next);
    for (int pass = 0; pass < 2; ++pass)
      for (int i = 0; i <= m; ++i) {
        const double c = basis_[i].dot(next);
        R(i, m) += c;
        next -= c * basis_[i];
      }
    const double rest = next.norm();
    R(m + 1, m) = rest;
    for (int i = 0; i < m; ++i) R.col(m).applyOnTheLeft(i, i + 1, turns[i].adjoint());
    turns[m].makeGivens(R(m, m), R(m + 1, m));
    R.col(m).applyOnTheLeft(m, m + 1, turns[m].adjoint());
    g.applyOnTheLeft(m, m + 1, turns[m].adjoint());
    ++m;
    if (!(rest > kBreakdown)) break;
    next /= rest;
  }
  const Eigen::VectorXd z = R.topLeftCorner(m, m).triangularView<Eigen::Upper>().solve(g.head(m));
  step_.setZero();
  for (int i = 0; i < m; ++i) step_ += z[i] * basis_[i];
  system_.solve_bodies(span_of(step_));
}

}  // namespace taut
