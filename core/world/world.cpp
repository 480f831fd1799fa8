#include "core/world/world.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <sstream>

#include "core/base/check.h"
#include "core/constraints/rows.h"
#include "core/state/reach.h"
#include "core/world/diagnostics.h"

namespace taut {
namespace {

void check_pose(const std::string& name, const Pose& pose) {
  require_within_reach("position of " + name, pose.p);
  require_unit("orientation of " + name, pose.q.coeffs());
}

void check_twist(const std::string& name, const Twist& twist, bool fixed) {
  require_within_reach("angular velocity of " + name, twist.w);
  require_within_reach("velocity of " + name, twist.v);
  if (!fixed) return;
  if (!twist.v.isZero(0)) fail_with("velocity of " + name, "a fixed body cannot move", twist.v);
  if (!twist.w.isZero(0)) fail_with("angular velocity of " + name, "a fixed body cannot move", twist.w);
}

/// A law that can have rows: one that pulls a body towards itself does nothing.
bool is_spring(const Force& force) {
  const LineSpring* spring = force.spring();
  return spring && spring->a != spring->b;
}

/// One spring in place of the other changes no more than values of its law.
bool same_rows(const Force& one, const Force& other) {
  if (!is_spring(one) || !is_spring(other)) return false;
  const LineSpring &a = *one.spring(), &b = *other.spring();
  return a.a == b.a && a.b == b.b && a.p_AP == b.p_AP && a.p_BQ == b.p_BQ &&
         a.is_centred() == b.is_centred() && a.is_damped() == b.is_damped();
}

/// Takes the name, or makes up a free one, and registers it.
std::string register_name(std::unordered_map<std::string, int>& names, std::string name, const char* kind,
                          int index) {
  if (name.empty()) {
    name = std::string(kind) + "_" + std::to_string(index);
    while (names.contains(name)) name += "_";
  }
  if (!names.emplace(name, index).second) fail(kind, "name is already taken", name);
  return name;
}

/// Rigid limits that axes of a joint are beyond by more than a tolerance: they come back at a bounded rate.
void add_passed_limits(const World& world, JointId joint, double tolerance, std::vector<Problem>& problems) {
  for (int k = 0; k < world.axis_count(joint) && world.is_attached(joint); ++k) {
    const AxisId axis{joint, k};
    const std::optional<AxisLimits>& limits = world.axis_properties(axis).limits;
    if (!limits || limits->compliance > 0) continue;
    const double value = world.axis_value(axis);
    const bool low = value < limits->lower - tolerance;
    if (!low && !(value > limits->upper + tolerance)) continue;
    std::ostringstream message;
    message << "axis " << world.axis_info(axis).name << " starts at " << value << ", "
            << (low ? "below its lower limit " : "above its upper limit ")
            << (low ? limits->lower : limits->upper);
    problems.push_back({std::string(world.joint(joint).type()) + " " + world.name(joint), message.str()});
  }
}

}  // namespace

World::World() {
  BodySpec ground;
  ground.name = "ground";
  ground.fixed = true;
  add_body(ground);
}

BodyId World::add_body(BodySpec spec) {
  identity_.require_free();
  const int index = body_count();
  const std::string shown = spec.name.empty() ? "body_" + std::to_string(index) : spec.name;
  check_pose(shown, spec.pose);
  check_twist(shown, spec.twist, spec.fixed);
  body_names_.push_back(register_name(body_of_name_, std::move(spec.name), "body", index));
  masses_.push_back(spec.mass);
  fixed_.push_back(spec.fixed);
  asleep_.push_back(false);
  stirs_.push_back(0);
  moving_count_ += !spec.fixed;
  spec.pose.q.normalize();
  state_.poses.push_back(spec.pose);
  state_.twists.push_back(spec.twist);
  ++topology_version_;
  return {index};
}

JointId World::add_joint(std::string name, std::shared_ptr<const Joint> joint) {
  identity_.require_free();
  if (!joint) fail("joint " + name, "must not be null", "null");
  const int index = joint_count();
  const std::string shown = name.empty() ? "joint_" + std::to_string(index) : name;
  const std::span<const BodyId> bodies = joint->bodies();
  if (bodies.size() < 2) fail("joint " + shown, "must have two bodies or more", bodies.size());
  std::string fixed_names;
  bool all_fixed = true;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].index < 0 || bodies[i].index >= body_count())
      fail("joint " + shown, "no such body", bodies[i].index);
    if (std::find(bodies.begin(), bodies.begin() + i, bodies[i]) != bodies.begin() + i)
      fail("joint " + shown, "joins a body to itself", this->name(bodies[i]));
    all_fixed = all_fixed && is_fixed(bodies[i]);
    fixed_names += (i > 0 ? ", " : "") + this->name(bodies[i]);
  }
  if (all_fixed)
    fail("joint " + shown, bodies.size() == 2 ? "joins two fixed bodies" : "joins fixed bodies only",
         fixed_names);
  if (joint->axes_needed() > static_cast<int>(axes_.size()))
    fail("joint " + shown, "couples an axis that is not in this world", joint->axes_needed() - 1);
  std::vector<AxisInfo> axes;
  AxisSink sink;
  sink.joint_ = joint.get();
  sink.infos_ = &axes;
  sink.first_index_ = axis_start_.back();
  joint->append_axes(sink);
  for (const AxisInfo& axis : axes) check_axis(shown + " " + axis.name, axis.limits);
  for (JointId other : joint->couples())
    if (!is_attached(other)) fail("joint " + shown, "couples an axis of a detached joint", this->name(other));
  joint_names_.push_back(register_name(joint_of_name_, std::move(name), "joint", index));
  for (AxisInfo& axis : axes) {
    AxisProperties properties;
    if (axis.limits.lower > -kUnlimited || axis.limits.upper < kUnlimited) properties.limits = axis.limits;
    axis_properties_.push_back(std::move(properties));
    axes_.push_back(std::move(axis));
    state_.axes.push_back(0);
  }
  axis_start_.push_back(static_cast<int>(axes_.size()));
  note_jointed_bodies(*joint);
  joints_.push_back(std::move(joint));
  wake_bodies_of({index});
  ++topology_version_;
  return {index};
}

