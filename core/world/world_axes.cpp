#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/world/swing_properties.h"
#include "core/world/world.h"
#include "core/world/world_parts.h"

// Free axes of joints, as the World keeps them.
namespace taut {
namespace {

bool is_winch(const AxisProperties& p) { return p.motor && p.motor->pulls_only; }

/// What a winch has let out takes the place of the upper limit, and becomes that when the winch goes.
/// `theta`: of the axis now.  True if `let_out` is another.
bool wind(const AxisProperties& before, AxisProperties& after, double theta, double& let_out) {
  if (is_winch(after)) {
    const bool limited = after.limits && after.limits->upper < kUnlimited;
    if (!limited && is_winch(before)) return false;
    let_out = limited ? after.limits->upper : theta;
    if (limited) after.limits->upper = kUnlimited;
    if (limited && after.limits->lower == -kUnlimited) after.limits.reset();
    return true;
  }
  if (!is_winch(before)) return false;
  if (!after.limits) after.limits.emplace();
  if (after.limits->upper == kUnlimited) after.limits->upper = let_out;
  return false;
}

}  // namespace

AxisId World::axis(JointId joint, std::string_view name) const {
  std::string known;
  for (int k = 0; k < axis_count(joint); ++k) {
    const std::string& here = axis_info({joint, k}).name;
    if (here == name) return {joint, k};
    known += (k > 0 ? ", " : "") + here;
  }
  fail("axis of " + this->name(joint),
       known.empty() ? "the joint has no free axis" : "there is none of this name, only " + known, name);
}

bool World::has_axis_properties(JointId joint) const {
  const std::span<const AxisProperties> properties = parts_->axes.properties_of(joint);
  return std::any_of(properties.begin(), properties.end(), [](const auto& p) { return p.any(); });
}

std::string World::axis_label(AxisId id) const { return name(id.joint) + " " + axis_info(id).name; }

void World::set_axis_properties(AxisId id, AxisProperties properties) {
  parts_->identity.require_free();
  const AxisInfo& info = axis_info(id);
  properties.each([&](const auto& property) {
    if constexpr (requires { property.needs_position(); })
      if (const char* what = property.needs_position(); what && info.accumulates)
        fail(std::string(what) + " of " + axis_label(id), "needs an axis with a position, not a turn about",
             info.name);
    check_axis(axis_label(id), property);
  });
  if (properties.motor && properties.motor->pulls_only && !info.is_wound)
    fail("motor of " + axis_label(id), "can only pull at the length of a rope, not at", info.name);
  AxisProperties& here = parts_->axes.properties(axis_index(id));
  if (info.is_wound && wind(here, properties, axis_value(id), state_.axes[axis_index(id)]))
    ++parts_->versions.state;
  const bool before = here.any();
  const auto swing = swing_properties(*this, id.joint);
  here = std::move(properties);
  wake_bodies_of(id.joint);
  if (here.any() != before || swing_properties(*this, id.joint) != swing) ++parts_->versions.topology;
  ++parts_->versions.axes;
}

void World::set_motor_target(AxisId id, double target) {
  parts_->identity.require_free();
  AxisProperties& properties = parts_->axes.properties(axis_index(id));
  if (!properties.motor) fail("motor target of " + axis_label(id), "the axis has no motor", target);
  if (properties.motor->mode == AxisMotor::Mode::kTrajectory)
    fail("motor target of " + axis_label(id), "the motor follows a trajectory", target);
  if (!std::isfinite(target)) fail("motor target of " + axis_label(id), "must be finite", target);
  if (properties.motor->target != target) wake_bodies_of(id.joint);
  properties.motor->target = target;
  ++parts_->versions.axes;
}

double World::axis_value(AxisId id) const {
  double value = 0;
  axis_info(id).coordinate->residual(state_, &value);
  return value;
}

double World::axis_rate(AxisId id) const {
  const AxisInfo& info = axis_info(id);
  std::vector<double> values(6 * info.bodies.size(), 0.0);
  info.coordinate->jacobian(state_, values.data());
  double rate = 0;
  const double* J = values.data();
  for (int body : info.bodies) {
    const Twist& V = state_.twists[body];
    for (int k = 0; k < 3; ++k) rate += J[k] * V.w[k] + J[3 + k] * V.v[k];
    J += 6;
  }
  return rate;
}

void World::set_axis_turns(AxisId id, double value) {
  parts_->identity.require_free();
  const int index = axis_index(id);
  if (!std::isfinite(value)) fail("value of " + axis_label(id), "must be finite", value);
  if (axis_info(id).is_wound) return;  // it has no turns
  state_.axes[index] = value;
  state_.axes[index] = axis_value(id);
  wake_bodies_of(id.joint);
  ++parts_->versions.state;
}

int World::axis_count(JointId joint) const { return parts_->axes.count_of(joint); }
int World::axis_index(AxisId id) const { return parts_->axes.checked(id); }
const AxisInfo& World::axis_info(AxisId id) const { return parts_->axes.info(axis_index(id)); }
const AxisProperties& World::axis_properties(AxisId id) const {
  return parts_->axes.properties(axis_index(id));
}

double let_out(const World& world, AxisId id) {
  if (!is_winch(world.axis_properties(id)))
    fail("rope let out of " + world.axis_label(id), "there is no", "winch");
  return world.state().axes[world.axis_index(id)];
}

}  // namespace taut
