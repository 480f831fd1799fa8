#include "core/world/joint_frame.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/check.h"
#include "core/constraints/rows.h"
#include "core/math/dense.h"

namespace taut {
namespace {

/// A joint is closed by its frame when no row is open by more [m or rad].
constexpr double kClosed = 1e-12;
/// … and it cannot be closed if one is open by more after so many steps of Newton's method.
constexpr double kOpen = 1e-9;
constexpr int kMostFrameSteps = 50;
/// Of the differences that give ∂φ/∂X [m and rad]; their error, of second order, only slows convergence.
constexpr double kFrameDifference = 1e-6;
/// Rows whose singular value is less than this part of the largest depend on others.
constexpr double kDependent = 1e-6;

/// A joint that takes a frame F, fixed on its body B, for B.
class MovedJoint final : public Joint {
 public:
  MovedJoint(std::shared_ptr<const Joint> joint, const Pose& X_BF)
      : Joint(joint->a(), joint->b()), joint_(std::move(joint)), X_BF_(X_BF) {
    auto carriers = std::make_shared<Carriers>();
    for (int b = 0; b <= std::max(a().index, this->b().index); ++b) carriers->bodies.push_back({b});
    carriers->frames.resize(carriers->bodies.size());
    carriers->frames[this->b().index] = X_BF;
    to_.carriers = std::move(carriers);
  }
  std::string_view type() const override { return joint_->type(); }
  void append_rows(RowSink& rows) const override { rows.add_rows_of(*joint_, to_); }
  void append_axes(AxisSink& axes) const override { axes.add_axes_of(*joint_, to_); }
  Vec3 reaction_point_B() const override { return X_BF_.point(joint_->reaction_point_B()); }
  std::optional<Pose> rigid_pose() const override {
    const std::optional<Pose> X_AF = joint_->rigid_pose();
    if (!X_AF) return {};
    return *X_AF * Pose{X_BF_.q.conjugate(), X_BF_.local(Vec3::Zero())};
  }
  std::vector<WirePoint> course() const override {
    std::vector<WirePoint> points = joint_->course();
    for (WirePoint& point : points)
      if (point.body == b()) point.p_BP = X_BF_.point(point.p_BP);
    return points;
  }
  const std::shared_ptr<const Joint>& as_added() const { return joint_; }

 private:
  std::shared_ptr<const Joint> joint_;
  Pose X_BF_;
  Relocation to_;
};

/// A copy of the world in which this joint alone holds, rigidly.
World with_joint_alone(const World& world, JointId joint) {
  World alone = world;
  alone.attach(joint);
  alone.set_compliance(joint, std::nullopt);
  const JointId only[] = {joint};
  alone.detach_all_but(only);  // and those whose axes it couples
  return alone;
}

Eigen::VectorXd residual_of(const Rows& rows, const State& state) {
  Eigen::VectorXd phi(rows.row_count());
  rows.residual(state, {phi.data(), static_cast<std::size_t>(phi.size())});
  return phi;
}

/// The body turned about the point p_WP and shifted by δ = (turn, shift).
Pose displaced(const Pose& X, const Vec3& p_WP, const Eigen::Matrix<double, 6, 1>& delta) {
  const Quat turn = exp_so3(delta.head<3>());
  return {(turn * X.q).normalized(), p_WP + turn * (X.p - p_WP) + delta.tail<3>()};
}

}  // namespace

Gap gap_of(const World& world, JointId joint) {
  const World alone = with_joint_alone(world, joint);
  const Rows rows(alone, Rows::AxisRows::kLeftOut);
  std::vector<double> phi(rows.row_count());
  rows.residual(alone.state(), phi);
  return joint_gaps(rows, phi)[joint.index];
}

Pose closing_frame(const World& world, JointId id) {
  const Joint& joint = world.joint(id);
  if (joint.bodies().size() != 2 || joint.axes_needed() > 0 || !joint.couples().empty())
    fail("joint " + world.name(id), "has no frame on one of two bodies that could be moved", joint.type());
  const World alone = with_joint_alone(world, id);
  const Rows rows(alone, Rows::AxisRows::kLeftOut);
  State state = alone.state();
  Pose& B = state.poses[joint.b().index];
  const Pose now = B;
  Eigen::VectorXd phi = residual_of(rows, state);
  for (int step = 0; step < kMostFrameSteps && phi.size() > 0 && phi.norm() > kClosed; ++step) {
    const Pose before = B;
    const Vec3 anchor = before.point(joint.reaction_point_B());
    dense::Matrix J(phi.size(), 6);
    for (int k = 0; k < 6; ++k) {
      Eigen::Matrix<double, 6, 1> delta = Eigen::Matrix<double, 6, 1>::Zero();
      delta[k] = kFrameDifference;
      B = displaced(before, anchor, delta);
      const Eigen::VectorXd ahead = residual_of(rows, state);
      B = displaced(before, anchor, -delta);
      J.col(k) = (ahead - residual_of(rows, state)) / (2 * kFrameDifference);
    }
    B = displaced(before, anchor, -(dense::pseudo_inverse(dense::singular_values(J, kDependent)) * phi));
    phi = residual_of(rows, state);
  }
  if (phi.size() > 0 && !(phi.norm() <= kOpen))
    fail("joint " + world.name(id), "cannot be closed by moving its end", phi.norm());
  return {(now.q.conjugate() * B.q).normalized(), now.local(B.p)};
}

std::shared_ptr<const Joint> detail::with_frame(std::shared_ptr<const Joint> joint, const Pose& X_BF) {
  if (const auto* moved = dynamic_cast<const MovedJoint*>(joint.get())) joint = moved->as_added();
  if (X_BF.p.isZero(0) && X_BF.q.vec().isZero(0)) return joint;
  return std::make_shared<const MovedJoint>(std::move(joint), X_BF);
}

}  // namespace taut
