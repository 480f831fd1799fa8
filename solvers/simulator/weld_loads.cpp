#include "solvers/simulator/weld_loads.h"

#include <algorithm>

#include "core/math/dense.h"
#include "core/world/diagnostics.h"
#include "solvers/linear/sparse_lu.h"

namespace taut {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

Vector6 stacked(const Wrench& wrench) {
  Vector6 v;
  v << wrench.torque, wrench.force;
  return v;
}
Wrench wrench_of(const Vector6& v) { return {v.head<3>(), v.tail<3>()}; }

}  // namespace

WeldLoads::WeldLoads(const World& source, const MergedWorld& merged)
    : merged_(merged),
      rows_(source, Rows::AxisRows::kIncluded, {}, Rows::Joints::kAll, Springs::kIncluded),
      is_weld_(source.joint_count(), 0),
      loads_(source.joint_count()) {
  for (const MergedGroup& group : merged.groups())
    for (const auto* welds : {&group.welds, &group.loops})
      for (JointId weld : *welds)
        if (weld.index >= 0) is_weld_[weld.index] = 1;
  for (int j = 0; j < source.joint_count(); ++j)
    ends_.push_back({source.joint(JointId{j}).a(), source.joint(JointId{j}).b()});
  for (ForceId id : source.springs())
    spring_is_within_.push_back(merged.is_within_carrier(*source.force(id).spring()));
  for (int s = 0; s < source.shape_count(); ++s) owner_of_shape_.push_back(source.shape(ShapeId{s}).body);
}

/// The state of the source, J there, and nothing required yet.
void WeldLoads::start() {
  merged_.expand(merged_.world().state(), state_);
  jacobian_.resize(rows_.jacobian_size());
  rows_.jacobian(state_, jacobian_);
  laws_.resize(state_.poses.size());
  required_.assign(state_.poses.size(), Wrench{});
}

/// Wrenches of the joints that are not merged away, each on the body of the source that it acts on.
void WeldLoads::take_joints(const Impulses& joints) {
  for (std::size_t j = 0; j < ends_.size(); ++j)
    take_rows(rows_.joints()[j], joints.rows.joints()[j], joints);
  // Springs between bodies in the order of both worlds; those within a carrier are among the laws.
  for (int there = 0, s = 0; there < joints.rows.spring_count(); ++s)
    if (!spring_is_within_[s])
      take_rows(rows_.joints()[rows_.spring_joint(s)],
                joints.rows.joints()[joints.rows.spring_joint(there++)], joints);
}

/// Rows of the source with the multipliers that they have in the merged world.
void WeldLoads::take_rows(const Rows::JointRows& own, const Rows::JointRows& there, const Impulses& joints) {
  if (there.row_count == 0) return;
  for (int s = own.first_side; s < own.first_side + own.side_count; ++s) {
    const Rows::Side& side = rows_.sides()[s];
    if (!merged_.is_carried(BodyId{side.body})) continue;
    Vector6 sum = Vector6::Zero();
    for (int i = 0; i < own.row_count; ++i)
      sum += joints.scale * joints.multipliers[there.first_row + i] *
             Eigen::Map<const Vector6>(jacobian_.data() + side.offset + 6 * i);
    required_[side.body] = required_[side.body] - wrench_of(sum);
  }
}

/// Wrenches of the contacts that have slots in the rows of the merged world.
void WeldLoads::take_contact_rows(const Impulses& joints, std::span<const ContactCache::Slot> contacts) {
  std::vector<double> jacobian(joints.rows.jacobian_size());
  if (!contacts.empty()) joints.rows.jacobian(merged_.world().state(), jacobian);
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    if (!contacts[k].active) continue;
    const Rows::JointRows& contact = joints.rows.joints()[joints.rows.contact_joint(static_cast<int>(k))];
    for (int s = 0; s < 2; ++s) {
      const Rows::Side& side = joints.rows.sides()[contact.first_side + s];
      const BodyId owner = owner_of_shape_[(s == 0 ? contacts[k].contact.a : contacts[k].contact.b).index];
      if (!merged_.is_carried(owner)) continue;
      Vector6 sum = Vector6::Zero();
      for (int i = 0; i < contact.row_count; ++i)
        sum += joints.scale * joints.multipliers[contact.first_row + i] *
               Eigen::Map<const Vector6>(jacobian.data() + side.offset + 6 * i);
      Wrench wrench = wrench_of(sum);  // about the carrier
      wrench.torque +=
          (merged_.world().pose(BodyId{side.body}).p - state_.poses[owner.index].p).cross(wrench.force);
      required_[owner.index] = required_[owner.index] - wrench;
    }
  }
}

