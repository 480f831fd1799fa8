#include <cmath>
#include <utility>

#include "core/base/check.h"
#include "core/state/reach.h"
#include "core/world/world.h"
#include "core/world/world_parts.h"

// Bodies, where they are and how they move.
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

}  // namespace

BodyId World::add_body(BodySpec spec) {
  parts_->identity.require_free();
  const int index = body_count();
  const std::string shown = parts_->bodies.names().shown(spec.name);
  check_pose(shown, spec.pose);
  check_twist(shown, spec.twist, spec.fixed);
  parts_->bodies.add(std::move(spec.name), spec.mass, spec.fixed);
  parts_->sleep.add_body();
  spec.pose.q.normalize();
  state_.poses.push_back(spec.pose);
  state_.twists.push_back(spec.twist);
  ++parts_->versions.topology;
  return {index};
}

void World::set_pose(BodyId id, const Pose& pose) {
  parts_->identity.require_free();
  check_pose(name(id), pose);
  if (id == kGround) fail_with("pose of ground", "cannot be changed", pose.p);
  state_.poses[id.index] = pose;
  state_.poses[id.index].q.normalize();
  is_fixed(id) ? wake_all() : wake(id);
  ++parts_->versions.state;
}

void World::set_twist(BodyId id, const Twist& twist) {
  parts_->identity.require_free();
  check_twist(name(id), twist, is_fixed(id));
  state_.twists[id.index] = twist;
  wake(id);
  ++parts_->versions.state;
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
    if (!std::isfinite(state.axes[i]))
      fail("axis value " + parts_->axes.info(static_cast<int>(i)).name, "must be finite", state.axes[i]);
  const Pose& ground = state.poses[0];
  if (!ground.p.isZero(0) || ground.q.coeffs() != Quat::Identity().coeffs())
    fail_with("pose of ground", "cannot be changed", ground.p);
  for (int b = 0; b < body_count(); ++b) {
    // Solvers come here every step: a good state is passed without making messages, that is without
    // allocating.
    const Pose& X = state.poses[b];
    const Twist& V = state.twists[b];
    const bool fixed = parts_->bodies.is_fixed(b);
    const bool good = within_reach(X, V) && std::abs(X.q.norm() - 1) <= kUnitTolerance &&
                      !(fixed && !(V.w.isZero(0) && V.v.isZero(0)));
    if (good) continue;
    check_pose(parts_->bodies.names()[b], X);
    check_twist(parts_->bodies.names()[b], V, fixed);
  }
}

void World::set_state(const State& state) {
  parts_->identity.require_free();
  check_state(state);
  wake_moved(state);
  state_ = state;
  ++parts_->versions.state;
}

void World::exchange_state(State& state) {
  parts_->identity.require_free();
  check_state(state);
  wake_moved(state);
  std::swap(state_, state);
  ++parts_->versions.state;
}

void World::set_time(double time) {
  parts_->identity.require_free();
  require_finite("time", time);
  state_.time = time;
  ++parts_->versions.state;
}

int World::moving_body_count() const { return parts_->bodies.moving_count(); }
const MassProperties& World::mass_properties(BodyId id) const {
  return parts_->bodies.mass(parts_->bodies.checked(id));
}
bool World::is_fixed(BodyId id) const { return parts_->bodies.is_fixed(parts_->bodies.checked(id)); }
const std::string& World::name(BodyId id) const { return parts_->bodies.names()[parts_->bodies.checked(id)]; }
BodyId World::body(std::string_view name) const { return {parts_->bodies.names().index_of(name)}; }
bool World::has_body(std::string_view name) const { return parts_->bodies.names().contains(name); }
const Pose& World::pose(BodyId id) const { return state_.poses[parts_->bodies.checked(id)]; }
const Twist& World::twist(BodyId id) const { return state_.twists[parts_->bodies.checked(id)]; }

}  // namespace taut