void World::check_force(const Force* force) const {
  if (!force) fail("force", "must not be null", "null");
  for (BodyId body : force->bodies())
    if (body.index < 0 || body.index >= body_count()) fail("force", "no such body", body.index);
}

ForceId World::add_force(std::shared_ptr<const Force> force) {
  identity_.require_free();
  check_force(force.get());
  wake_or_all(force->bodies());
  if (is_spring(*force)) ++topology_version_;
  forces_.push_back(std::move(force));
  read_force(force_count() - 1);
  ++state_version_;
  return {force_count() - 1};
}

void World::set_force(ForceId id, std::shared_ptr<const Force> force) {
  identity_.require_free();
  const int index = checked(id);
  check_force(force.get());
  wake_or_all(forces_[index]->bodies());
  wake_or_all(force->bodies());
  if (is_spring(*forces_[index]) || is_spring(*force))
    ++(same_rows(*forces_[index], *force) ? axis_version_ : topology_version_);
  forces_[index] = std::move(force);
  read_forces();
  ++state_version_;
}

void World::read_forces() {
  springs_.clear();
  velocity_forces_ = dissipative_forces_ = velocity_laws_ = dissipative_laws_ = false;
  for (int f = 0; f < force_count(); ++f) read_force(f);
}

void World::read_force(int index) {
  const Force& force = *forces_[index];
  const bool spring = is_spring(force), moves = force.depends_on_velocity(), takes = !force.conservative();
  if (spring) springs_.push_back({index});
  velocity_forces_ = velocity_forces_ || moves;
  dissipative_forces_ = dissipative_forces_ || takes;
  velocity_laws_ = velocity_laws_ || (moves && !spring);
  dissipative_laws_ = dissipative_laws_ || (takes && !spring);
}

void World::set_gravity(const Vec3& gravity) {
  identity_.require_free();
  require_all_finite("gravity", gravity);
  gravity_ = gravity;
  wake_all();
  ++state_version_;
}

BodyId World::body(std::string_view name) const {
  const auto found = body_of_name_.find(std::string(name));
  if (found == body_of_name_.end()) fail("body", "there is none of this name", name);
  return {found->second};
}

JointId World::joint(std::string_view name) const {
  const auto found = joint_of_name_.find(std::string(name));
  if (found == joint_of_name_.end()) fail("joint", "there is none of this name", name);
  return {found->second};
}

void World::set_pose(BodyId id, const Pose& pose) {
  identity_.require_free();
  check_pose(name(id), pose);
  if (id == kGround) fail_with("pose of ground", "cannot be changed", pose.p);
  state_.poses[id.index] = pose;
  state_.poses[id.index].q.normalize();
  is_fixed(id) ? wake_all() : wake(id);
  ++state_version_;
}

void World::set_twist(BodyId id, const Twist& twist) {
  identity_.require_free();
  check_twist(name(id), twist, is_fixed(id));
  state_.twists[id.index] = twist;
  wake(id);
  ++state_version_;
}

