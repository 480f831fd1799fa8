#include <algorithm>
#include <deque>

#include "benchmarks/peers/peer.h"
#include "core/base/check.h"

namespace taut::peers {
namespace {

/// The axis of a hinge from the Jacobian of its angle: ∂θ/∂ω_B.
Vec3 hinge_axis(const World& world, JointId id) {
  const AxisInfo& info = world.axis_info(world.axis(id, "angle"));
  std::vector<double> values(6 * info.bodies.size());
  info.coordinate->jacobian(world.state(), values.data());
  return Vec3(values[6], values[7], values[8]).normalized();
}

PeerJoint joint_of(const World& world, JointId id) {
  const Joint& joint = world.joint(id);
  PeerJoint out;
  if (joint.type() == "ball")
    out.kind = JointKind::kBall;
  else if (joint.type() == "hinge")
    out.kind = JointKind::kHinge;
  else if (joint.type() == "fixed")
    out.kind = JointKind::kFixed;
  else
    fail("joint " + world.name(id), "is of a type that peers are not given", joint.type());
  out.a = joint.a().index, out.b = joint.b().index;
  out.p_BQ = joint.reaction_point_B();
  out.p_W = world.pose(joint.b()).point(out.p_BQ);
  out.p_AP = world.pose(joint.a()).local(out.p_W);
  if (out.kind == JointKind::kHinge) out.axis_W = hinge_axis(world, id);
  return out;
}

void span(System& system) {
  std::vector<std::vector<int>> at(system.body_count());
  for (std::size_t j = 0; j < system.joints.size(); ++j) {
    at[system.joints[j].a].push_back(static_cast<int>(j));
    at[system.joints[j].b].push_back(static_cast<int>(j));
  }
  std::vector<char> reached(system.body_count()), used(system.joints.size());
  std::deque<int> open;
  for (int root = 0; root < system.body_count(); ++root) {
    if (reached[root]) continue;
    if (root > 0) system.tree.push_back({TreeEdge::kFree, 0, root});
    reached[root] = 1;
    open.push_back(root);
    while (!open.empty()) {
      const int body = open.front();
      open.pop_front();
      for (int j : at[body]) {
        const int other = system.joints[j].a == body ? system.joints[j].b : system.joints[j].a;
        if (reached[other]) continue;
        reached[other] = used[j] = 1;
        system.tree.push_back({j, body, other});
        open.push_back(other);
      }
    }
  }
  for (std::size_t j = 0; j < system.joints.size(); ++j)
    if (!used[j]) system.loops.push_back(static_cast<int>(j));
}

}  // namespace

bool System::has_free_bodies() const {
  return std::any_of(tree.begin(), tree.end(),
                     [](const TreeEdge& edge) { return edge.joint == TreeEdge::kFree; });
}

void refuse_contact(const System& system) {
  if (system.has_contact()) throw Unsupported("contact");
  if (system.has_free_bodies()) throw Unsupported("free bodies");
}

void require_plain_contact(const System& system) {
  for (int s = 0; s < system.world->shape_count(); ++s) {
    const Material& material = system.world->shape(ShapeId{s}).material;
    if (material.restitution > 0) throw Unsupported("restitution");
    if (material.static_friction > material.dynamic_friction) throw Unsupported("static friction");
  }
}

System describe(const World& world) {
  System system;
  system.world = &world;
  for (int b = 1; b < world.body_count(); ++b)
    if (!world.mass_properties(BodyId{b}).body_axes_are_principal())
      fail("body " + world.name(BodyId{b}), "must have principal axes", b);
  for (int j = 0; j < world.joint_count(); ++j) system.joints.push_back(joint_of(world, JointId{j}));
  span(system);
  return system;
}

Method::Method(const std::string& all) : text(all), name(all.substr(0, all.find(':'))) {
  std::size_t at = name.size();
  while (at < all.size()) {
    const std::size_t equals = all.find('=', at + 1), end = std::min(all.find(',', at + 1), all.size());
    if (equals == all.npos || equals > end) fail("--method", "must be name:key=value,…", all);
    values[all.substr(at + 1, equals - at - 1)] = std::stod(all.substr(equals + 1, end - equals - 1));
    at = end;
  }
}

double Method::get(const std::string& key, double fallback) const {
  const auto found = values.find(key);
  return found == values.end() ? fallback : found->second;
}

}  // namespace taut::peers
