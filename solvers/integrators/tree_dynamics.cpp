#include "solvers/integrators/tree_dynamics.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "core/base/check.h"
#include "core/constraints/rows.h"
#include "core/math/dense.h"
#include "solvers/system/mass_matrix.h"

namespace taut {

class TreeDynamics::Impl {
 public:
  explicit Impl(const World& world);
  int freedoms(const State& state) const;
  std::vector<Twist> recursive(const State& state) const;
  std::vector<Twist> lagrangian(const State& state) const;

 private:
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  using Subspace = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6>;
  using OwnMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;  // of a joint's freedoms

  /// A moving body and the joint to its parent; row_count 0: none, it is free.
  struct Branch {
    int body = 0, parent = 0;
    int first_row = 0, row_count = 0;
    int offset = 0, parent_offset = 0;  ///< of the two sides in the Jacobian values
  };
  /// (1) in one state.
  struct Motion {
    Matrix6 X = Matrix6::Zero();
    Vector6 c = Vector6::Zero();
    Subspace S = Matrix6::Identity();
  };
  void check_joint(int joint) const;
  void grow(int root, std::vector<char>& reached, std::vector<char>& used);
  std::vector<Motion> motions(const State& state) const;
  void inertias(const State& state, std::vector<Matrix6>& inertia, std::vector<Vector6>& bias) const;

