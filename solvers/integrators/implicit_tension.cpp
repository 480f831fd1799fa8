#include "solvers/integrators/implicit_tension.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "core/math/dense.h"

namespace taut {
namespace {

struct ImplicitTensionTuning {
  /// ε, a part of the trace of a stiffness: some 45 units of round-off.
  static constexpr double kRoundOff = 1e-14;
};

/// Whether no eigenvalue of a symmetric K is negative but for round-off: the pivots of K + ε tr(K) 1₃ are
/// positive.
bool is_semidefinite(const Mat3& K) {
  const double shift = ImplicitTensionTuning::kRoundOff * K.trace();
  const double a = K(0, 0) + shift, b = K(1, 0), c = K(2, 0);
  if (!(shift > 0 && a > 0)) return false;
  const double d = K(1, 1) + shift - b * b / a, e = K(2, 1) - b * c / a;
  return d > 0 && K(2, 2) + shift - c * c / a - e * e / d > 0;
}

}  // namespace

ImplicitTension::ImplicitTension(ConstraintSystem& system) : system_(system) {
  const std::size_t bodies = system.mass().size();
  rotation_.resize(bodies);
  translation_.resize(bodies);
  stiffened_.resize(bodies);
}

/// M + h²/2 K in place of M for the kick before the drift [Tournier2015]: the positive part of the geometric
/// stiffness K acts at the end of the drift instead of at its start.  A step of q̈ = −ω²q then has, x = ω h,
/// determinant 1/(1 + x²/2), trace (2 − x²/2)/(1 + x²/2): stable for any x.  (solvers/integrators, "Tension")
void ImplicitTension::begin(double h, std::span<const Pose> poses, std::span<const StiffnessBlocks> stiffness,
                            const Breaking& breaking, const ContactForces& contacts) {
  active_ = true;
  // Of a matrix without negative eigenvalues, as under pull alone, it is the matrix.
  const auto positive_part = [](const Mat3& K) -> Mat3 {
    if (is_semidefinite(K)) return K;
    const auto [values, vectors] = dense::symmetric_eigenpairs3(K);
    return vectors * values.cwiseMax(0).asDiagonal() * vectors.transpose();
  };
  const auto root_of_inverse = [](const Mat3& M) -> Mat3 {
    const Eigen::LLT<Mat3> cholesky(M);
    return cholesky.matrixU().solve(Mat3::Identity());
  };
  // M (M + h²/2 K)⁻¹ and a root of the inverse, from those of M⁻¹ where nothing pulls, as translations of
  // ball joints.
  const auto make = [&](const Mat3& M, const Mat3& K, const Mat3& root, Mat3& kept, Mat3& root_h) {
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
  for (int b = 0; b < system_.mass().size(); ++b) {
    if (system_.mass()[b].fixed) continue;
    const MassMatrix::Inertia& body = system_.mass().inertia(b);
    const Mat3 R = system_.mass().principal_axes(b, poses[b]);
    make(R * body.moments.asDiagonal() * R.transpose(), stiffness[b].rotation,
         system_.inverse_mass(b).rotation, rotation_[b], roots[b].rotation);
    make(body.mass * Mat3::Identity(), stiffness[b].translation,
         system_.inverse_mass(b).translation * Mat3::Identity(), translation_[b], roots[b].translation);
    stiffened_[b] = !(stiffness[b].rotation.isZero(0) && stiffness[b].translation.isZero(0));
  }
  find_free_parts(poses, breaking, contacts);
}

/// What joints and contacts that hold tie together.
void ImplicitTension::find_free_parts(std::span<const Pose> poses, const Breaking& breaking,
                                      const ContactForces& contacts) {
  const Rows& rows = system_.rows();
  holding_rows_.assign(rows.row_count(), 1);
  for (int r : breaking.rows()) holding_rows_[r] = 0;
  const std::span<const ContactCache::Slot> slots = contacts.cache().slots();
  const int first_contact = rows.contact_joint(0);
  free_parts_.begin(system_.mass());
  for (int j = 0; j < static_cast<int>(rows.joints().size()); ++j) {
    const Rows::JointRows& joint = rows.joints()[j];
    const auto first = holding_rows_.begin() + joint.first_row;
    if (j >= first_contact ? !slots[j - first_contact].active
                           : std::count(first, first + joint.row_count, 1) == 0)
      continue;
    for (int s = joint.first_side + 1; s < joint.first_side + joint.side_count; ++s)
      free_parts_.join(rows.sides()[joint.first_side].body, rows.sides()[s].body);
  }
  free_parts_.find(system_.mass(), poses, stiffened_);
}

void ImplicitTension::filter(std::span<const Pose> poses, std::span<Wrench> momenta) {
  if (!free_parts_.empty()) free_parts_.take_out(system_.mass(), poses, momenta);
  for (int b = 0; b < system_.mass().size(); ++b)
    if (!system_.mass()[b].fixed)
      momenta[b] = {rotation_[b] * momenta[b].torque, translation_[b] * momenta[b].force};
  if (!free_parts_.empty()) free_parts_.put_back(system_.mass(), poses, momenta);
}

}  // namespace taut