void WeldLoads::solve_present(std::span<const Twist> accelerations, const Impulses& joints,
                              std::span<const ContactCache::Slot> contacts) {
  start();
  merged_.source_forces(state_, laws_, laws_of(joints));
  take_joints(joints);
  take_contact_rows(joints, contacts);
  for (const MergedGroup& group : merged_.groups()) {
    for (BodyId body : group.members) {
      const Pose& X = state_.poses[body.index];
      const Twist& V = state_.twists[body.index];
      const Twist& A = accelerations[group.carrier.index];
      const Vec3 arm = X.p - merged_.world().pose(group.carrier).p;
      const Twist own = group.fixed ? Twist{} : Twist{A.w, A.at(arm) + V.w.cross(V.w.cross(arm))};
      const MassProperties& mass = merged_.source_mass(body);
      const Mat3 I = turned_inertia(mass, X.q);
      required_[body.index] = required_[body.index] +
                              Wrench{I * own.w + V.w.cross(I * V.w), mass.mass() * own.v} - laws_[body.index];
    }
    split_loads(group);
  }
}

Wrench WeldLoads::momentum(BodyId body, const State& state) const {
  const MassProperties& mass = merged_.source_mass(body);
  const Twist& V = state.twists[body.index];
  return {angular_momentum_about_centre(mass, state.poses[body.index], V.w), mass.mass() * V.v};
}

void WeldLoads::solve_mean(const State& from, double dt, const Impulses& joints,
                           std::span<const ContactReport> contacts) {
  start();
  take_joints(joints);
  for (const ContactReport& report : contacts) {
    const auto put = [&](ShapeId shape, BodyId carrier, const Vec3& point, double sign) {
      const BodyId owner = owner_of_shape_[shape.index];
      const Vec3 arm = merged_.world().pose(carrier).point(point) - state_.poses[owner.index].p;
      required_[owner.index] =
          required_[owner.index] - sign * Wrench{report.torque + arm.cross(report.force), report.force};
    };
    put(report.contact.a, report.contact.A, report.contact.p_AP, -1);
    put(report.contact.b, report.contact.B, report.contact.p_BQ, 1);
  }
  for (const State* state : {&from, static_cast<const State*>(&state_)}) {
    merged_.source_forces(*state, laws_, laws_of(joints));
    for (std::size_t b = 0; b < laws_.size(); ++b) required_[b] = required_[b] - 0.5 * laws_[b];
  }
  for (const MergedGroup& group : merged_.groups()) {
    for (BodyId body : group.members)
      required_[body.index] =
          required_[body.index] + (1 / dt) * (momentum(body, state_) - momentum(body, from));
    if (!group.fixed) balance(group);
    split_loads(group);
  }
}

/// What the members of a free group require together is nothing but the error of the means: it is taken off
/// as that of one acceleration of the whole.
void WeldLoads::balance(const MergedGroup& group) {
  const World& world = merged_.world();
  const Pose& X = world.pose(group.carrier);
  Wrench sum;
  for (BodyId body : group.members) {
    const Wrench& F = required_[body.index];
    sum.force += F.force;
    sum.torque += F.torque + (state_.poses[body.index].p - X.p).cross(F.force);
  }
  const MassProperties& all = world.mass_properties(group.carrier);
  const Vec3 turn = dense::solve_symmetric3(turned_inertia(all, X.q), sum.torque),
             move = sum.force / all.mass();
  for (BodyId body : group.members) {
    const MassProperties& own = merged_.source_mass(body);
    const Pose& at = state_.poses[body.index];
    required_[body.index] = required_[body.index] - Wrench{turned_inertia(own, at.q) * turn,
                                                           own.mass() * (move + turn.cross(at.p - X.p))};
  }
}

Wrench WeldLoads::moved(const Wrench& wrench, BodyId from, BodyId to) const {
  const Vec3 arm = state_.poses[from.index].p - state_.poses[to.index].p;
  return {wrench.torque + arm.cross(wrench.force), wrench.force};
}

