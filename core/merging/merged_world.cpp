#include "core/merging/merged_world.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/math/dense.h"
#include "core/state/same_state.h"
#include "core/world/world_parts.h"

namespace taut {
namespace {

/// Products of inertia below this part of the largest moment are round-off.
constexpr double kPlaceRoundOff = 1e-14;
constexpr int kMaxPlacings = 20;

/// A joint of the source between the bodies that carry its own.
class MergedJoint final : public Joint {
 public:
  static std::shared_ptr<const MergedJoint> make(std::shared_ptr<const Joint> joint,
                                                 std::shared_ptr<const Carriers> carriers) {
    Relocation to;
    to.carriers = std::move(carriers);
    std::vector<BodyId> bodies;
    for (BodyId body : joint->bodies()) {
      const auto found = std::find(bodies.begin(), bodies.end(), to(body));
      to.sides.push_back(static_cast<int>(found - bodies.begin()));
      if (found == bodies.end()) bodies.push_back(to(body));
    }
    return std::make_shared<const MergedJoint>(std::move(joint), std::move(to), std::move(bodies));
  }
  MergedJoint(std::shared_ptr<const Joint> joint, Relocation to, std::vector<BodyId> bodies)
      : Joint(std::move(bodies)), joint_(std::move(joint)), to_(std::move(to)) {}

  std::string_view type() const override { return joint_->type(); }
  void append_rows(RowSink& rows) const override { rows.add_rows_of(*joint_, to_); }
  void append_axes(AxisSink& axes) const override { axes.add_axes_of(*joint_, to_); }
  Vec3 reaction_point_B() const override { return to_.frame(joint_->b()).point(joint_->reaction_point_B()); }
  std::vector<WirePoint> course() const override {
    std::vector<WirePoint> points = joint_->course();
    for (WirePoint& point : points) {
      point.p_BP = to_.frame(point.body).point(point.p_BP);
      point.body = to_(point.body);
    }
    return points;
  }
  int axes_needed() const override { return joint_->axes_needed(); }
  std::vector<JointId> couples() const override { return joint_->couples(); }

 private:
  std::shared_ptr<const Joint> joint_;
  Relocation to_;
};

/// Poses and twists of the bodies that others carry.
void place_carried(const Carriers& carriers, std::span<const char> carried, const State& merged,
                   State& source) {
  for (std::size_t b = 0; b < carried.size(); ++b) {
    if (!carried[b]) continue;
    const int c = carriers.bodies[b].index;
    const Pose& X_WC = merged.poses[c];
    const Twist& V = merged.twists[c];
    const Pose& X_CB = carriers.frames[b];
    source.poses[b] = {(X_WC.q * X_CB.q).normalized(), X_WC.point(X_CB.p)};
    source.twists[b] = {V.w, V.at(X_WC.q * X_CB.p)};
  }
}

/// Force laws of the source, either all conservative or none of them: they see its state, and what they put
/// on a body acts on the one that carries it.
class MergedForces final : public Force {
 public:
  MergedForces(std::vector<std::shared_ptr<const Force>> laws, std::shared_ptr<const Carriers> carriers,
               std::vector<char> carried)
      : laws_(std::move(laws)), carriers_(std::move(carriers)), carried_(std::move(carried)) {}

  void accumulate(const State& state, std::span<Wrench> wrenches) const override {
    see(state);
    seen_wrenches_.assign(carried_.size(), Wrench{});
    for (const auto& law : laws_) law->accumulate(seen_, seen_wrenches_);
    for (std::size_t b = 0; b < carried_.size(); ++b) {
      const Wrench& F = seen_wrenches_[b];
      Wrench& on_carrier = wrenches[carriers_->bodies[b].index];
      on_carrier.force += F.force;
      on_carrier.torque += F.torque;
      if (carried_[b])
        on_carrier.torque +=
            (state.poses[carriers_->bodies[b].index].q * carriers_->frames[b].p).cross(F.force);
    }
  }
  double potential_energy(const State& state) const override {
    see(state);
    double energy = 0;
    for (const auto& law : laws_) energy += law->potential_energy(seen_);
    return energy;
  }
  bool depends_on_velocity() const override {
    return std::any_of(laws_.begin(), laws_.end(),
                       [](const auto& law) { return law->depends_on_velocity(); });
  }
  bool conservative() const override { return laws_.front()->conservative(); }

