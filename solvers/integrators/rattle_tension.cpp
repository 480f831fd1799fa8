#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/integrators/rattle.h"
#include "solvers/integrators/tension.h"

// How tension bounds the step, or is taken implicitly.  (solvers/integrators, "Tension")
namespace taut {
namespace {

constexpr int kFixed = 0;  ///< the ground, with all bodies that stick to it

/// Whether no eigenvalue of a symmetric K is negative but for round-off: the pivots of K + ε tr(K) 1₃ are
/// positive.
bool is_semidefinite(const Mat3& K) {
  constexpr double kStiffnessRoundOff = 1e-14;
  const double shift = kStiffnessRoundOff * K.trace();
  const double a = K(0, 0) + shift, b = K(1, 0), c = K(2, 0);
  if (!(shift > 0 && a > 0)) return false;
  const double d = K(1, 1) + shift - b * b / a, e = K(2, 1) - b * c / a;
  return d > 0 && K(2, 2) + shift - c * c / a - e * e / d > 0;
}

}  // namespace

/// The step that keeps ω h ≤ max_tension_number and every body's rotation below max_rotation.
void Rattle::update_step_limit(std::span<const double> force_multipliers) {
  step_limit_ = std::numeric_limits<double>::infinity();
  omega_ = 0;
  if (settings_.tension != TensionPolicy::kIgnore && !iterative()) {  // whose multipliers are no measure
    find_held_bodies();
    const std::span<StiffnessBlocks> stiffness = stiffness_;
    for (const Rows::Piece& piece : system_.rows().pieces()) {
      for (StiffnessBlocks& block : stiffness.subspan(piece.begin, piece.end - piece.begin)) block = {};
      system_.rows().stiffness(state_, force_multipliers, stiffness, piece);
      const int settled = piece.settled_begin, count = piece.settled_end - settled;
      if (holds_bodies_) clear_held_bodies(settled, piece.settled_end);
      omega_ = std::max(omega_, fastest_transverse_frequency(system_.mass_roots().subspan(settled, count),
                                                             stiffness.subspan(settled, count)));
    }
    if (settings_.tension == TensionPolicy::kSubstep && omega_ > 0)
      step_limit_ = settings_.max_tension_number / omega_;
  }
  double spin2 = 0;
  for (const Twist& V : state_.twists) spin2 = std::max(spin2, V.w.squaredNorm());
  if (spin2 > 0) step_limit_ = std::min(step_limit_, settings_.max_rotation / std::sqrt(spin2));
}

BodyId Rattle::stiffest() const {
  BodyId stiffest;
  double largest = 0;
  for (int b = 0; b < world_.body_count(); ++b) {
    const double omega =
        fastest_transverse_frequency(system_.mass_roots().subspan(b, 1), std::span(stiffness_).subspan(b, 1));
    if (omega > largest) largest = omega, stiffest = {b};
  }
  return stiffest;
}

/// Bodies that friction holds to the ground, directly or through others, do not move whatever their load.
/// Only where a step in which it lets go is looked at again.
void Rattle::find_held_bodies() {
  holds_bodies_ = false;
  if (!stages_.friction_dominated() || has_drivers_ || settings_.tension != TensionPolicy::kSubstep ||
      settings_.integrator == Integrator::kMoreauJean)
    return;
  const Rows& rows = system_.rows();
  held_rows_.assign(rows.row_count(), 1);
  axes_.clear_loose(held_rows_);
  for (int r : breaking_.rows()) held_rows_[r] = 0;
  // Sets of bodies that stick together; fixed ones are in that of the ground.
  constexpr int kLocked = 6;
  stuck_together_.reset(world_.body_count());
  for (int b = 0; b < world_.body_count(); ++b)
    if (system_.mass()[b].fixed) stuck_together_.join(kFixed, b);
  for (const Rows::JointRows& joint : rows.joints()) {
    const auto first = held_rows_.begin() + joint.first_row;
    if (joint.side_count != 2 || joint.row_count != kLocked || std::count(first, first + kLocked, 0) > 0)
      continue;
    stuck_together_.join(rows.sides()[joint.first_side].body, rows.sides()[joint.first_side + 1].body);
  }
  for (int b = 0; b < world_.body_count() && !holds_bodies_; ++b) holds_bodies_ = is_held(b);
}

bool Rattle::is_held(int body) { return !system_.mass()[body].fixed && stuck_together_.find(body) == kFixed; }

void Rattle::clear_held_bodies(int begin, int end) {
  for (int b = begin; b < end; ++b)
    if (is_held(b)) stiffness_[b] = {};
}

/// M + h²/2 K in place of M for the kick before the drift [Tournier2015]: the positive part of the geometric
/// stiffness K acts at the end of the drift instead of at its start.  A step of q̈ = −ω²q then has, x = ω h,
/// determinant 1/(1 + x²/2), trace (2 − x²/2)/(1 + x²/2): stable for any x.  (solvers/integrators, "Tension")
void Rattle::prepare_stiffness(double h) {
  // Of a matrix without negative eigenvalues, as under pull alone, it is the matrix.
  const auto positive_part = [](const Mat3& K) -> Mat3 {
    if (is_semidefinite(K)) return K;
    Eigen::SelfAdjointEigenSolver<Mat3> eigen(K);
    return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() *
           eigen.eigenvectors().transpose();
  };
  const auto root_of_inverse = [](const Mat3& M) -> Mat3 {
    const Eigen::LLT<Mat3> cholesky(M);
    return cholesky.matrixU().solve(Mat3::Identity());
  };
  // M (M + h²/2 K)⁻¹ and a root of the inverse, from those of M⁻¹ where nothing pulls, as translations of
  // ball joints.
  const auto filter = [&](const Mat3& M, const Mat3& K, const Mat3& root, Mat3& kept, Mat3& root_h) {
    if (K.isZero(0)) {
      kept.setIdentity();
      root_h = root;
      return;
    }
    const Mat3 M_h = M + 0.5 * h * h * positive_part(K);
    kept = M * M_h.inverse();
    root_h = root_of_inverse(M_h);
  };
  const std::span<FullMassRoot> roots = system_.use_full_roots();
  for (int b = 0; b < world_.body_count(); ++b) {
    if (system_.mass()[b].fixed) continue;
    const MassMatrix::Inertia& body = system_.mass().inertia(b);
    const Mat3 R = system_.mass().principal_axes(b, state_.poses[b]);
    filter(R * body.moments.asDiagonal() * R.transpose(), stiffness_[b].rotation,
           system_.inverse_mass(b).rotation, filter_rotation_[b], roots[b].rotation);
    filter(body.mass * Mat3::Identity(), stiffness_[b].translation,
           system_.inverse_mass(b).translation * Mat3::Identity(), filter_translation_[b],
           roots[b].translation);
    stiffened_[b] = !(stiffness_[b].rotation.isZero(0) && stiffness_[b].translation.isZero(0));
  }
  find_free_parts();
}

/// What joints and contacts that hold tie together.
void Rattle::find_free_parts() {
  const Rows& rows = system_.rows();
  held_rows_.assign(rows.row_count(), 1);
  for (int r : breaking_.rows()) held_rows_[r] = 0;
  const std::span<const ContactSet::Place> places = contacts_.set().places();
  const int first_contact = rows.contact_joint(0);
  free_parts_.begin(system_.mass());
  for (int j = 0; j < static_cast<int>(rows.joints().size()); ++j) {
    const Rows::JointRows& joint = rows.joints()[j];
    const auto first = held_rows_.begin() + joint.first_row;
    if (j >= first_contact ? !places[j - first_contact].active
                           : std::count(first, first + joint.row_count, 1) == 0)
      continue;
    for (int s = joint.first_side + 1; s < joint.first_side + joint.side_count; ++s)
      free_parts_.join(rows.sides()[joint.first_side].body, rows.sides()[s].body);
  }
  free_parts_.find(system_.mass(), state_.poses, stiffened_);
}

/// The kick before the drift, with a filter that keeps the momenta of what nothing holds.  Block by block K
/// ties each body to space, while it acts between bodies.  Π F Π + (1 − Π) is again M (M + h²/2 K″)⁻¹ with a
/// symmetric K″ ≥ 0 and K″ R = 0; K″ is no less than any stiffness ≤ K⁺ without a part against R, so that the
/// step remains stable.  J R = 0 on the rows of such a part, so its S is that of F.
void Rattle::kick_free_parts(double h) {
  const std::span<const double> J = kick_jacobian();
  for (int b = 0; b < world_.body_count(); ++b)
    if (!system_.mass()[b].fixed)
      kicked_[b] = momenta_[b] + 0.5 * h * forces_[b] + system_.rows().wrench_on(b, J, lambda_);
  free_parts_.take_out(system_.mass(), state_.poses, kicked_);
  for (int b = 0; b < world_.body_count(); ++b)
    if (!system_.mass()[b].fixed) kicked_[b] = filtered(b, kicked_[b]);
  free_parts_.put_back(system_.mass(), state_.poses, kicked_);
}

}  // namespace taut
