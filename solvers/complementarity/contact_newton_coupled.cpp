#include <algorithm>
#include <cmath>

#include "solvers/complementarity/contact_newton.h"

// Rounds in which nothing of Coulomb's law is held fast.  (solvers/complementarity, "Many contacts")
//
// With y_t = P_disc(μ y_n)(x_t) the derivative of Newton's equation is H + N: H = 1 + Wᵀ D Σ⁻¹ W, the matrix
// of the other rounds, and N = Σ_k (μ/Σ_n) W_tᵀ W_n of rank one for each sliding contact, with W_t along its
// slip.  Radii of spinning and rolling follow y_n, too, but not in the derivative: their arms are small
// beside the bodies.  A slip that is one round behind contracts slowly where friction and normal forces
// depend on each other, and not at all where bodies wedge each other; there are directions in which impulses
// of the size of all others change rates by 1e-7, and ρ must become as small.
namespace taut {
namespace {

/// Vectors of GMRES, what that leaves of a residual, and what round-off is.
constexpr int kMostVectors = 80;
constexpr double kLinear = 1e-3, kBreakdown = 1e-14;
/// What is coupled, at least, where less of it has to do.
constexpr double kLeastPart = 0.25;
/// Rounds with lagged quantities before all is tried at once again, with compliant contacts and without.
constexpr int kSoftTurns = 3, kTurns = 25;
/// A round is kept if its Newton method ended and the residual grew by no more than this, or if the residual
/// fell to this part anyway.
constexpr double kWorse = 3, kProgress = 0.5;
/// Σ over S_rr: how it falls and grows, its bounds, and the rounds that must go well before it falls again.
constexpr double kDown = 0.3, kUp = 3, kLeastCoupledRho = 1e-8, kMostRho = 1e-2, kWell = 0.7, kFast = 0.1;
constexpr int kHold = 3;
/// After so many rounds the residual must have fallen to kProgress.
constexpr int kLook = 12;

}  // namespace

/// Rounds with nothing lagged as long as they go well; then with the lagged slip or radius, and so on.
ContactNewton::Mode ContactNewton::next_mode(const Problem& problem, bool met, double residual, double& rho) {
  ++mode_rounds_;
  if (mode_ != Mode::kCoupled) {
    if (mode_rounds_ < (soft_ ? kSoftTurns : kTurns)) return mode_;
    begin_coupled(residual);
    rho = std::max(rho, kNearRho);
    return Mode::kCoupled;
  }
  if (adapt(problem, met, residual, rho)) {
    if (mode_rounds_ % kLook != 0) return mode_;
    if (kept_residual_ <= kProgress * looked_residual_) {
      looked_residual_ = kept_residual_;
      return mode_;
    }
  }
  mode_rounds_ = 0;
  lagged_ = lagged_ == Mode::kSlip ? Mode::kRadius : Mode::kSlip;
  return lagged_;
}

/// There is no function that these rounds descend, but a Σ for which they end: it grows after a round that
/// did not, which is taken back, and falls again after some that did.  False if it can grow no more.
bool ContactNewton::adapt(const Problem& problem, bool met, double residual, double& rho) {
  if ((met && residual <= kWorse * kept_residual_) || residual <= kProgress * kept_residual_) {
    const bool well = residual <= kWell * kept_residual_, fast = residual <= kFast * kept_residual_;
    kept_ = y_;
    kept_residual_ = residual;
    if (!met)
      hold_ = 1;
    else if (hold_ > 0 && well)
      --hold_;
    else
      rho = std::max((fast ? kFast : kDown) * rho, kLeastCoupledRho);
    return true;
  }
  y_ = kept_;
  read_rates(problem);
  if (rho >= kMostRho) return false;
  rho = std::min(kUp * rho, kMostRho);
  hold_ = kHold;
  return true;
}

/// What there is to go back to; and room for the most vectors at once, so that a step that needs more of them
/// than those before allocates nothing.
void ContactNewton::begin_coupled(double residual) {
  basis_.resize(kMostVectors + 1);
  for (Eigen::VectorXd& direction : basis_) direction.resize(gradient_.size());
  krylov_.resize(kMostVectors + 1, kMostVectors);
  krylov_turns_.resize(kMostVectors);
  krylov_residual_.resize(kMostVectors + 1);
  mode_ = Mode::kCoupled;
  mode_rounds_ = hold_ = 0;
  kept_ = y_;
  kept_residual_ = looked_residual_ = residual;
}

/// sum += part Σ μ/Σ_n W_tᵀ W_n u over the contacts that slip.
void ContactNewton::add_coupling(double part, const Eigen::VectorXd& u, Eigen::VectorXd& sum) const {
  const Rows& rows = system_.rows();
  using Six = Eigen::Matrix<double, 6, 1>;
  for (int k = 0; k < rows.contact_count(); ++k) {
    if (coupling_[k] == 0) continue;
    const Rows::JointRows& contact = rows.joints()[rows.contact_joint(k)];
    const auto sides = rows.sides().subspan(contact.first_side, contact.side_count);
    const auto row_of = [&](const auto& side, int row) {
      return Eigen::Map<const Six>(turned_.data() + side.whole + 6 * row);
    };
    double rate = 0;
    for (const auto& side : sides) rate += row_of(side, 0).dot(u.segment<6>(6 * side.body));
    rate *= part * coupling_[k] / sigma_[contact.first_row];
    for (const auto& side : sides) sum.segment<6>(6 * side.body) += rate * row_of(side, 1);
  }
}

/// (H + N) step = −gradient, with less of N where that does not go down the gradient, as H alone does.
void ContactNewton::coupled_step() {
  for (double part = 1; part >= kLeastPart; part *= 0.5) {
    solve_coupled(part);
    if (step_.dot(gradient_) < 0) return;
  }
  step_ = -gradient_;
  system_.solve_bodies(span_of(step_));
}

/// (H + part N) step = −gradient by GMRES [SaadSchultz1986] with H, the symmetric part that has a factor, on
/// the right: (1 + part N H⁻¹) z = −gradient, step = H⁻¹ z.
void ContactNewton::solve_coupled(double part) {
  const double size = gradient_.norm();
  auto& R = krylov_;
  auto& g = krylov_residual_;
  auto& turns = krylov_turns_;
  basis_[0] = -gradient_ / size;
  g[0] = size;
  int m = 0;
  while (m < kMostVectors && std::abs(g[m]) > kLinear * size) {
    step_ = basis_[m];
    system_.solve_bodies(span_of(step_));
    Eigen::VectorXd& next = basis_[m + 1];
    next = basis_[m];
    R.col(m).setZero();
    g[m + 1] = 0;
    add_coupling(part, step_, next);
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
  R.topLeftCorner(m, m).triangularView<Eigen::Upper>().solveInPlace(g.head(m));
  step_.setZero();
  for (int i = 0; i < m; ++i) step_ += g[i] * basis_[i];
  system_.solve_bodies(span_of(step_));
}

}  // namespace taut
