#include <nlohmann/json.hpp>

#include "core/base/check.h"
#include "scenes/files/shape_json.h"
#include "scenes/recording/recording_codec.h"

namespace taut {

using Group = RecordedScalar::Group;

// Not in the anonymous namespace, where the JSON library would not look for it.
NLOHMANN_JSON_SERIALIZE_ENUM(Group,
                             {{Group::kEnergy, "energy"}, {Group::kGap, "gap"}, {Group::kProbe, "probe"}})

namespace {

using Json = nlohmann::json;

Json pose_to_json(const Pose& pose) {
  return {pose.p.x(), pose.p.y(), pose.p.z(), pose.q.w(), pose.q.x(), pose.q.y(), pose.q.z()};
}

Pose pose_from_json(const Json& json) {
  const auto n = json.get<std::array<double, 7>>();
  return {Quat(n[3], n[4], n[5], n[6]), Vec3(n[0], n[1], n[2])};
}

/// The index of a body that is there.
BodyId body_from_json(const Json& json, std::size_t count) {
  const int index = json.get<int>();
  if (index < 0 || static_cast<std::size_t>(index) >= count) fail("body", "is not there", index);
  return {index};
}

Json course_to_json(const std::vector<WirePoint>& course) {
  Json json = Json::array();
  for (const WirePoint& point : course)
    json.push_back({point.body.index, point.p_BP.x(), point.p_BP.y(), point.p_BP.z()});
  return json;
}

std::vector<WirePoint> course_from_json(const Json& json, std::size_t body_count) {
  std::vector<WirePoint> course;
  for (const Json& point : json)
    course.push_back({body_from_json(point.at(0), body_count), Vec3(point.at(1), point.at(2), point.at(3))});
  return course;
}

Json axes_to_json(const std::vector<RecordedAxis>& axes) {
  Json json = Json::array();
  for (const RecordedAxis& axis : axes)
    json.push_back({{"name", axis.name},
                    {"type", axis.angular ? "turn" : "move"},
                    {"body", axis.body.index},
                    {"direction", vector_to_json(axis.axis_B)}});
  return json;
}

std::vector<RecordedAxis> axes_from_json(const Json& json, std::size_t body_count) {
  std::vector<RecordedAxis> axes;
  for (const Json& axis : json)
    axes.push_back({axis.at("name"), axis.at("type") == "turn", body_from_json(axis.at("body"), body_count),
                    vector_from_json(axis.at("direction"))});
  return axes;
}

void read_springs(const Json& json, RecordingHeader& header) {
  for (const Json& spring : json) {
    const std::vector<WirePoint> ends = course_from_json(spring.at("course"), header.bodies.size());
    if (ends.size() != 2) fail("spring", "must have two ends", ends.size());
    header.springs.push_back({spring.at("name"), spring.at("type") == "spring", ends[0], ends[1]});
  }
}

void read_bodies_and_joints(const Json& json, RecordingHeader& header) {
  for (const Json& body : json.at("bodies"))
    header.bodies.push_back({body.at("name"), body.at("mass"), body.at("fixed")});
  if (header.bodies.empty()) fail("bodies", "the ground is missing", 0);
  for (const Json& joint : json.at("joints"))
    header.joints.push_back(
        {joint.at("name"), joint.at("type"), body_from_json(joint.at("a"), header.bodies.size()),
         body_from_json(joint.at("b"), header.bodies.size()), vector_from_json(joint.at("anchor")),
         joint.contains("course") ? course_from_json(joint.at("course"), header.bodies.size())
                                  : std::vector<WirePoint>(),
         joint.contains("axes") ? axes_from_json(joint.at("axes"), header.bodies.size())
                                : std::vector<RecordedAxis>()});
}

}  // namespace

nlohmann::json springs_to_json(const std::vector<RecordedSpring>& springs) {
  Json json = Json::array();
  for (const RecordedSpring& spring : springs)
    json.push_back({{"name", spring.name},
                    {"type", spring.elastic ? "spring" : "damper"},
                    {"course", course_to_json({spring.from, spring.to})}});
  return json;
}

std::string encode_header(const RecordingHeader& header) {
  Json json{{"scene", header.scene},
            {"parameters", header.parameters},
            {"parameter_units", header.parameter_units},
            {"taut_version", TAUT_VERSION},
            {"dt", header.dt},
            {"frames_per_second", header.frames_per_second},
            {"gravity", vector_to_json(header.gravity)}};
  for (const char* list : {"bodies", "joints", "scalars", "shapes", "drawn"}) json[list] = Json::array();
  for (const RecordedBody& body : header.bodies)
    json["bodies"].push_back({{"name", body.name}, {"mass", body.mass}, {"fixed", body.fixed}});
  for (const RecordedJoint& joint : header.joints) {
    json["joints"].push_back({{"name", joint.name},
                              {"type", joint.type},
                              {"a", joint.a.index},
                              {"b", joint.b.index},
                              {"anchor", vector_to_json(joint.anchor_B)}});
    if (!joint.course.empty()) json["joints"].back()["course"] = course_to_json(joint.course);
    if (!joint.axes.empty()) json["joints"].back()["axes"] = axes_to_json(joint.axes);
  }
  json["springs"] = springs_to_json(header.springs);
  for (const RecordedScalar& scalar : header.scalars)
    json["scalars"].push_back({{"name", scalar.name}, {"unit", scalar.unit}, {"group", scalar.group}});
  for (const Shape& shape : header.shapes) json["shapes"].push_back(shape_to_json(shape));
  for (const DrawnShape& drawn : header.drawn)
    json["drawn"].push_back(
        {{"shape", drawn.shape}, {"body", drawn.body.index}, {"pose", pose_to_json(drawn.pose)}});
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

RecordingHeader decode_header(std::string_view raw) {
  const Json json = Json::parse(raw);
  RecordingHeader header;
  header.scene = json.at("scene");
  header.parameters = json.at("parameters");
  if (json.contains("parameter_units")) header.parameter_units = json.at("parameter_units");
  header.dt = json.at("dt");
  header.frames_per_second = json.at("frames_per_second");
  header.gravity = vector_from_json(json.at("gravity"));
  read_bodies_and_joints(json, header);
  if (json.contains("springs")) read_springs(json.at("springs"), header);  // not in taut-recording/1
  for (const Json& scalar : json.at("scalars"))
    header.scalars.push_back({scalar.at("name"), scalar.at("unit"), scalar.at("group").get<Group>()});
  for (const Json& shape : json.at("shapes")) header.shapes.push_back(shape_from_json(shape));
  for (const Json& drawn : json.at("drawn")) {
    const int shape = drawn.at("shape");
    if (shape < 0 || static_cast<std::size_t>(shape) >= header.shapes.size())
      fail("shape", "is not there", shape);
    header.drawn.push_back(
        {shape, body_from_json(drawn.at("body"), header.bodies.size()), pose_from_json(drawn.at("pose"))});
  }
  return header;
}

std::string encode_end(const RecordingEnd& end) {
  return Json{{"status", end.status}, {"message", end.message}, {"frames", end.frames}}.dump(
      -1, ' ', false, Json::error_handler_t::replace);
}

RecordingEnd decode_end(std::string_view raw) {
  const Json json = Json::parse(raw);
  return {json.at("status"), json.at("message"), json.at("frames")};
}

}  // namespace taut
