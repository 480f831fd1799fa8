#include <algorithm>
#include <set>

#include "core/base/check.h"
#include "core/world/joint_frame.h"
#include "core/world/world.h"
#include "core/world/world_parts.h"

// Joints as a whole: what they join and bear, how they give way, leaving and coming back.
namespace taut {
namespace {

/// Two or more different bodies, not all of them fixed.
void check_joint_bodies(const World& world, const std::string& shown, const Joint& joint) {
  const std::span<const BodyId> bodies = joint.bodies();
  if (bodies.size() < 2) fail("joint " + shown, "must have two bodies or more", bodies.size());
  std::string names;
  for (auto body = bodies.begin(); body != bodies.end(); ++body) {
    if (body->index < 0 || body->index >= world.body_count())
      fail("joint " + shown, "no such body", body->index);
    if (std::find(bodies.begin(), body, *body) != body)
      fail("joint " + shown, "joins a body to itself", world.name(*body));
    names += (names.empty() ? "" : ", ") + world.name(*body);
  }
  if (std::all_of(bodies.begin(), bodies.end(), [&](BodyId body) { return world.is_fixed(body); }))
    fail("joint " + shown, bodies.size() == 2 ? "joins two fixed bodies" : "joins fixed bodies only", names);
}

/// The joints whose axes it couples are there.
void check_coupled_joints(const World& world, const std::string& shown, const Joint& joint) {
  for (JointId other : joint.couples())
    if (!world.is_attached(other))
      fail("joint " + shown, "couples an axis of a detached joint", world.name(other));
}

/// The free axes of a joint, of which the first has this index.
std::vector<AxisInfo> axes_of(const std::string& shown, const Joint& joint, int first_index) {
  std::vector<AxisInfo> axes;
  AxisSink sink;
  sink.describe(joint, first_index, axes);
  joint.append_axes(sink);
  for (const AxisInfo& axis : axes) check_axis(shown + " " + axis.name, axis.limits);
  return axes;
}

}  // namespace

JointId World::add_joint(std::string name, std::shared_ptr<const Joint> joint) {
  parts_->identity.require_free();
  if (!joint) fail("joint " + name, "must not be null", "null");
  const int index = joint_count();
  const std::string shown = parts_->joints.names().shown(name);
  check_joint_bodies(*this, shown, *joint);
  if (joint->axes_needed() > parts_->axes.count())
    fail("joint " + shown, "couples an axis that is not in this world", joint->axes_needed() - 1);
  std::vector<AxisInfo> axes = axes_of(shown, *joint, parts_->axes.count());
  check_coupled_joints(*this, shown, *joint);
  parts_->joints.add(std::move(name), joint);
  parts_->axes.add_joint(std::move(axes));
  state_.axes.resize(parts_->axes.count());
  parts_->collisions.add_joint(*joint);
  wake_bodies_of({index});
  ++parts_->versions.topology;
  return {index};
}

void World::set_break(JointId id, std::optional<BreakLimits> limits) {
  parts_->identity.require_free();
  const std::string& shown = name(id);
  if (limits) check_joint(shown, *limits);
  parts_->breakable.set(id, limits);
  wake_bodies_of(id);
  ++parts_->versions.properties;
}

void World::set_compliance(JointId id, std::optional<JointCompliance> compliance) {
  parts_->identity.require_free();
  const std::string& shown = name(id);
  if (compliance) check_joint(shown, *compliance);
  const bool other_rows = parts_->soft_joints.set(id.index, joint(id), compliance);
  wake_bodies_of(id);
  if (other_rows) ++parts_->versions.topology;
  ++parts_->versions.axes;
}

double World::spring_energy_of(JointId id, const State& state) const {
  double energy = 0;
  const int first = parts_->axes.first(parts_->joints.checked(id));
  for (int k = first; k < first + axis_count(id); ++k) {
    const AxisProperties& properties = parts_->axes.properties(k);
    if (!properties.stores_energy()) continue;
    double theta = 0;
    parts_->axes.info(k).coordinate->residual(state, &theta);
    properties.add_energy(theta, energy);
  }
  return energy + parts_->soft_joints.energy(id.index, state);
}

void World::detach(JointId id) {
  parts_->identity.require_free();
  if (!is_attached(id)) return;
  parts_->joints.detach(id.index);
  wake_bodies_of(id);
  for (JointId coupling : parts_->joints.coupled_to(id)) detach(coupling);
  parts_->collisions.set_joints(parts_->joints);
  ++parts_->versions.topology;
}

void World::detach_all_but(std::span<const JointId> joints) {
  parts_->identity.require_free();
  const std::set<int> stay = parts_->joints.with_coupled(joints);
  for (int j = 0; j < joint_count(); ++j)
    if (!stay.contains(j)) parts_->joints.detach(j);
  wake_all();
  parts_->collisions.set_joints(parts_->joints);
  ++parts_->versions.topology;
}

void World::attach(JointId id) {
  parts_->identity.require_free();
  if (is_attached(id)) return;
  check_coupled_joints(*this, name(id), joint(id));
  parts_->joints.attach(id.index);
  wake_bodies_of(id);
  parts_->collisions.set_joints(parts_->joints);
  ++parts_->versions.topology;
}

void World::set_joint_frame(JointId id, const Pose& X_BF) {
  parts_->identity.require_free();
  const std::string& shown = name(id);
  const Joint& before = joint(id);
  require_all_finite("frame of joint " + shown, X_BF.p);
  require_unit("frame of joint " + shown, X_BF.q.coeffs());
  if (before.bodies().size() != 2 || before.axes_needed() > 0 || !before.couples().empty())
    fail("joint " + shown, "has no frame on one of two bodies that could be moved", before.type());
  auto moved = detail::with_frame(parts_->joints.shared(id.index), {X_BF.q.normalized(), X_BF.p});
  parts_->axes.set_coordinates(id.index, axes_of(shown, *moved, parts_->axes.first(id.index)));
  parts_->joints.replace(id.index, moved);
  const std::optional<JointCompliance> soft = compliance(id);
  parts_->soft_joints.set(id.index, *moved, std::nullopt);
  parts_->soft_joints.set(id.index, *moved, soft);
  wake_bodies_of(id);
  ++parts_->versions.topology;
}

std::span<const std::pair<JointId, BreakLimits>> World::breakable() const { return parts_->breakable.all(); }

std::optional<JointCompliance> World::compliance(JointId id) const {
  return parts_->soft_joints.compliance(parts_->joints.checked(id));
}
bool World::is_attached(JointId id) const { return parts_->joints.is_attached(parts_->joints.checked(id)); }
int World::detached_count() const { return parts_->joints.detached_count(); }
int World::joint_count() const { return parts_->joints.count(); }
const Joint& World::joint(JointId id) const { return parts_->joints[parts_->joints.checked(id)]; }
const std::string& World::name(JointId id) const {
  return parts_->joints.names()[parts_->joints.checked(id)];
}
JointId World::joint(std::string_view name) const { return {parts_->joints.names().index_of(name)}; }
bool World::has_joint(std::string_view name) const { return parts_->joints.names().contains(name); }

}  // namespace taut
