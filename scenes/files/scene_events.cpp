#include <algorithm>
#include <utility>

#include "scenes/files/scene_reader.h"

// Events of a scene file: when they happen, and what they do.
namespace taut {
namespace {

Watch::Along read_along(JsonObject& when) {
  if (const auto along = when.find("along")) return along->unit_vector();
  return {};
}

Vec3 read_point(JsonObject& keys, const char* key, const BodyReference& body) {
  return keys.get(key, &JsonNode::vector, body.centre) - body.centre;
}

// What is watched, by quantity; empty where the file has problems.

Watch watch_position(const SceneReader& reader, JsonObject& when) {
  const BodyReference body = reader.required_body(when, "body");
  const Vec3 p_BP = read_point(when, "point", body);
  const Watch::Along along = read_along(when);
  return body.found ? Watch::position(reader.world(), body.id, p_BP, along) : Watch{};
}

Watch watch_velocity(const SceneReader& reader, JsonObject& when) {
  const BodyReference body = reader.required_body(when, "body");
  const Vec3 p_BP = read_point(when, "point", body);
  const Watch::Along along = read_along(when);
  return body.found ? Watch::velocity(reader.world(), body.id, p_BP, along) : Watch{};
}

Watch watch_angular_velocity(const SceneReader& reader, JsonObject& when) {
  const BodyReference body = reader.required_body(when, "body");
  const Watch::Along along = read_along(when);
  return body.found ? Watch::angular_velocity(reader.world(), body.id, along) : Watch{};
}

Watch watch_distance(const SceneReader& reader, JsonObject& when) {
  const BodyReference a = reader.required_body(when, "a"), b = reader.required_body(when, "b");
  const Vec3 p_AP = read_point(when, "point_a", a), p_BQ = read_point(when, "point_b", b);
  return a.found && b.found ? Watch::distance(reader.world(), a.id, p_AP, b.id, p_BQ) : Watch{};
}

Watch watch_contact_gap(const SceneReader& reader, JsonObject& when) {
  const BodyReference a = reader.required_body(when, "a"), b = reader.required_body(when, "b");
  return a.found && b.found ? Watch::contact_gap(reader.world(), a.id, b.id) : Watch{};
}

Watch watch_axis(const SceneReader& reader, JsonObject& when) {
  const auto axis = reader.required_axis(when, "axis");
  return axis ? Watch::axis(reader.world(), *axis) : Watch{};
}

Watch watch_axis_rate(const SceneReader& reader, JsonObject& when) {
  const auto axis = reader.required_axis(when, "axis");
  return axis ? Watch::axis_rate(reader.world(), *axis) : Watch{};
}

Watch watch_reaction_force(const SceneReader& reader, JsonObject& when) {
  const JointId joint = reader.required_joint(when, "joint");
  const Watch::Along along = read_along(when);
  return joint.index >= 0 ? Watch::reaction_force(reader.world(), joint, along) : Watch{};
}

Watch watch_reaction_torque(const SceneReader& reader, JsonObject& when) {
  const JointId joint = reader.required_joint(when, "joint");
  const Watch::Along along = read_along(when);
  return joint.index >= 0 ? Watch::reaction_torque(reader.world(), joint, along) : Watch{};
}

Watch watch_gap(const SceneReader& reader, JsonObject& when) {
  const JointId joint = reader.required_joint(when, "joint");
  return joint.index >= 0 ? Watch::joint_gap(reader.world(), joint) : Watch{};
}

using WatchReader = Watch (*)(const SceneReader& reader, JsonObject& when);
constexpr std::pair<const char*, WatchReader> kWatched[] = {
    {"position", watch_position},
    {"velocity", watch_velocity},
    {"angular-velocity", watch_angular_velocity},
    {"distance", watch_distance},
    {"axis", watch_axis},
    {"axis-rate", watch_axis_rate},
    {"reaction-force", watch_reaction_force},
    {"reaction-torque", watch_reaction_torque},
    {"gap", watch_gap},
    {"contact-gap", watch_contact_gap},
};

/// The number that a probe of the file records; of a vector the component along a direction, or its
/// magnitude.
Watch watch_probe(const SceneReader& reader, const JsonNode& name, JsonObject& when) {
  const Probe* probe = reader.find_probe(name);
  if (!probe) {
    when.accept_all_keys();
    return {};
  }
  const World& world = reader.world();
  using enum Probe::Quantity;
  switch (probe->quantity) {
    case kPosition:
      return Watch::position(world, probe->body, probe->point_B, read_along(when));
    case kVelocity:
      return Watch::velocity(world, probe->body, probe->point_B, read_along(when));
    case kAngularVelocity:
      return Watch::angular_velocity(world, probe->body, read_along(when));
    case kReactionForce:
      return Watch::reaction_force(world, probe->joint, read_along(when));
    case kReactionTorque:
      return Watch::reaction_torque(world, probe->joint, read_along(when));
    case kGap:
      return Watch::joint_gap(world, probe->joint);
    case kAxis:
      return Watch::axis(world, probe->axis);
    default:
      break;
  }
  name.problem("must be a probe of a position, velocity, reaction, gap or axis");
  when.accept_all_keys();
  return {};
}

/// Whether a probe of the file records an angle or an angular rate.
bool probes_angle(const SceneReader& reader, const std::string& name) {
  for (const Probe& probe : reader.probes()) {
    if (probe.name != name) continue;
    if (probe.quantity == Probe::Quantity::kAxis) return reader.world().axis_info(probe.axis).angular;
    return probe.quantity == Probe::Quantity::kAngularVelocity;
  }
  return false;
}

/// Whether {"joint", "axis"} is an axis that turns.
bool turns(const SceneReader& reader, const nlohmann::json& keys) {
  if (!keys.is_object()) return false;
  const auto joint = keys.find("joint"), name = keys.find("axis");
  if (joint == keys.end() || name == keys.end() || !joint->is_string() || !name->is_string()) return false;
  const World& world = reader.world();
  if (!world.has_joint(joint->get<std::string>())) return false;
  const JointId id = world.joint(joint->get<std::string>());
  for (int k = 0; k < world.axis_count(id); ++k)
    if (world.axis_info({id, k}).name == name->get<std::string>()) return world.axis_info({id, k}).angular;
  return false;
}

/// Whether the object watches an angle or an angular rate, so that its threshold can be in degrees.
bool watches_angle(const SceneReader& reader, JsonObject& when) {
  if (const auto probe = when.find("probe"); probe && probe->json().is_string())
    return probes_angle(reader, probe->json().get_ref<const std::string&>());
  if (const auto quantity = when.find("quantity"); quantity && quantity->json() == "angular-velocity")
    return true;
  const auto axis = when.find("axis");
  return axis && turns(reader, axis->json());
}

WhenPasses read_passage(const SceneReader& reader, const JsonNode& node) {
  JsonObject when(node);
  WhenPasses passes;
  const auto what = when.one_of({"quantity", "probe"});
  if (what && when.find("quantity")) {
    const std::size_t before = node.problems().size();
    const WatchReader read = what->choice(kWatched);
    if (node.problems().size() == before)
      passes.watch = read(reader, when);
    else
      when.accept_all_keys();
  } else if (what) {
    passes.watch = watch_probe(reader, *what, when);
  }
  const bool angle = watches_angle(reader, when);
  const JsonKey rises = in_angles("rises_above", angle), falls = in_angles("falls_below", angle),
                either = in_angles("passes", angle);
  const auto threshold = when.one_of({rises, falls, either});
  passes.threshold = threshold ? threshold->number() : 0;
  if (when.find(rises)) passes.way = WhenPasses::Way::kRising;
  if (when.find(falls)) passes.way = WhenPasses::Way::kFalling;
  passes.each_time = when.get("each_time", &JsonNode::boolean, false);
  passes.located = when.get("located", &JsonNode::boolean, true);
  when.reject_unknown_keys();
  return passes;
}

// What an event does, by the key that says it.

constexpr std::pair<const char*, AttachJoint::Where> kWhere[] = {{"closed", AttachJoint::Where::kClosed},
                                                                 {"as_is", AttachJoint::Where::kAsIs}};

EventAction read_attach(const SceneReader& reader, JsonObject& keys) {
  AttachJoint action;
  action.joint = reader.required_joint(keys, "attach");
  if (const auto where = keys.find("where")) action.where = where->choice(kWhere);
  action.tolerance = keys.get("tolerance", &JsonNode::not_negative, action.tolerance);
  return action;
}

EventAction read_detach(const SceneReader& reader, JsonObject& keys) {
  return DetachJoint{reader.required_joint(keys, "detach")};
}

EventAction read_set_motor(const SceneReader& reader, JsonObject& keys) {
  SetMotor action;
  const auto axis = reader.required_axis(keys, "motor");
  const bool angular = !axis || reader.world().axis_info(*axis).angular;
  action.axis = axis.value_or(AxisId{});
  if (const auto target = keys.find(in_angles("target", angular))) action.target = target->number();
  if (const auto force = keys.find("max_force")) action.max_force = force->not_negative();
  action.remove = keys.get("remove", &JsonNode::boolean, false);
  return action;
}

EventAction read_load(const SceneReader& reader, JsonObject& keys) {
  ApplyLoad action;
  const BodyReference body = reader.required_body(keys, "load");
  action.body = body.id;
  action.p_BP = read_point(keys, "point", body);
  action.force = keys.get("force", &JsonNode::vector, Vec3(Vec3::Zero()));
  action.torque = keys.get("torque", &JsonNode::vector, Vec3(Vec3::Zero()));
  action.follows_body = keys.get("follows_body", &JsonNode::boolean, false);
  if (const auto duration = keys.find("duration")) action.duration = duration->positive();
  if (const auto factor = keys.find("factor")) action.factor = read_motion(*factor, false);
  keys.needs_any_of({"force", "torque"});
  return action;
}

EventAction read_gravity(const SceneReader&, JsonObject& keys) {
  return SetGravity{keys.get_required("gravity", &JsonNode::vector, Vec3(Vec3::Zero()))};
}

EventAction read_end(const SceneReader&, JsonObject& keys) {
  if (const auto end = keys.find("end"); end && !end->boolean()) end->problem("must be true");
  return EndRun{};
}

constexpr std::pair<const char*, EventAction (*)(const SceneReader&, JsonObject&)> kActions[] = {
    {"attach", read_attach}, {"detach", read_detach},   {"motor", read_set_motor},
    {"load", read_load},     {"gravity", read_gravity}, {"end", read_end},
};

EventAction read_action(const SceneReader& reader, const JsonNode& node) {
  JsonObject keys(node);
  EventAction action = EndRun{};
  const auto kind = keys.one_of({"attach", "detach", "motor", "load", "gravity", "end"});
  if (!kind) {
    keys.accept_all_keys();
    return action;
  }
  for (const auto& [name, read] : kActions)
    if (keys.find(name)) {
      action = read(reader, keys);
      break;
    }
  keys.reject_unknown_keys();
  return action;
}

}  // namespace

void SceneReader::read_event(const JsonNode& node) {
  const std::size_t before = problems_.size();
  JsonObject keys(node);
  Event event;
  knows_all_ = true;
  guard_item(node, before, [&] {
    const auto name = keys.required("name");
    if (name) event.name = name->string();
    if (!event.name.empty() && !event_names_.insert(event.name).second)
      name->problem("name is already taken by another event");
    const auto cause = keys.one_of({"at", "when"});
    if (cause && keys.find("at"))
      event.when = AtTime{cause->number()};
    else if (cause)
      event.when = read_passage(*this, *cause);
    if (const auto list = keys.find("when") ? keys.find("do") : keys.required("do"))
      for (const JsonNode& item : list->items("an array of actions"))
        event.actions.push_back(read_action(*this, item));
    keys.reject_unknown_keys();
    if (knows_all_ && problems_.size() == before) check_event(scene_.world, event);
  });
  if (problems_.size() == before) scene_.events.push_back(std::move(event));
}

}  // namespace taut
