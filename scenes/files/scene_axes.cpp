#include <functional>

#include "core/axes/axis.h"
#include "core/joints/joints.h"
#include "scenes/files/scene_reader.h"

// Free axes of joints in a scene file: what acts along them, and joints that couple them.
namespace taut {
namespace {

double number_or(JsonObject& object, JsonKey key, double fallback) {
  return object.get(key, &JsonNode::number, fallback);
}

// `angular`: the axis is an angle, so that keys along it can also be given in degrees.

/// As a file has them: no number is unlimited there.
double (JsonNode::*reader_of(AxisRange range))() const {
  switch (range) {
    case AxisRange::kNotNegative:
    case AxisRange::kBound:
      return &JsonNode::not_negative;
    case AxisRange::kFromZeroToOne:
      return &JsonNode::zero_to_one;
    case AxisRange::kSpeed:
      return &JsonNode::positive;
    case AxisRange::kFinite:
    case AxisRange::kLowest:
    case AxisRange::kHighest:
      break;
  }
  return &JsonNode::number;
}

template <typename Property>
void read_field(JsonObject& keys, const AxisField<Property, double>& field, JsonKey key, Property& property) {
  property.*field.member = keys.get(key, reader_of(field.range), property.*field.member);
}
template <typename Property>
void read_field(JsonObject& keys, const AxisField<Property, bool>& field, JsonKey key, Property& property) {
  property.*field.member = keys.get(key, &JsonNode::boolean, property.*field.member);
}
template <typename Property>
void read_field(JsonObject& keys, const AxisField<Property, std::optional<Curve>>& field, JsonKey key,
                Property& property) {
  property.*field.member = read_curve(keys, key);
}

// What the fields of a property do not say: before the others, and after them.

template <typename Property>
void read_first(JsonObject&, Property&, bool) {}
void read_first(JsonObject& keys, AxisMotor& motor, bool angular) {
  const JsonKey velocity = in_angles("velocity", angular), position = in_angles("position", angular);
  const auto target = keys.one_of({velocity, position, "trajectory"});
  if (target && (keys.find(velocity) || keys.find(position))) {  // the first one that is there
    if (!keys.find(velocity)) motor.mode = AxisMotor::Mode::kPosition;
    motor.target = target->number();
  } else if (target) {
    motor.mode = AxisMotor::Mode::kTrajectory;
    motor.trajectory = read_motion(*target, angular);
  }
}

template <typename Property>
void read_last(JsonObject&, Property&) {}
void read_last(JsonObject& keys, AxisFriction& friction) {
  if (!keys.find("dynamic")) friction.dynamic_friction = friction.static_friction;
}

template <typename Property>
Property read_property(const JsonNode& node, bool angular) {
  JsonObject keys(node);
  Property property;
  std::vector<JsonKey> acting;
  read_first(keys, property, angular);
  each_axis_field<Property>([&](const auto& field) {
    if (!field.key) return;
    const JsonKey key = in_angles(field.key, field.notes.angular && angular);
    read_field(keys, field, key, property);
    if (field.notes.acts) acting.push_back(key);
  });
  read_last(keys, property);
  if (acting.size() == 1)
    keys.required(acting[0]);
  else if (!acting.empty())
    keys.needs_any_of(acting);
  keys.reject_unknown_keys();
  return property;
}

/// Not negative, or "infinite".
double read_compliance(JsonObject& keys, const char* key) {
  const auto node = keys.find(key);
  if (!node) return 0;
  return node->json() == "infinite" ? kUnlimited : node->not_negative();
}

JointCompliance read_joint_compliance(const JsonNode& node) {
  JsonObject keys(node);
  JointCompliance compliance;
  compliance.translation = read_compliance(keys, "translation");
  compliance.rotation = read_compliance(keys, "rotation");
  compliance.translation_damping = keys.get("translation_damping", &JsonNode::not_negative, 0.0);
  compliance.rotation_damping = keys.get("rotation_damping", &JsonNode::not_negative, 0.0);
  keys.needs_any_of({"translation", "rotation", "translation_damping", "rotation_damping"});
  keys.reject_unknown_keys();
  return compliance;
}

BreakLimits read_break(const JsonNode& node) {
  JsonObject keys(node);
  BreakLimits limits;
  limits.force = keys.get("force", &JsonNode::positive, limits.force);
  limits.torque = keys.get("torque", &JsonNode::positive, limits.torque);
  keys.needs_any_of({"force", "torque"});
  keys.reject_unknown_keys();
  return limits;
}

// Motions whose keys are in an object of their own.

Motion read_linear(const JsonNode& node, bool angular) {
  JsonObject of(node);
  const double value = number_or(of, in_angles("value", angular), 0), start = number_or(of, "start", 0);
  const double rate = of.get_required(in_angles("rate", angular), &JsonNode::number, 0.0);
  of.reject_unknown_keys();
  return linear_motion(value, rate, start);
}

Harmonic read_harmonic_term(JsonObject& of, bool angular) {
  Harmonic term;
  term.phase = number_or(of, in_angles("phase"), 0);
  term.amplitude = of.get_required(in_angles("amplitude", angular), &JsonNode::number, 0.0);
  term.omega = of.get_required(in_angles("omega"), &JsonNode::number, 0.0);
  return term;
}

Motion read_harmonic(const JsonNode& node, bool angular) {
  JsonObject of(node);
  const double mean = number_or(of, in_angles("mean", angular), 0);
  const Harmonic term = read_harmonic_term(of, angular);
  of.reject_unknown_keys();
  return harmonic_motion(mean, term.amplitude, term.omega, term.phase);
}

Motion read_harmonics(const JsonNode& node, bool angular) {
  JsonObject of(node);
  const double mean = number_or(of, in_angles("mean", angular), 0);
  std::vector<Harmonic> terms;
  if (const auto list = of.required("terms"))
    for (const JsonNode& item : list->items("an array of terms")) {
      JsonObject term(item);
      terms.push_back(read_harmonic_term(term, angular));
      term.reject_unknown_keys();
    }
  of.reject_unknown_keys();
  return harmonics_motion(mean, std::move(terms));
}

Motion read_ramp(const JsonNode& node, bool angular) {
  JsonObject of(node);
  const double from = number_or(of, in_angles("from", angular), 0);
  const double to = of.get_required(in_angles("to", angular), &JsonNode::number, 0.0);
  const double start = number_or(of, "start", 0);
  const double duration = of.get_required("duration", &JsonNode::positive, 1.0);
  const bool smooth = of.get("smooth", &JsonNode::boolean, false);
  of.reject_unknown_keys();
  return ramp_motion(from, to, start, duration, smooth);
}

Motion read_gust(const JsonNode& node, bool angular) {
  JsonObject of(node);
  const double peak = of.get_required(in_angles("peak", angular), &JsonNode::number, 0.0);
  const double start = number_or(of, "start", 0);
  const double duration = of.get_required("duration", &JsonNode::positive, 1.0);
  of.reject_unknown_keys();
  return gust_motion(peak, start, duration);
}

constexpr std::pair<const char*, Motion (*)(const JsonNode&, bool)> kMotionKinds[] = {
    {"/linear", read_linear}, {"/harmonic", read_harmonic}, {"/harmonics", read_harmonics},
    {"/ramp", read_ramp},     {"/gust", read_gust},
};

Motion motion_through(const std::vector<Curve::Point>& points) {
  std::vector<double> times, values;
  for (const Curve::Point& p : points) times.push_back(p.x), values.push_back(p.y);
  return spline_motion(times, values);
}

}  // namespace

Motion read_motion(const JsonNode& node, bool angular) {
  JsonObject keys(node);
  const JsonKey spline = in_angles("spline", angular), speeds = in_angles("speeds", angular),
                table = in_angles("table", angular);
  const auto kind = keys.one_of({"linear", "harmonic", "harmonics", "ramp", "gust", spline, speeds, table});
  if (!kind) return {};
  const std::size_t before = node.problems().size();
  Motion motion;
  // By the last key of the path, without "_deg".
  for (const auto& [name, read_kind] : kMotionKinds)
    if (kind->path().ends_with(name)) motion = read_kind(*kind, angular);
  if (!motion) {
    const bool by_speed = keys.find(speeds).has_value(), by_table = keys.find(table).has_value();
    const double value = by_speed ? number_or(keys, in_angles("value", angular), 0) : 0;
    const bool periodic = by_table && keys.get("periodic", &JsonNode::boolean, false);
    std::vector<Curve::Point> points = read_curve_points(*kind);
    for (Curve::Point& p : points) p.y *= kind->unit();
    kind->guard_if_sound(before, [&] {
      motion = by_speed   ? speed_motion(Curve(points), value)
               : by_table ? table_motion(Curve(points), periodic)
                          : motion_through(points);
    });
  }
  keys.reject_unknown_keys();
  return motion;
}

std::vector<Curve::Point> read_curve_points(const JsonNode& node) {
  std::vector<Curve::Point> points;
  for (const JsonNode& item : node.items("an array of pairs [x, y]")) {
    const std::vector<double> pair = item.numbers(2, "a pair of numbers [x, y]");
    points.push_back({pair[0], pair[1]});
  }
  return points;
}

std::optional<Curve> read_curve(JsonObject& object, JsonKey key) {
  const auto node = object.find(key);
  if (!node) return {};
  std::optional<Curve> curve;
  const std::size_t before = node->problems().size();
  std::vector<Curve::Point> points = read_curve_points(*node);
  for (Curve::Point& p : points) p.x *= node->unit();
  node->guard_if_sound(before, [&] { curve = Curve(points); });
  return curve;
}

void SceneReader::read_axes(const JsonNode& node, JointId joint) {
  for (const auto& [name, axis_node] : node.members()) {
    JsonObject keys(axis_node);
    std::optional<AxisId> id;
    if (joint.index >= 0) axis_node.guard([&, &name = name] { id = scene_.world.axis(joint, name); });
    const bool angular = !id || scene_.world.axis_info(*id).angular;
    const auto start = keys.find(in_angles("value", angular));
    const std::size_t before_values = problems_.size();
    std::vector<std::function<void(AxisId)>> setters;
    const auto read = [&]<typename Property>() {
      if (const auto child = keys.find(Property::kFacts.key))
        setters.push_back([this, child, value = read_property<Property>(*child, angular)](AxisId of) {
          child->guard([&] { scene_.world.set_property(of, value); });
        });
    };
    if (id && angular && scene_.world.joint(joint).type() != "screw") note_many_turns(keys);
    for_axis_types_backward(read);
    const double start_value = start ? start->number() : 0;
    keys.reject_unknown_keys();
    if (!id || problems_.size() != before_values) continue;
    for (const auto& set : setters) set(*id);
    if (start) start->guard([&] { scene_.world.set_axis_turns(*id, start_value); });
  }
}

void SceneReader::read_joint_properties(JsonObject& joint, JointId id) {
  if (const auto node = joint.find("compliance")) {
    const std::size_t before = problems_.size();
    const JointCompliance compliance = read_joint_compliance(*node);
    if (id.index >= 0 && problems_.size() == before)
      node->guard([&] { scene_.world.set_compliance(id, compliance); });
  }
  if (const auto node = joint.find("break")) {
    const std::size_t before = problems_.size();
    const BreakLimits limits = read_break(*node);
    if (id.index >= 0 && problems_.size() == before) node->guard([&] { scene_.world.set_break(id, limits); });
  }
  if (!joint.get("attached", &JsonNode::boolean, true) && id.index >= 0) scene_.world.detach(id);
}

std::optional<AxisId> SceneReader::required_axis(JsonObject& object, const char* key) const {
  const auto node = object.required(key);
  if (!node) return {};
  JsonObject keys(*node);
  const auto joint_node = keys.required("joint"), axis_node = keys.required("axis");
  keys.reject_unknown_keys();
  const JointId joint = joint_node ? find_joint(*joint_node) : JointId{};
  const std::string name = axis_node ? axis_node->string() : "";
  std::optional<AxisId> id;
  if (joint.index >= 0 && !name.empty()) axis_node->guard([&] { id = scene_.world.axis(joint, name); });
  return id;
}

std::shared_ptr<const Joint> read_gear(const SceneReader& reader, JsonObject& joint) {
  const auto driving = reader.required_axis(joint, "driving"), driven = reader.required_axis(joint, "driven");
  const double ratio = joint.get_required("ratio", &JsonNode::number, 1.0);
  if (!driving || !driven) return nullptr;
  return std::make_shared<Gear>(reader.world(), *driving, *driven, ratio);
}

std::shared_ptr<const Joint> read_rack_and_pinion(const SceneReader& reader, JsonObject& joint) {
  const auto pinion = reader.required_axis(joint, "pinion"), rack = reader.required_axis(joint, "rack");
  const double radius = joint.get_required("radius", &JsonNode::number, 1.0);
  if (!pinion || !rack) return nullptr;
  return std::make_shared<RackAndPinion>(reader.world(), *pinion, *rack, radius);
}

std::shared_ptr<const Joint> read_differential(const SceneReader& reader, JsonObject& joint) {
  const auto input = reader.required_axis(joint, "input"), left = reader.required_axis(joint, "left"),
             right = reader.required_axis(joint, "right");
  if (!input || !left || !right) return nullptr;
  return std::make_shared<Differential>(reader.world(), *input, *left, *right);
}

std::shared_ptr<const Joint> read_driver(const SceneReader& reader, JsonObject& joint) {
  const auto axis = reader.required_axis(joint, "of");
  const auto motion_node = joint.required("motion");
  const bool angular = !axis || reader.world().axis_info(*axis).angular;
  const Motion motion = motion_node ? read_motion(*motion_node, angular) : Motion();
  if (!axis || !motion) return nullptr;
  return std::make_shared<Driver>(reader.world(), *axis, motion);
}

}  // namespace taut