  const World& world_;
  Rows rows_;
  MassMatrix mass_;
  std::vector<Branch> branches_;  // parents before their children
};

TreeDynamics::Impl::Impl(const World& world)
    : world_(world), rows_(world, Rows::AxisRows::kLeftOut), mass_(world) {
  std::vector<char> reached(world.body_count(), 0), used(rows_.joints().size(), 0);
  for (std::size_t j = 0; j < used.size(); ++j) check_joint(static_cast<int>(j));
  for (int b = 0; b < world.body_count(); ++b) reached[b] = mass_[b].fixed;
  for (int b = 0; b < world.body_count(); ++b)
    if (mass_[b].fixed) grow(b, reached, used);
  for (int b = 0; b < world.body_count(); ++b) {
    if (reached[b]) continue;
    reached[b] = 1;
    branches_.push_back({.body = b});
    grow(b, reached, used);
  }
}

void TreeDynamics::Impl::check_joint(int j) const {
  const JointId id{j};
  const Rows::JointRows& joint = rows_.joints()[j];
  if (joint.row_count == 0 && !world_.is_attached(id)) return;
  if (joint.side_count > 2) fail("joint", "must have two bodies in a tree", world_.name(id));
  if (world_.compliance(id)) fail("joint", "must not be soft in a tree", world_.name(id));
  if (world_.has_axis_properties(id))
    fail("joint", "must have no limits, motor, friction or spring in a tree", world_.name(id));
}

/// All that hangs on a body, breadth first.
void TreeDynamics::Impl::grow(int root, std::vector<char>& reached, std::vector<char>& used) {
  std::vector<int> bodies{root};
  for (std::size_t at = 0; at < bodies.size(); ++at)
    for (int s : rows_.sides_of(bodies[at])) {
      const Rows::Side& side = rows_.sides()[s];
      const Rows::JointRows& joint = rows_.joints()[side.block];
      if (used[side.block] || joint.row_count == 0) continue;
      const Rows::Side& other = rows_.sides()[s == joint.first_side ? s + 1 : joint.first_side];
      used[side.block] = 1;
      if (reached[other.body])
        fail("joint", "closes a loop, which a tree has not", world_.name(std::get<JointId>(joint.owner)));
      reached[other.body] = 1;
      bodies.push_back(other.body);
      branches_.push_back(
          {other.body, side.body, joint.first_row, joint.row_count, other.offset, side.offset});
    }
}

std::vector<TreeDynamics::Impl::Motion> TreeDynamics::Impl::motions(const State& state) const {
  using Block = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>>;
  const Configuration at(state);
  std::vector<double> jacobian(rows_.jacobian_size()), gamma(rows_.row_count());
  rows_.jacobian(at, jacobian);
  rows_.bias(at, state.twists, gamma);
  std::vector<Motion> motions(branches_.size());
  for (std::size_t k = 0; k < branches_.size(); ++k) {
    const Branch& branch = branches_[k];
    if (branch.row_count == 0) continue;
    const Block J_b(jacobian.data() + branch.offset, branch.row_count, 6);
    const Block J_p(jacobian.data() + branch.parent_offset, branch.row_count, 6);
    const Eigen::Map<const Eigen::VectorXd> bias(gamma.data() + branch.first_row, branch.row_count);
    const dense::SingularValues svd = dense::singular_values(J_b);
    const Eigen::MatrixXd inverse = dense::pseudo_inverse(svd);
    motions[k].X = -inverse.lazyProduct(J_p);
    motions[k].c = -inverse.lazyProduct(bias);
    motions[k].S = svd.V.rightCols(6 - svd.rank);
  }
  return motions;
}

int TreeDynamics::Impl::freedoms(const State& state) const {
  int sum = 0;
  for (const Motion& motion : motions(state)) sum += static_cast<int>(motion.S.cols());
  return sum;
}

/// M and ω × Iω − f, by body.
void TreeDynamics::Impl::inertias(const State& state, std::vector<Matrix6>& inertia,
                                  std::vector<Vector6>& bias) const {
  const int bodies = world_.body_count();
  std::vector<Wrench> forces(bodies);
  world_.forces(state, forces);
  inertia.assign(bodies, Matrix6::Zero());
  bias.assign(bodies, Vector6::Zero());
  for (int b = 0; b < bodies; ++b) {
    if (mass_[b].fixed) continue;
    const Mat3 R = mass_.principal_axes(b, state.poses[b]);
    const Vec3& w = state.twists[b].w;
    inertia[b].topLeftCorner<3, 3>() = R * mass_.inertia(b).moments.asDiagonal() * R.transpose();
    inertia[b].bottomRightCorner<3, 3>() = mass_.inertia(b).mass * Mat3::Identity();
    bias[b] << w.cross(mass_.angular_momentum(b, state.poses[b], w)) - forces[b].torque, -forces[b].force;
  }
}

std::vector<Twist> TreeDynamics::Impl::recursive(const State& state) const {
  const std::vector<Motion> motion = motions(state);
  std::vector<Matrix6> inertia;
  std::vector<Vector6> bias, a(world_.body_count(), Vector6::Zero());
  inertias(state, inertia, bias);
  std::vector<Eigen::LLT<OwnMatrix>> own(branches_.size());  // Sᵀ I S of the articulated bodies
  for (std::size_t k = branches_.size(); k-- > 0;) {
    const Branch& branch = branches_[k];
    const auto& [X, c, S] = motion[k];
    const Matrix6& I = inertia[branch.body];
    const Vector6 p = bias[branch.body] + I * c;
    const Subspace U = I * S;
    own[k].compute(S.transpose() * U);
    if (branch.row_count == 0) continue;
    // What the parent feels of it, whatever its own speeds do.
    const Matrix6 felt = I - U * own[k].solve(U.transpose());
    inertia[branch.parent] += X.transpose() * felt * X;
    bias[branch.parent] += X.transpose() * (p - U * own[k].solve(S.transpose() * p));
  }
  std::vector<Twist> result(world_.body_count());
  for (std::size_t k = 0; k < branches_.size(); ++k) {
    const Branch& branch = branches_[k];
    const auto& [X, c, S] = motion[k];
    const Vector6 carried = X * (branch.row_count > 0 ? a[branch.parent] : Vector6(Vector6::Zero())) + c;
    const Vector6 p = bias[branch.body] + inertia[branch.body] * carried;
    a[branch.body] = carried - S * own[k].solve(S.transpose() * p);
    result[branch.body] = {a[branch.body].head<3>(), a[branch.body].tail<3>()};
  }
  return result;
}

std::vector<Twist> TreeDynamics::Impl::lagrangian(const State& state) const {
  const std::vector<Motion> motion = motions(state);
  std::vector<Matrix6> inertia;
  std::vector<Vector6> bias;
  inertias(state, inertia, bias);
  const int bodies = world_.body_count();
  Eigen::Index freedoms = 0;
  for (const Motion& m : motion) freedoms += m.S.cols();
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(6 * bodies, freedoms);
  Eigen::VectorXd a0 = Eigen::VectorXd::Zero(6 * bodies);
  Eigen::Index first = 0;
  for (std::size_t k = 0; k < branches_.size(); ++k) {
    const Branch& branch = branches_[k];
    const auto& [X, c, S] = motion[k];
    const int row = 6 * branch.body, parent = 6 * branch.parent;
    if (branch.row_count > 0) {
      G.middleRows<6>(row) = X * G.middleRows<6>(parent);
      a0.segment<6>(row) = X * a0.segment<6>(parent) + c;
    }
    G.block(row, first, 6, S.cols()) += S;
    first += S.cols();
  }
  Eigen::MatrixXd MG = Eigen::MatrixXd::Zero(6 * bodies, freedoms);
  Eigen::VectorXd force = Eigen::VectorXd::Zero(6 * bodies);
  for (int b = 0; b < bodies; ++b) {
    MG.middleRows<6>(6 * b) = inertia[b] * G.middleRows<6>(6 * b);
    force.segment<6>(6 * b) = -bias[b] - inertia[b] * a0.segment<6>(6 * b);
  }
  const Eigen::VectorXd a =
      a0 + G * dense::solve_symmetric(dense::product(G.transpose(), MG), G.transpose() * force);
  std::vector<Twist> result(bodies);
  for (int b = 0; b < bodies; ++b) result[b] = {a.segment<3>(6 * b), a.segment<3>(6 * b + 3)};
  return result;
}

TreeDynamics::TreeDynamics(const World& world) : impl_(std::make_unique<const Impl>(world)) {}

TreeDynamics::~TreeDynamics() = default;

int TreeDynamics::freedoms(const State& state) const { return impl_->freedoms(state); }

std::vector<Twist> TreeDynamics::recursive(const State& state) const { return impl_->recursive(state); }

std::vector<Twist> TreeDynamics::lagrangian(const State& state) const { return impl_->lagrangian(state); }

}  // namespace taut