 private:
  void see(const State& state) const {
    seen_ = state;
    place_carried(*carriers_, carried_, state, seen_);
  }
  std::vector<std::shared_ptr<const Force>> laws_;
  std::shared_ptr<const Carriers> carriers_;
  std::vector<char> carried_;
  // Kept so that a step allocates nothing: the law serves one world, in one thread.
  mutable State seen_;
  mutable std::vector<Wrench> seen_wrenches_;
};

std::shared_ptr<const Force> on_carriers(const LineSpring& spring, const Carriers& to) {
  const int a = spring.a.index, b = spring.b.index;
  return std::make_shared<SpringDamper>(to.bodies[a], to.bodies[b], to.frames[a].point(spring.p_AP),
                                        to.frames[b].point(spring.p_BQ), spring.law);
}

/// The weight of moving bodies that are welded to a fixed one does nothing, but the source counts its
/// potential.
class HeldWeight final : public Force {
 public:
  explicit HeldWeight(double potential) : potential_(potential) {}
  void accumulate(const State&, std::span<Wrench>) const override {}
  double potential_energy(const State&) const override { return potential_; }
  bool conservative() const override { return true; }

 private:
  double potential_;
};

Gap weld_gap(const Joint& weld, const State& state) {
  const Pose X_AB = *weld.rigid_pose();
  const Pose &A = state.poses[weld.a().index], &B = state.poses[weld.b().index];
  const Vec3 p_BQ = weld.reaction_point_B(), p_AP = X_AB.point(p_BQ);
  return {((B.p - A.p) + (B.q * p_BQ - A.q * p_AP)).norm(),
          2 * ((A.q * X_AB.q).conjugate() * B.q).vec().norm()};
}

Mat3 inertia_about(const Mat3& inertia, double mass, const Vec3& arm) {
  return inertia + mass * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
}

MassProperties without_round_off(double mass, Mat3 inertia) {
  const double least = kPlaceRoundOff * inertia.diagonal().maxCoeff();
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      if (i != k && std::abs(inertia(i, k)) <= least) inertia(i, k) = 0;
  return {mass, inertia};
}

}  // namespace

Mat3 turned_inertia(const MassProperties& mass, const Quat& q) {
  const Mat3 R = q.toRotationMatrix();
  return R * mass.inertia_B() * R.transpose();
}

MergedWorld::MergedWorld(const World& source, double tolerance) : tolerance_(tolerance) {
  groups_ = merged_groups(source, tolerance);
  rebuild(source);
  seen_.state = -1;  // the first update() counts as one that sets the state
}

bool MergedWorld::update(const World& source) {
  const detail::WorldVersions& now = source.parts_->versions;
  bool rebuilt = seen_.topology != now.topology || seen_.geometry != now.geometry ||
                 !source.parts_->soft_joints.has_same_joints(world_.parts_->soft_joints);
  if (!rebuilt && seen_.properties != now.properties) {
    rebuilt = merged_groups(source, tolerance_) != groups_;
    if (!rebuilt) take_properties(source);
  }
  const bool moved = seen_.state != now.state;
  if (rebuilt) {
    groups_ = merged_groups(source, tolerance_);
    rebuild(source);
    return true;
  }
  take_wakes(source);
  if (seen_.axes != now.axes) {
    world_.parts_->axes.copy_properties(source.parts_->axes);
    world_.parts_->soft_joints.copy_compliances(source.parts_->soft_joints);
    ++world_.parts_->versions.axes;
    seen_.axes = now.axes;
  }
  if (moved) {
    world_.gravity_ = source.gravity_;
    if (!same(source.state_, known_)) take_state(source);
    make_forces(source);
    ++world_.parts_->versions.state;
    seen_.state = now.state;
  }
  return moved;
}

bool MergedWorld::is_behind(const World& source) const {
  const detail::WorldVersions& now = source.parts_->versions;
  return seen_.topology != now.topology || seen_.geometry != now.geometry || seen_.state != now.state ||
         seen_.axes != now.axes || seen_.properties != now.properties;
}

/// Versions go on from what they were, whatever those of the source are: a state that was not set there is no
/// new one here.
void MergedWorld::rebuild(const World& source) {
  const detail::WorldVersions before = world_.parts_->versions;
  const bool moved = seen_.state != source.parts_->versions.state;
  world_ = source;
  const auto& masses = source.parts_->bodies.masses();
  const auto fixed = source.parts_->bodies.fixed();
  source_masses_.assign(masses.begin(), masses.end());
  source_fixed_.assign(fixed.begin(), fixed.end());
  world_.parts_->versions = {.topology = before.topology + 1,
                             .state = before.state + moved,
                             .axes = before.axes + 1,
                             .properties = source.parts_->versions.properties,
                             .geometry = before.geometry + 1,
                             .sleep = before.sleep + 1};
  note_wakes(source);
  place_frames(source);
  make_bodies(source);
  make_joints(source);
  make_shapes(source);
  take_state(source);
  make_forces(source);
  seen_ = source.parts_->versions;
}

/// X_CB of all bodies: along the trees of the groups first, then from the common centre of mass.
void MergedWorld::place_frames(const World& source) {
  auto carriers = std::make_shared<Carriers>();
  for (int b = 0; b < source.body_count(); ++b) carriers->bodies.push_back({b});
  carriers->frames.resize(source.body_count());
  carried_.assign(source.body_count(), 0);
  for (const MergedGroup& group : groups_) {
    double mass = 0;
    Vec3 centre = Vec3::Zero();
    for (std::size_t i = 0; i < group.members.size(); ++i) {
      const BodyId body = group.members[i];
      carriers->bodies[body.index] = group.carrier;
      carried_[body.index] = 1;
      Pose& X = carriers->frames[body.index];
      if (group.welds[i].index >= 0) {
        const Joint& joint = source.joint(group.welds[i]);
        const Pose X_AB = *joint.rigid_pose();
        X = joint.b() == body
                ? carriers->frames[joint.a().index] * X_AB
                : carriers->frames[joint.b().index] * Pose{X_AB.q.conjugate(), X_AB.local(Vec3::Zero())};
        X.q.normalize();
      }
      const double m = source.mass_properties(body).mass();
      mass += m;
      centre += m * X.p;
    }
    if (group.fixed) continue;
    for (BodyId body : group.members) carriers->frames[body.index].p -= centre / mass;
  }
  carriers_ = std::move(carriers);
}

void MergedWorld::make_bodies(const World& source) {
  for (const MergedGroup& group : groups_) {
    double mass = 0;
    Mat3 inertia = Mat3::Zero();
    for (BodyId body : group.members) {
      world_.parts_->bodies.set_fixed(body.index, true);
      world_.parts_->sleep.set_asleep(body.index, false);
      const MassProperties& own = source.mass_properties(body);
      const Pose& X = carriers_->frames[body.index];
      mass += own.mass();
      inertia += inertia_about(turned_inertia(own, X.q), own.mass(), X.p);
    }
    if (group.fixed) continue;
    const int carrier = group.carrier.index;
    world_.parts_->bodies.set_fixed(carrier, false);
    world_.parts_->bodies.set_mass(carrier, without_round_off(mass, 0.5 * (inertia + inertia.transpose())));
    world_.parts_->sleep.set_asleep(carrier, std::all_of(group.members.begin(), group.members.end(),
                                                         [&](BodyId b) { return source.is_asleep(b); }));
  }
}

/// Who may collide stays what the joints of the source say.
void MergedWorld::make_joints(const World& source) {
  for (const MergedGroup& group : groups_)
    for (const auto* welds : {&group.welds, &group.loops})
      for (JointId weld : *welds)
        if (weld.index >= 0) world_.parts_->joints.detach(weld.index);
  Relocation to;
  to.carriers = carriers_;
  for (int j = 0; j < source.joint_count(); ++j) {
    const std::span<const BodyId> bodies = source.joint(JointId{j}).bodies();
    if (!world_.is_attached(JointId{j}) ||
        std::none_of(bodies.begin(), bodies.end(), [&](BodyId body) { return is_carried(body); }))
      continue;
    world_.parts_->joints.replace(j, MergedJoint::make(source.parts_->joints.shared(j), carriers_));
    try {
      RowSink trial;
      world_.parts_->joints[j].append_rows(trial);
    } catch (const std::invalid_argument& error) {
      fail("joint " + source.name(JointId{j}), error.what(), source.parts_->joints[j].type());
    }
    world_.parts_->axes.relocate(j, to);
    if (const auto compliance = source.compliance(JointId{j})) {
      const std::int64_t topology = world_.parts_->versions.topology;
      world_.set_compliance(JointId{j}, compliance);  // makes its rows anew
      world_.parts_->versions.topology = topology;
    }
  }
}

void MergedWorld::make_shapes(const World& source) {
  for (int s = 0; s < source.shape_count(); ++s) {
    const BodyId body = source.parts_->shapes[s].body;
    if (is_carried(body))
      world_.parts_->shapes.move(s, carriers_->bodies[body.index],
                                 carriers_->frames[body.index] * source.parts_->shapes[s].pose);
  }
}

/// Laws that say that they have to do with other bodies only stay what they are.
std::vector<std::shared_ptr<const Force>> MergedWorld::carried_laws(const World& source) const {
  const auto is_apart = [&](const Force& law) {
    const std::vector<BodyId> bodies = law.bodies();
    return !bodies.empty() &&
           std::none_of(bodies.begin(), bodies.end(), [&](BodyId body) { return is_carried(body); });
  };
  std::vector<std::shared_ptr<const Force>> laws, conservative, others;
  for (const auto& law : source.parts_->forces.acting()) {
    if (groups_.empty() || is_apart(*law))
      laws.push_back(law);
    else if (const LineSpring* spring = law->spring())
      laws.push_back(on_carriers(*spring, *carriers_));
    else
      (law->conservative() ? conservative : others).push_back(law);
  }
  for (auto* together : {&conservative, &others})
    if (!together->empty())
      laws.push_back(std::make_shared<MergedForces>(std::move(*together), carriers_, carried_));
  return laws;
}

/// −Σ m g·p of the moving bodies that are welded to fixed ones [J].
double MergedWorld::held_potential(const World& source) const {
  double held = 0;
  for (const MergedGroup& group : groups_) {
    if (!group.fixed) continue;
    const Pose& X_WC = world_.state_.poses[group.carrier.index];
    for (BodyId body : group.members)
      held -= source.mass_properties(body).mass() *
              source.gravity().dot(X_WC.point(carriers_->frames[body.index].p));
  }
  return held;
}

void MergedWorld::make_forces(const World& source) {
  source_laws_ = source.parts_->forces.acting();
  std::vector<std::shared_ptr<const Force>> laws = carried_laws(source);
  if (const double held = held_potential(source); held != 0)
    laws.push_back(std::make_shared<HeldWeight>(held));
  world_.parts_->forces.replace(std::move(laws), source.parts_->forces);
}

/// What is woken in the source wakes its carrier.
void MergedWorld::take_wakes(const World& source) {
  if (wake_version_seen_ == source.parts_->sleep.wake_version()) return;
  for (int b = 0; b < source.body_count(); ++b)
    if (wake_counts_seen_[b] != source.parts_->sleep.wake_count(b)) world_.wake(carriers_->bodies[b]);
  note_wakes(source);
}

void MergedWorld::note_wakes(const World& source) {
  wake_counts_seen_ = source.parts_->sleep.wake_counts();
  wake_version_seen_ = source.parts_->sleep.wake_version();
}

void MergedWorld::give_sleep(World& source) const {
  bool changed = false;
  for (int b = 0; b < source.body_count(); ++b) {
    const bool asleep =
        world_.parts_->sleep.is_asleep(carriers_->bodies[b].index) && !source.parts_->bodies.is_fixed(b);
    changed = changed || asleep != source.parts_->sleep.is_asleep(b);
    source.parts_->sleep.set_asleep(b, asleep);
  }
  if (changed) ++source.parts_->versions.sleep;
}

void MergedWorld::take_properties(const World& source) {
  world_.parts_->breakable = source.parts_->breakable;
  world_.parts_->materials = source.parts_->materials;
  world_.parts_->shapes.copy_materials(source.parts_->shapes);
  world_.parts_->collisions.copy_overrides(source.parts_->collisions);
  seen_.properties = source.parts_->versions.properties;
}

void MergedWorld::take_state(const World& source) {
  world_.state_ = source.state_;
  for (const MergedGroup& group : groups_) {
    for (BodyId body : group.members) world_.state_.twists[body.index] = {};
    if (group.fixed) continue;
    world_.state_.poses[group.carrier.index] = nearest_pose(group, source);
    world_.state_.twists[group.carrier.index] = common_twist(group, source);
  }
}

/// Σ m |p_B − p_WB|² + θ·I θ of the members' moves is least: Newton's method in the rotation, the common
/// centre is where it is.
Pose MergedWorld::nearest_pose(const MergedGroup& group, const World& source) const {
  const MassProperties& all = world_.mass_properties(group.carrier);
  Pose X{(source.pose(group.carrier).q * carriers_->frames[group.carrier.index].q.conjugate()).normalized(),
         Vec3::Zero()};
  for (BodyId body : group.members)
    X.p += source.mass_properties(body).mass() / all.mass() * source.pose(body).p;
  for (int iteration = 0; iteration < kMaxPlacings; ++iteration) {
    Vec3 off = Vec3::Zero();
    for (BodyId body : group.members) {
      const MassProperties& own = source.mass_properties(body);
      const Pose &X_WB = source.pose(body), &X_CB = carriers_->frames[body.index];
      const Vec3 arm = X.q * X_CB.p;
      off += own.mass() * arm.cross(X_WB.p - X.p) +
             turned_inertia(own, X_WB.q) * log_so3(X_WB.q * (X.q * X_CB.q).conjugate());
    }
    const Mat3 R = X.q.toRotationMatrix();
    const Vec3 turn = R * dense::solve_symmetric3(all.inertia_B(), R.transpose() * off);
    X.q = (exp_so3(turn) * X.q).normalized();
    if (!(turn.norm() > 1e-15)) break;
  }
  return X;
}

/// The momenta of the members, as the joints would leave them.
Twist MergedWorld::common_twist(const MergedGroup& group, const World& source) const {
  const MassProperties& all = world_.mass_properties(group.carrier);
  const Pose& X = world_.pose(group.carrier);
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
  for (BodyId body : group.members) {
    const MassProperties& own = source.mass_properties(body);
    const Twist& V = source.twist(body);
    const Pose& X_WB = source.pose(body);
    linear += own.mass() * V.v;
    angular += (X_WB.p - X.p).cross(own.mass() * V.v) + turned_inertia(own, X_WB.q) * V.w;
  }
  const Mat3 R = X.q.toRotationMatrix();
  return {R * dense::solve_symmetric3(all.inertia_B(), R.transpose() * angular), linear / all.mass()};
}

bool MergedWorld::is_within_carrier(const LineSpring& spring) const {
  return carriers_->bodies[spring.a.index] == carriers_->bodies[spring.b.index];
}

void MergedWorld::source_forces(const State& source, std::span<Wrench> wrenches, Springs springs) const {
  for (std::size_t b = 0; b < source_masses_.size(); ++b)
    wrenches[b] = {Vec3::Zero(),
                   source_fixed_[b] ? Vec3(Vec3::Zero()) : Vec3(source_masses_[b].mass() * world_.gravity_)};
  for (const auto& law : source_laws_) {
    const bool has_rows = springs == Springs::kLeftOut && law->spring() && !is_within_carrier(*law->spring());
    if (!has_rows) law->accumulate(source, wrenches);
  }
}

void MergedWorld::expand(const State& merged, State& source) const {
  source = merged;
  place_carried(*carriers_, carried_, merged, source);
}

MergedWorld::OpenWeld MergedWorld::widest_weld(const World& source, const State& state) const {
  OpenWeld widest;
  for (const MergedGroup& group : groups_)
    for (const auto* welds : {&group.welds, &group.loops})
      for (JointId weld : *welds) {
        if (weld.index < 0) continue;
        const Gap gap = weld_gap(source.joint(weld), state);
        // Written so that a NaN shows.
        const double worst = std::max(widest.gap.metres, widest.gap.radians);
        if (widest.joint.index < 0 || !(std::max(gap.metres, gap.radians) <= worst)) widest = {weld, gap};
      }
  return widest;
}

}  // namespace taut
