#include "scenes/export/model_tree.h"

#include <algorithm>
#include <deque>
#include <sstream>

#include "scenes/recording/recorder.h"
#include "scenes/support/format.h"
#include "scenes/support/suggestion.h"

namespace taut {
namespace {

/// The direction of an axis, by how its rate depends on the velocity of one of its bodies.
Vec3 axis_direction(World& still, AxisId axis, BodyId moved, bool angular) {
  Vec3 direction;
  for (int i = 0; i < 3; ++i) {
    Twist twist;
    (angular ? twist.w : twist.v) = Vec3::Unit(i);
    still.set_twist(moved, twist);
    direction[i] = still.axis_rate(axis);
  }
  still.set_twist(moved, {});
  return direction;
}

/// Joints whose axes follow each other from A to B.
bool is_chain(std::string_view type) {
  constexpr std::string_view kChains[] = {"hinge", "slider", "cylindrical", "planar", "universal", "six_dof"};
  return std::find(std::begin(kChains), std::end(kChains), type) != std::end(kChains);
}

class TreeBuilder {
 public:
  explicit TreeBuilder(const World& world)
      : world_(world), still_(world), reached_(world.body_count(), false) {
    for (int b = 1; b < world.body_count(); ++b)
      if (!world.is_fixed(BodyId{b})) still_.set_twist(BodyId{b}, {});
    joints_of_.resize(world.body_count());
    used_.resize(world.joint_count(), false);
    for (int j = 0; j < world.joint_count(); ++j)
      if (world.joint(JointId{j}).couples().empty() && world.is_attached(JointId{j}))
        for (BodyId body : world.joint(JointId{j}).bodies()) joints_of_[body.index].push_back({j});
  }

  ModelTree build() {
    for (int b = 0; b < world_.body_count(); ++b)
      if (b == 0 || world_.is_fixed(BodyId{b})) reach({.body = {b}, .parent = kGround});
    grow();
    for (int b = 1; b < world_.body_count(); ++b) {
      if (reached_[b]) continue;
      reach({.body = {b}, .parent = kGround, .free = true});
      grow();
    }
    for (int j = 0; j < world_.joint_count(); ++j)
      if (!used_[j]) tree_.others.push_back({j});
    return std::move(tree_);
  }

 private:
  void reach(TreeBody body) {
    reached_[body.body.index] = true;
    waiting_.push_back(body.body);
    if (body.body != kGround) tree_.bodies.push_back(std::move(body));
  }
  void grow() {
    while (!waiting_.empty()) {
      const BodyId from = waiting_.front();
      waiting_.pop_front();
      for (JointId id : joints_of_[from.index]) try_joint(from, id);
    }
  }
  void try_joint(BodyId from, JointId id) {
    const Joint& joint = world_.joint(id);
    if (used_[id.index] || joint.bodies().size() != 2) return;
    const BodyId to = joint.a() == from ? joint.b() : joint.a();
    if (reached_[to.index]) return;
    TreeBody body{.body = to, .parent = from, .joint = id};
    body.anchor = world_.pose(joint.b()).point(joint.reaction_point_B());
    body.ball = joint.type() == "ball";
    const bool chain = is_chain(joint.type()), turned = joint.a() == to;
    if (!chain && !body.ball && joint.type() != "fixed") return;
    if (chain) read_axes(body, turned);
    used_[id.index] = true;
    reach(std::move(body));
  }
  /// Slides first; of a chain from child to parent all the other way round, hinges first.
  void read_axes(TreeBody& body, bool turned) {
    const bool universal = world_.joint(body.joint).type() == "universal";
    const int count = universal ? 2 : world_.axis_count(body.joint);
    for (int k = 0; k < count; ++k) {
      const AxisId id{body.joint, k};
      const bool angular = world_.axis_info(id).angular;
      const Vec3 along = axis_direction(still_, id, body.body, angular);
      body.axes.push_back({id, angular, along.normalized()});
    }
    std::stable_partition(body.axes.begin(), body.axes.end(),
                          [](const TreeAxis& axis) { return !axis.angular; });
    if (turned) std::reverse(body.axes.begin(), body.axes.end());
  }

