#include <algorithm>

#include "core/base/check.h"
#include "core/world/joint_frame.h"
#include "core/world/world.h"

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
  identity_.require_free();
  if (!joint) fail("joint " + name, "must not be null", "null");
  const int index = joint_count();
  const std::string shown = joints_.names().shown(name);
  check_joint_bodies(*this, shown, *joint);
  if (joint->axes_needed() > axes_.count())
    fail("joint " + shown, "couples an axis that is not in this world", joint->axes_needed() - 1);
  std::vector<AxisInfo> axes = axes_of(shown, *joint, axes_.count());
  check_coupled_joints(*this, shown, *joint);
  joints_.add(std::move(name), joint);
  axes_.add_joint(std::move(axes));
  state_.axes.resize(axes_.count());
  collisions_.add_joint(*joint);
  wake_bodies_of({index});
  ++versions_.topology;
  return {index};
}

void World::set_break(JointId id, std::optional<BreakLimits> limits) {
  identity_.require_free();
  const std::string& shown = name(id);
  if (limits) check_joint(shown, *limits);
  breakable_.set(id, limits);
  wake_bodies_of(id);
  ++versions_.properties;
}

void World::set_compliance(JointId id, std::optional<JointCompliance> compliance) {
  identity_.require_free();
  const std::string& shown = name(id);
  if (compliance) check_joint(shown, *compliance);
  const bool other_rows = soft_joints_.set(id.index, joint(id), compliance);
  wake_bodies_of(id);
  if (other_rows) ++versions_.topology;
  ++versions_.axes;
}

double World::spring_energy_of(JointId id, const State& state) const {
  double energy = 0;
  const int first = axes_.first(joints_.checked(id));
  for (int k = first; k < first + axis_count(id); ++k) {
    const AxisProperties& properties = axes_.properties(k);
    if (!properties.stores_energy()) continue;
    double theta = 0;
    axes_.info(k).coordinate->residual(state, &theta);
    properties.add_energy(theta, energy);
  }
  return energy + soft_joints_.energy(id.index, state);
}

void World::detach(JointId id) {
  identity_.require_free();
  if (!is_attached(id)) return;
  joints_.detach(id.index);
  wake_bodies_of(id);
  for (JointId coupling : joints_.coupled_to(id)) detach(coupling);
  collisions_.set_joints(joints_);
  ++versions_.topology;
}

void World::detach_all_but(std::span<const JointId> joints) {
  identity_.require_free();
  const std::set<int> stay = joints_.with_coupled(joints);
  for (int j = 0; j < joint_count(); ++j)
    if (!stay.contains(j)) joints_.detach(j);
  wake_all();
  collisions_.set_joints(joints_);
  ++versions_.topology;
}

void World::attach(JointId id) {
  identity_.require_free();
  if (is_attached(id)) return;
  check_coupled_joints(*this, name(id), joint(id));
  joints_.attach(id.index);
  wake_bodies_of(id);
  collisions_.set_joints(joints_);
  ++versions_.topology;
}

void World::set_joint_frame(JointId id, const Pose& X_BF) {
  identity_.require_free();
  const std::string& shown = name(id);
  const Joint& before = joint(id);
  require_all_finite("frame of joint " + shown, X_BF.p);
  require_unit("frame of joint " + shown, X_BF.q.coeffs());
  if (before.bodies().size() != 2 || before.axes_needed() > 0 || !before.couples().empty())
    fail("joint " + shown, "has no frame on one of two bodies that could be moved", before.type());
  auto moved = detail::with_frame(joints_.shared(id.index), {X_BF.q.normalized(), X_BF.p});
  axes_.set_coordinates(id.index, axes_of(shown, *moved, axes_.first(id.index)));
  joints_.replace(id.index, moved);
  const std::optional<JointCompliance> soft = compliance(id);
  soft_joints_.set(id.index, *moved, std::nullopt);
  soft_joints_.set(id.index, *moved, soft);
  wake_bodies_of(id);
  ++versions_.topology;
}

std::span<const std::pair<JointId, BreakLimits>> World::breakable() const { return breakable_.all(); }

}  // namespace taut