void WeldLoads::split_loads(const MergedGroup& group) {
  for (const auto* welds : {&group.welds, &group.loops})
    for (JointId weld : *welds)
      if (weld.index >= 0) loads_[weld.index] = {};
  if (!group.loops.empty()) split_loops(group);
  for (std::size_t i = group.members.size(); i-- > 0;) {
    const JointId weld = group.welds[i];
    if (weld.index < 0) continue;
    const BodyId body = group.members[i];
    const auto [a, b] = ends_[weld.index];
    const BodyId other = a == body ? b : a;
    const Wrench& W = required_[body.index];
    required_[other.index] = required_[other.index] + moved(W, body, other);
    loads_[weld.index] = loads_[weld.index] + (body == b ? W : -1.0 * moved(W, body, b));
  }
}

Matrix6 WeldLoads::inverse_mass(int body) const {
  Matrix6 inverse = Matrix6::Zero();
  if (!merged_.is_carried(BodyId{body})) return inverse;  // fixed
  const MassProperties& mass = merged_.source_mass(BodyId{body});
  inverse.topLeftCorner<3, 3>() = turned_inertia(mass, state_.poses[body].q).inverse();
  inverse.bottomRightCorner<3, 3>().diagonal().setConstant(1 / mass.mass());
  return inverse;
}

/// Least Σ S_rr λ_r² with Jᵀ λ as required: λ = D⁻¹ J u, (Jᵀ D⁻¹ J) u = required, D = diag(S), as if each row
/// were a spring of compliance S_rr.  Round-off of this is left to the tree.
void WeldLoads::split_loops(const MergedGroup& group) {
  std::map<int, int> place;  // of a body in u; the root stays where it is
  for (std::size_t i = 0; i < group.members.size(); ++i)
    if (group.welds[i].index >= 0) place.emplace(group.members[i].index, 6 * static_cast<int>(place.size()));
  std::vector<JointId> welds = group.loops;
  for (JointId weld : group.welds)
    if (weld.index >= 0) welds.push_back(weld);
  const Eigen::VectorXd u = loop_displacements(welds, place);
  for (JointId weld : welds) {
    Vector6 lambda = Vector6::Zero();
    for (int s = 0; s < 2; ++s)
      if (const auto at = place.find(end(weld, s)); at != place.end())
        lambda += block(weld, s) * u.segment<6>(at->second);
    lambda = stiffness(weld).cwiseProduct(lambda).eval();
    for (int s = 0; s < 2; ++s) {
      const Wrench W = wrench_of(block(weld, s).transpose() * lambda);
      required_[end(weld, s)] = required_[end(weld, s)] - W;
      if (s == 1) loads_[weld.index] = W;
    }
  }
}

/// J of a weld's rows on its body A (0) or B (1), and that body.
Eigen::Map<const WeldLoads::Block> WeldLoads::block(JointId weld, int s) const {
  return Eigen::Map<const Block>(jacobian_.data() +
                                 rows_.sides()[rows_.joints()[weld.index].first_side + s].offset);
}
int WeldLoads::end(JointId weld, int s) const {
  return (s == 0 ? ends_[weld.index].a : ends_[weld.index].b).index;
}

/// 1/S_rr of its rows.
Vector6 WeldLoads::stiffness(JointId weld) const {
  Vector6 D = Vector6::Zero();
  for (int s = 0; s < 2; ++s)
    D += (block(weld, s) * inverse_mass(end(weld, s)) * block(weld, s).transpose()).diagonal();
  return D.cwiseInverse();
}

/// u of the bodies that have a place in it.
Eigen::VectorXd WeldLoads::loop_displacements(std::span<const JointId> welds,
                                              const std::map<int, int>& place) const {
  std::vector<Eigen::Triplet<double>> entries;
  for (JointId weld : welds) {
    const Vector6 own = stiffness(weld);
    for (int s = 0; s < 2; ++s)
      for (int t = 0; t < 2; ++t) {
        const auto row = place.find(end(weld, s)), column = place.find(end(weld, t));
        if (row == place.end() || column == place.end()) continue;
        const Matrix6 K = block(weld, s).transpose() * own.asDiagonal() * block(weld, t);
        for (int i = 0; i < 6; ++i)
          for (int k = 0; k < 6; ++k) entries.emplace_back(row->second + i, column->second + k, K(i, k));
      }
  }
  const int size = 6 * static_cast<int>(place.size());
  Eigen::SparseMatrix<double> K(size, size);
  K.setFromTriplets(entries.begin(), entries.end());
  Eigen::VectorXd u(size);
  for (const auto& [b, first] : place) u.segment<6>(first) = stacked(required_[b]);
  SparseLu factor;
  if (!factor.factorize(K)) return Eigen::VectorXd::Zero(size);  // all of it is left to the tree
  return factor.solve(u);
}

}  // namespace taut