  const World& world_;
  World still_;
  ModelTree tree_;
  std::vector<std::vector<JointId>> joints_of_;  // by body
  std::vector<bool> used_, reached_;
  std::deque<BodyId> waiting_;
};

}  // namespace

ModelTree model_tree(const World& world) { return TreeBuilder(world).build(); }

std::vector<Vec3> common_points(const World& world, JointId id) {
  const Joint& joint = world.joint(id);
  const Vec3 anchor = world.pose(joint.b()).point(joint.reaction_point_B());
  if (joint.type() == "ball") return {anchor};
  if (joint.type() == "fixed") return {anchor, anchor + Vec3::UnitX(), anchor + Vec3::UnitY()};
  if (joint.type() != "hinge") return {};
  World still = world;
  for (BodyId body : joint.bodies())
    if (!world.is_fixed(body)) still.set_twist(body, {});
  const BodyId moved = world.is_fixed(joint.b()) ? joint.a() : joint.b();
  return {anchor, anchor + axis_direction(still, {id, 0}, moved, true)};
}

AxisWords axis_words(const World& world, AxisId axis, std::vector<std::string>& notices) {
  const AxisProperties& properties = world.axis_properties(axis);
  const std::string label = world.axis_label(axis);
  AxisWords result;
  result.value = world.axis_value(axis);
  if (const auto& limits = properties.limits) {
    if (limits->lower > -kUnlimited) result.lower = limits->lower;
    if (limits->upper < kUnlimited) result.upper = limits->upper;
    if (limits->restitution > 0 || limits->compliance > 0)
      notices.push_back(label + ": restitution and compliance of limits have no counterpart");
  }
  if (const auto& spring = properties.spring) {
    if (spring->table || spring->damping_table)
      notices.push_back(label + ": a spring or damper by a table has no counterpart");
    result.stiffness = spring->stiffness, result.rest = spring->rest, result.damping = spring->damping;
  }
  if (const auto& friction = properties.friction) {
    result.friction = friction->static_friction;
    result.damping += friction->viscous;
    if (friction->per_load > 0 || friction->dynamic_friction != friction->static_friction)
      notices.push_back(label + ": friction by load, or other in motion than at rest, has no counterpart");
  }
  properties.each([&]<typename Property>(const Property&) {
    if constexpr (PlainAxisProperty<Property>)
      notices.push_back(label + ": " + Property::kFacts.phrase + " has no counterpart");
  });
  return result;
}

std::string force_label(const World& world, ForceId force) {
  const Force& law = world.force(force);
  const char* kind = dynamic_cast<const PointForce*>(&law)          ? "point-force"
                     : dynamic_cast<const BodyTorque*>(&law)        ? "torque"
                     : dynamic_cast<const AccelerationField*>(&law) ? "acceleration"
                     : law.spring()                                 ? "spring-damper"
                                                                    : "force law";
  constexpr std::size_t kMostNamed = 3;
  const std::string bodies =
      first_of(law.bodies(), kMostNamed, [&](BodyId body) { return quoted_list({world.name(body)}); });
  return "force " + std::to_string(force.index) + " (" + kind + (bodies.empty() ? "" : " on " + bodies) + ')';
}

void note_what_no_model_has(const World& world, std::vector<std::string>& notices) {
  bool bounces = false, gives = false, drags = false;
  for (int s = 0; s < world.shape_count(); ++s) {
    const Material& material = world.shape(ShapeId{s}).material;
    bounces = bounces || material.restitution > 0;
    gives = gives || material.compliance > 0;
    drags = drags || material.rolling_friction_linear > 0 || material.spinning_friction_linear > 0;
  }
  if (bounces) notices.emplace_back("restitution of contacts has no counterpart");
  if (gives) notices.emplace_back("compliance of contacts has no counterpart");
  if (drags) notices.emplace_back("linear rolling and spinning friction of contacts has no counterpart");
  for (int j = 0; j < world.joint_count(); ++j)
    if (!world.is_attached(JointId{j}))
      notices.push_back(world.name(JointId{j}) + ": a joint that is detached is left out");
}

std::string words(double value) { return shortest(value); }
std::string words(const Vec3& v) { return words(v.x()) + ' ' + words(v.y()) + ' ' + words(v.z()); }

std::string xml_text(const pugi::xml_document& document) {
  std::ostringstream text;
  document.save(text, "  ", pugi::format_indent | pugi::format_no_declaration);
  return text.str();
}

}  // namespace taut
