#include "solvers/integrators/reduced/articulated_tree.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/math/dense.h"
#include "solvers/common/joint_tree.h"
#include "solvers/integrators/body_moves.h"
#include "solvers/integrators/reduced/orthogonal_triangles.h"

namespace taut {
namespace {

Twist twist_of(const Eigen::Matrix<double, 6, 1>& a) { return {a.head<3>(), a.tail<3>()}; }

bool is_same(const Pose& a, const Pose& b) { return a.p == b.p && a.q.coeffs() == b.q.coeffs(); }

/// A body that goes with its parent.
Pose carried_along(const Pose& pose, const Pose& parent_before, const Pose& parent) {
  const Quat turn = parent.q * parent_before.q.conjugate();
  return {(turn * pose.q).normalized(), parent.p + rotate(turn, pose.p - parent_before.p)};
}

}  // namespace

struct ArticulatedTree::Motion {
  Matrix6 X;
  SixColumns N;
  Eigen::Matrix<double, 6, Eigen::Dynamic> inverse;  // J_b⁺
};

/// Inertia I and bias of the articulated body, and L⁻¹ Nᵀ with L Lᵀ = Nᵀ I N, alone and times I.
struct ArticulatedTree::Articulated {
  Matrix6 inertia;
  Rows6 root, passed;
  Vector6 bias, c;
};

/// a = G u̇ + a₀, H = Gᵀ M G.
struct ArticulatedTree::Lagrange {
  Eigen::MatrixXd G, MG;
  Eigen::LLT<Eigen::MatrixXd> H;
};

ArticulatedTree::~ArticulatedTree() = default;

ArticulatedTree::ArticulatedTree(const World& world, const Rows& rows, const MassMatrix& mass)
    : rows_(rows), mass_(mass), follows_time_(rows.depends_on_time()) {
  const JointTree tree(world, rows);
  cuts_ = tree.cuts;
  branch_of_.assign(rows.body_count(), -1);
  first_block_.push_back(0);
  for (const JointTree::Branch& its : tree.branches) {
    branch_of_[its.body] = static_cast<int>(branches_.size());
    Branch branch{its.body, its.parent, static_cast<int>(held_.size()), 0};
    for (int block : its.blocks) {
      const Rows::JointRows& joint = rows.joints()[block];
      const bool child_is_a = rows.sides()[joint.first_side].body == its.body;
      for (int i = 0; i < joint.equality_count; ++i)
        held_.push_back({joint.first_row + i, i, joint.first_side + (child_is_a ? 0 : 1),
                         joint.first_side + (child_is_a ? 1 : 0)});
      blocks_.push_back(block);
    }
    branch.count = static_cast<int>(held_.size()) - branch.first;
    branches_.push_back(branch);
    first_block_.push_back(static_cast<int>(blocks_.size()));
  }
  motions_.resize(branches_.size());
  for (std::size_t k = 0; k < branches_.size(); ++k) {
    motions_[k].X.setZero();
    motions_[k].N.setIdentity(6, 6);
    motions_[k].inverse.setZero(6, branches_[k].count);
  }
  articulated_.resize(branches_.size());
  inertias_.resize(branches_.size());
  for (auto* of_bodies : {&a_, &carried_}) of_bodies->assign(rows.body_count(), Vector6::Zero());
  jacobian_.assign(rows.jacobian_size(), 0);
  for (auto* values : {&phi_, &rates_}) values->assign(rows.row_count(), 0);
}

/// J_b⁺, and if wanted X and N, by orthogonal triangles of J_bᵀ; where rows depend on each other, by singular
/// values.
void ArticulatedTree::decompose(const Branch& branch, Motion& motion, bool with_null_space) {
  if (!branch.attached()) return;
  const auto m = static_cast<Eigen::Index>(branch.count);
  const TreeRow* rows = held_.data() + branch.first;
  const auto side_row = [&](int side, int i) { return Rows::block_row(rows_.sides()[side], jacobian_, i); };
  bool full = m <= 6;
  if (full) {
    SixColumns J(6, m);  // J_bᵀ
    for (Eigen::Index i = 0; i < m; ++i) J.col(i) = side_row(rows[i].side, rows[i].in_block);
    if (!J.allFinite()) J.setZero();  // its rates are not, either
    full = invert_rows(J, motion.inverse, with_null_space ? &motion.N : nullptr);
  }
  if (!full) {
    dense::Matrix J(m, 6);
    for (Eigen::Index i = 0; i < m; ++i) J.row(i) = side_row(rows[i].side, rows[i].in_block).transpose();
    if (!J.allFinite()) J.setZero();
    const dense::SingularValues svd = dense::singular_values(J);
    motion.inverse = dense::pseudo_inverse(svd);
    if (with_null_space) motion.N = svd.V.rightCols(6 - svd.rank);
  }
  if (!with_null_space) return;
  motion.X.setZero();
  for (Eigen::Index i = 0; i < m; ++i)
    motion.X.noalias() -= motion.inverse.col(i) * side_row(rows[i].parent_side, rows[i].in_block).transpose();
}

void ArticulatedTree::linearize(const State& state) {
  rows_.jacobian(state, jacobian_);
  for (std::size_t k = 0; k < branches_.size(); ++k) decompose(branches_[k], motions_[k], true);
}

int ArticulatedTree::freedoms() const {
  int sum = 0;
  for (const Motion& motion : motions_) sum += static_cast<int>(motion.N.cols());
  return sum;
}

/// −J_b⁺ of one entry per row.
ArticulatedTree::Vector6 ArticulatedTree::block_rates(const Branch& branch, const Motion& motion,
                                                      std::span<const double> rates) const {
  Vector6 sum = Vector6::Zero();
  for (int i = 0; i < branch.count; ++i) sum -= rates[held_[branch.first + i].row] * motion.inverse.col(i);
  return sum;
}

/// What the parent feels of a body, whatever its own speeds do.  By roots: where N (Nᵀ I N)⁻¹ Nᵀ is
/// multiplied out, round-off of the largest inertia over the least, as of a rod about its axis, grows along a
/// chain.
void ArticulatedTree::factorize(std::size_t k) {
  const Branch& branch = branches_[k];
  const Motion& motion = motions_[k];
  auto& [I, root, passed, bias, c] = articulated_[k];
  const SixColumns& N = motion.N;
  root = N.transpose();
  const OwnMatrix own = N.transpose() * (I * N);
  if (N.cols() > 0) own.llt().matrixL().solveInPlace(root);
  const int parent = branch.attached() ? branch_of_[branch.parent] : -1;
  if (parent < 0) return;
  passed = root * I;
  const Matrix6 felt = I - passed.transpose() * passed;
  articulated_[parent].inertia += motion.X.transpose() * (felt * motion.X);
}

void ArticulatedTree::carry_to_parent(std::size_t k) {
  const Branch& branch = branches_[k];
  const int parent = branch.attached() ? branch_of_[branch.parent] : -1;
  if (parent < 0) return;
  const auto& [I, root, passed, bias, c] = articulated_[k];
  const Vector6 p = bias + I * c;
  articulated_[parent].bias += motions_[k].X.transpose() * (p - passed.transpose() * (root * p));
}

/// From its parent to a body, whose a it returns.
const ArticulatedTree::Vector6& ArticulatedTree::carry_on(std::size_t k) {
  const Branch& branch = branches_[k];
  const auto& [I, root, passed, bias, c] = articulated_[k];
  const Vector6 carried = branch.attached() ? Vector6(motions_[k].X * a_[branch.parent] + c) : c;
  return a_[branch.body] = carried - root.transpose() * (root * (bias + I * carried));
}

/// G with a = G u̇ + a₀.
Eigen::MatrixXd ArticulatedTree::speeds_to_bodies() const {
  const Eigen::Index bodies = rows_.body_count();
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(6 * bodies, freedoms());
  Eigen::Index first = 0;
  for (std::size_t k = 0; k < branches_.size(); ++k) {
    const Branch& branch = branches_[k];
    const Motion& motion = motions_[k];
    const Eigen::Index row = 6 * branch.body;
    if (branch.attached()) G.middleRows<6>(row) = motion.X * G.middleRows<6>(6 * branch.parent);
    G.block(row, first, 6, motion.N.cols()) += motion.N;
    first += motion.N.cols();
  }
  return G;
}

void ArticulatedTree::prepare(const State& state, Method method) {
  for (std::size_t k = 0; k < branches_.size(); ++k) {
    const int b = branches_[k].body;
    const Mat3 R = mass_.principal_axes(b, state.poses[b]);
    inertias_[k].setZero();
    inertias_[k].topLeftCorner<3, 3>() = R * mass_.inertia(b).moments.asDiagonal() * R.transpose();
    inertias_[k].bottomRightCorner<3, 3>().diagonal().setConstant(mass_.inertia(b).mass);
    articulated_[k].inertia = inertias_[k];
  }
  if (method == Method::kRecursive) {
    for (std::size_t k = branches_.size(); k-- > 0;) factorize(k);
    return;
  }
  if (!lagrange_) lagrange_ = std::make_unique<Lagrange>();
  auto& [G, MG, H] = *lagrange_;
  G = speeds_to_bodies();
  MG.setZero(G.rows(), G.cols());
  for (std::size_t k = 0; k < branches_.size(); ++k)
    MG.middleRows<6>(6 * branches_[k].body) = inertias_[k] * G.middleRows<6>(6 * branches_[k].body);
  if (G.cols() > 0) H.compute(dense::product(G.transpose(), MG));
}

void ArticulatedTree::biases(const State& state, std::span<const Wrench> forces,
                             std::span<Vector6> bias) const {
  for (std::size_t k = 0; k < branches_.size(); ++k) {
    const int b = branches_[k].body;
    const Vec3& w = state.twists[b].w;
    bias[b] << w.cross(inertias_[k].topLeftCorner<3, 3>() * w) - forces[b].torque, -forces[b].force;
  }
}

void ArticulatedTree::respond(Method method, std::span<const Vector6> bias, std::span<const double> rates,
                              std::span<Vector6> a) {
  for (std::size_t k = 0; k < branches_.size(); ++k) {
    articulated_[k].bias = bias[branches_[k].body];
    articulated_[k].c = rates.empty() ? Vector6::Zero() : block_rates(branches_[k], motions_[k], rates);
  }
  if (method == Method::kRecursive) {
    for (std::size_t k = branches_.size(); k-- > 0;) carry_to_parent(k);
    for (std::size_t k = 0; k < branches_.size(); ++k) carry_on(k);
    std::copy(a_.begin(), a_.end(), a.begin());
    return;
  }
  // a₀, then G H⁻¹ Gᵀ (f − M a₀)
  Eigen::VectorXd left(lagrange_->G.rows());
  left.setZero();
  for (std::size_t k = 0; k < branches_.size(); ++k) {
    const Branch& branch = branches_[k];
    Vector6& its = a[branch.body];
    its = articulated_[k].c;
    if (branch.attached() && moves(branch.parent)) its += motions_[k].X * a[branch.parent];
    left.segment<6>(6 * branch.body) = -articulated_[k].bias - inertias_[k] * its;
  }
  if (lagrange_->G.cols() == 0) return;
  const Eigen::VectorXd made = lagrange_->G * lagrange_->H.solve(lagrange_->G.transpose() * left);
  for (const Branch& branch : branches_) a[branch.body] += made.segment<6>(6 * branch.body);
}

void ArticulatedTree::add_reactions(std::span<const Vector6> a, std::span<const Vector6> bias,
                                    std::span<double> lambda) {
  std::fill(carried_.begin(), carried_.end(), Vector6::Zero());
  for (std::size_t k = branches_.size(); k-- > 0;) {
    const Branch& branch = branches_[k];
    if (!branch.attached()) continue;
    const Vector6 wrench = inertias_[k] * a[branch.body] + bias[branch.body] + carried_[branch.body];
    for (int i = 0; i < branch.count; ++i)
      lambda[held_[branch.first + i].row] += motions_[k].inverse.col(i).dot(wrench);
    carried_[branch.parent] += motions_[k].X.transpose() * wrench;
  }
}

bool ArticulatedTree::close_positions(State& state, double tolerance, int least, int& iterations) {
  before_ = state.poses;
  const Configuration at(state);
  for (std::size_t k = 0; k < branches_.size(); ++k) {
    const Branch& branch = branches_[k];
    if (!branch.attached()) continue;
    Pose& pose = state.poses[branch.body];
    if (!is_same(before_[branch.parent], state.poses[branch.parent]))
      pose = carried_along(pose, before_[branch.parent], state.poses[branch.parent]);
    for (int pass = 0;; ++pass) {
      const double gap = open_gap(k, at);
      if (gap == 0 || (pass >= least && gap <= tolerance)) break;
      if (!std::isfinite(gap) || pass == TreeTuning::kMaxClosings || !close_joint(k, at, pose)) return false;
      ++iterations;
    }
  }
  return true;
}

/// |φ| of the joints of a branch, infinite if it is none.
double ArticulatedTree::open_gap(std::size_t k, const Configuration& at) {
  for (int b = first_block_[k]; b < first_block_[k + 1]; ++b)
    rows_.residual(rows_.joints()[blocks_[b]], at, phi_);
  double gap = 0;
  for (int i = 0; i < branches_[k].count; ++i) {
    const double phi = std::abs(phi_[held_[branches_[k].first + i].row]);
    gap = std::isnan(phi) ? INFINITY : std::max(gap, phi);
  }
  return gap;
}

/// A Newton step from the gap that was found; false if it is not finite.
bool ArticulatedTree::close_joint(std::size_t k, const Configuration& at, Pose& pose) {
  for (int b = first_block_[k]; b < first_block_[k + 1]; ++b)
    rows_.jacobian(rows_.joints()[blocks_[b]], at, jacobian_);
  decompose(branches_[k], motions_[k], false);
  const Vector6 move = block_rates(branches_[k], motions_[k], phi_);
  const double turn = move.head<3>().norm();
  if (!std::isfinite(turn)) return false;
  const double part = part_of_step(turn);
  move_pose(pose, part * move.head<3>(), part * move.tail<3>());
  return true;
}

/// J V + φ_t at the state of linearize().
std::span<const double> ArticulatedTree::open_rates(const State& state) const {
  rows_.apply(jacobian_, state.twists, rates_);
  if (follows_time_) rows_.add_rate(state, rates_);
  return rates_;
}

/// A body goes with its parent, which changes no rate of its joints, and then closes these.
void ArticulatedTree::close_velocities(State& state) const {
  const std::span<const double> open = open_rates(state);
  twists_before_ = state.twists;
  for (std::size_t k = 0; k < branches_.size(); ++k) {
    const Branch& branch = branches_[k];
    if (!branch.attached()) continue;
    const Twist &was = twists_before_[branch.parent], &is = state.twists[branch.parent];
    const Vec3 turn = is.w - was.w, shift = is.v - was.v;
    Twist& V = state.twists[branch.body];
    const Twist own = twist_of(block_rates(branch, motions_[k], open));
    const Vec3 arm = state.poses[branch.body].p - state.poses[branch.parent].p;
    V.w += turn + own.w;
    V.v += shift + turn.cross(arm) + own.v;
  }
}

}  // namespace taut