void World::check_state(const State& state) const {
  if (state.poses.size() != state_.poses.size())
    fail("state", "must have one pose per body", state.poses.size());
  if (state.twists.size() != state_.twists.size())
    fail("state", "must have one twist per body", state.twists.size());
  if (state.axes.size() != state_.axes.size())
    fail("state", "must have one value per axis", state.axes.size());
  require_finite("time of the state", state.time);
  for (std::size_t i = 0; i < state.axes.size(); ++i)
    if (!std::isfinite(state.axes[i])) fail("axis value " + axes_[i].name, "must be finite", state.axes[i]);
  const Pose& ground = state.poses[0];
  if (!ground.p.isZero(0) || ground.q.coeffs() != Quat::Identity().coeffs())
    fail_with("pose of ground", "cannot be changed", ground.p);
  for (int b = 0; b < body_count(); ++b) {
    // Solvers come here every step: a good state is passed without making messages, that is without
    // allocating.
    const Pose& X = state.poses[b];
    const Twist& V = state.twists[b];
    const bool good = within_reach(X, V) && std::abs(X.q.norm() - 1) <= kUnitTolerance &&
                      !(fixed_[b] && !(V.w.isZero(0) && V.v.isZero(0)));
    if (good) continue;
    check_pose(body_names_[b], X);
    check_twist(body_names_[b], V, fixed_[b]);
  }
}

void World::set_state(const State& state) {
  identity_.require_free();
  check_state(state);
  if (asleep_count_ > 0) wake_moved(state);
  state_ = state;
  ++state_version_;
}

void World::exchange_state(State& state) {
  identity_.require_free();
  check_state(state);
  if (asleep_count_ > 0) wake_moved(state);
  std::swap(state_, state);
  ++state_version_;
}

void World::set_time(double time) {
  identity_.require_free();
  require_finite("time", time);
  state_.time = time;
  ++state_version_;
}

void World::forces(const State& state, std::span<Wrench> wrenches, Springs springs) const {
  assert(static_cast<int>(wrenches.size()) == body_count());
  assert(state.poses.size() == state_.poses.size() && state.twists.size() == state_.twists.size());
  const Hold held = hold();
  for (int b = 0; b < body_count(); ++b) {
    wrenches[b].torque.setZero();
    wrenches[b].force = fixed_[b] ? Vec3(Vec3::Zero()) : Vec3(masses_[b].mass() * gravity_);
  }
  for (const auto& force : forces_)
    if (springs == Springs::kIncluded || !is_spring(*force)) force->accumulate(state, wrenches);
}

double World::potential_energy(const State& state) const {
  const Hold held = hold();
  double energy = 0;
  for (int b = 0; b < body_count(); ++b)
    if (!fixed_[b]) energy -= masses_[b].mass() * gravity_.dot(state.poses[b].p);
  for (const auto& force : forces_) energy += force->potential_energy(state);
  for (int j = 0; j < joint_count(); ++j)
    if (is_attached({j})) energy += spring_energy_of({j}, state);
  return energy;
}

double World::spring_energy(const State& state) const {
  const Hold held = hold();
  double energy = 0;
  for (const auto& force : forces_)
    if (force->spring()) energy += force->potential_energy(state);
  for (int j = 0; j < joint_count(); ++j)
    if (is_attached({j})) energy += spring_energy_of({j}, state);
  return energy;
}

double World::add_dissipative_forces(const State& state, std::span<Wrench> wrenches, Springs springs) const {
  const Hold held = hold();
  double energy = 0;
  for (const auto& force : forces_) {
    if (force->conservative() || (springs == Springs::kLeftOut && is_spring(*force))) continue;
    force->accumulate(state, wrenches);
    energy += force->potential_energy(state);
  }
  return energy;
}

std::vector<Problem> World::validate(double gap_tolerance) const {
  std::vector<Problem> problems;
  const Rows rows(*this);
  std::vector<double> phi(rows.row_count());
  rows.residual(state_, phi);
  const std::vector<Gap> gaps = joint_gaps(rows, phi);
  for (int j = 0; j < joint_count(); ++j) {
    std::ostringstream message;
    // Written so that a gap that is not a number counts as open.
    if (!(gaps[j].metres <= gap_tolerance)) message << "is open at the start by " << gaps[j].metres << " m";
    if (!(gaps[j].radians <= gap_tolerance))
      message << (message.tellp() > 0 ? " and " : "is open at the start by ") << gaps[j].radians << " rad";
    if (message.tellp() > 0)
      problems.push_back({std::string(joints_[j]->type()) + " " + joint_names_[j], message.str()});
    add_passed_limits(*this, JointId{j}, gap_tolerance, problems);
  }
  return problems;
}

int World::checked(BodyId id) const {
  if (id.index < 0 || id.index >= body_count()) fail("body id", "no such body", id.index);
  return id.index;
}

int World::checked(ForceId id) const {
  if (id.index < 0 || id.index >= force_count()) fail("force id", "no such force", id.index);
  return id.index;
}

int World::checked(JointId id) const {
  if (id.index < 0 || id.index >= joint_count()) fail("joint id", "no such joint", id.index);
  return id.index;
}

}  // namespace taut
