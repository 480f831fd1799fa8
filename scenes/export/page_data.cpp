#include "scenes/export/page_data.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenes/export/page_columns.h"
#include "scenes/export/page_contacts.h"
#include "scenes/export/shape_mesh.h"
#include "scenes/files/shape_json.h"
#include "scenes/recording/recording_codec.h"
#include "scenes/support/byte_order.h"

namespace taut {
namespace {

using Json = nlohmann::json;

/// Which joints are detached in which frames.
class DetachedJoints {
 public:
  explicit DetachedJoints(std::size_t joints) : since_(joints, -1) {}
  void add(const Frame& frame) {
    for (std::size_t j = 0; j < since_.size(); ++j) {
      if (!frame.joints[j].attached && since_[j] < 0) since_[j] = frames_;
      if (frame.joints[j].attached && since_[j] >= 0) end(j);
    }
    ++frames_;
  }
  /// [[joint, first frame, frame after the last], ...]
  Json spans() {
    for (std::size_t j = 0; j < since_.size(); ++j)
      if (since_[j] >= 0) end(j);
    return spans_;
  }

 private:
  void end(std::size_t j) {
    spans_.push_back({j, since_[j], frames_});
    since_[j] = -1;
  }
  std::vector<int> since_;
  int frames_ = 0;
  Json spans_ = Json::array();
};

/// Positions on a grid of 65,535 steps over each body's own way, and quaternions as 16-bit numbers whose sign
/// never jumps.
class PoseColumns {
 public:
  PoseColumns(std::size_t bodies, std::size_t frames) : bodies_(bodies) {
    positions_.reserve(3 * bodies * frames);
    rotations_.reserve(4 * bodies * frames);
    last_.assign(bodies, Eigen::Vector4d(0, 0, 0, 1));
  }
  void add(const Frame& frame) {
    for (std::size_t b = 0; b < bodies_; ++b) {
      const Pose& pose = frame.poses[b + 1];
      for (int i = 0; i < 3; ++i) positions_.push_back(static_cast<float>(pose.p[i]));
      Eigen::Vector4d q = pose.q.coeffs();
      if (q.dot(last_[b]) < 0) q = -q;
      last_[b] = q;
      for (int i = 0; i < 4; ++i) rotations_.push_back(static_cast<std::uint16_t>(std::lround(q[i] * 32767)));
    }
  }
  void write(ColumnWriter& columns) const {
    const std::size_t n = 3 * bodies_;
    std::vector<float> low(n, std::numeric_limits<float>::max()), step(n, 0);
    std::vector<float> high(n, std::numeric_limits<float>::lowest());
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      low[i % n] = std::min(low[i % n], positions_[i]);
      high[i % n] = std::max(high[i % n], positions_[i]);
    }
    for (std::size_t k = 0; k < n; ++k) step[k] = (high[k] - low[k]) / 65535;
    Words words;
    words.reserve(positions_.size());
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      const std::size_t k = i % n;
      const float place = step[k] > 0 ? (positions_[i] - low[k]) / step[k] : 0;
      words.push_back(static_cast<std::uint16_t>(std::lround(std::clamp(place, 0.0f, 65535.0f))));
    }
    columns.plain("position_low", low);
    columns.plain("position_step", step);
    columns.predicted("position", words, n, 2);
    columns.predicted("rotation", rotations_, 4 * bodies_, 2);
  }

 private:
  std::size_t bodies_;
  std::vector<float> positions_;
  Words rotations_;
  std::vector<Eigen::Vector4d> last_;
};

/// Primitives as they are; everything made of faces as triangles.
Json shape_description(const Shape& shape) {
  const bool faces = std::holds_alternative<ConvexHull>(shape) ||
                     std::holds_alternative<TriangleMesh>(shape) ||
                     std::holds_alternative<HeightField>(shape);
  if (!faces) return shape_to_json(shape);
  Json positions = Json::array(), indices = Json::array();
  const DrawingMesh mesh = drawing_mesh(shape);
  for (const Vec3& v : mesh.vertices)
    for (int i = 0; i < 3; ++i) positions.push_back(static_cast<float>(v[i]));
  for (const auto& triangle : mesh.triangles)
    for (const int corner : triangle) indices.push_back(corner);
  return {{"type", "mesh"}, {"positions", positions}, {"indices", indices}};
}

/// [[body, x, y, z], ...]
Json course_rows(const std::vector<WirePoint>& course) {
  Json json = Json::array();
  for (const WirePoint& point : course)
    json.push_back({point.body.index, static_cast<float>(point.p_BP.x()), static_cast<float>(point.p_BP.y()),
                    static_cast<float>(point.p_BP.z())});
  return json;
}

Json describe(const RecordingHeader& header) {
  Json d{{"scene", header.scene},
         {"parameters", header.parameters},
         {"parameter_units", header.parameter_units},
         {"dt", header.dt},
         {"gravity", vector_to_json(header.gravity)}};
  // Lists of columns: far smaller than a list of objects for ten thousand bodies.
  Json &bodies = d["bodies"], &joints = d["joints"], &drawn = d["drawn"];
  for (const RecordedBody& body : header.bodies) {
    bodies["name"].push_back(body.name);
    bodies["mass"].push_back(body.mass);
    bodies["fixed"].push_back(body.fixed ? 1 : 0);
  }
  joints = {{"name", Json::array()}, {"type", Json::array()},   {"a", Json::array()},
            {"b", Json::array()},    {"anchor", Json::array()}, {"course", Json::array()},
            {"axes", Json::array()}};
  for (std::size_t j = 0; j < header.joints.size(); ++j) {
    const RecordedJoint& joint = header.joints[j];
    if (!joint.course.empty()) joints["course"].push_back({j, course_rows(joint.course)});
    for (const RecordedAxis& axis : joint.axes)
      joints["axes"].push_back({j, axis.name, axis.angular ? 1 : 0, axis.body.index,
                                static_cast<float>(axis.axis_B.x()), static_cast<float>(axis.axis_B.y()),
                                static_cast<float>(axis.axis_B.z())});
    joints["name"].push_back(joint.name);
    joints["type"].push_back(joint.type);
    joints["a"].push_back(joint.a.index);
    joints["b"].push_back(joint.b.index);
    for (int i = 0; i < 3; ++i) joints["anchor"].push_back(static_cast<float>(joint.anchor_B[i]));
  }
  d["springs"] = springs_to_json(header.springs);
  drawn = Json::array();
  for (const DrawnShape& item : header.drawn) {
    const Quat& q = item.pose.q;
    const Vec3& p = item.pose.p;
    drawn.push_back({item.body.index, item.shape, static_cast<float>(p.x()), static_cast<float>(p.y()),
                     static_cast<float>(p.z()), static_cast<float>(q.x()), static_cast<float>(q.y()),
                     static_cast<float>(q.z()), static_cast<float>(q.w())});
  }
  d["shapes"] = Json::array();
  for (const Shape& shape : header.shapes) d["shapes"].push_back(shape_description(shape));
  d["scalars"] = Json::array();
  for (const RecordedScalar& scalar : header.scalars) {
    const char* group = scalar.group == RecordedScalar::Group::kEnergy ? "energy"
                        : scalar.group == RecordedScalar::Group::kGap  ? "gap"
                                                                       : "probe";
    d["scalars"].push_back({{"name", scalar.name}, {"unit", scalar.unit}, {"group", group}});
  }
  return d;
}

/// Of the first, the middle and the last frame: how many contacts there are, about.
std::size_t most_contacts(RecordingReader& recording) {
  std::size_t most = 0;
  const int last = recording.frame_count() - 1;
  for (const int f : {0, last / 2, last})
    if (f >= 0) most = std::max(most, recording.frame(f).contacts.size());
  return most;
}

/// The columns of some frames.
class PageColumns {
 public:
  PageColumns(const RecordingHeader& header, std::size_t frames)
      : bodies_(header.bodies.size() - 1),
        joints_(header.joints.size()),
        springs_(header.springs.size()),
        poses_(bodies_, frames),
        detached_(joints_) {}
  void add(const Frame& frame) {
    times_.push_back(frame.time);
    scalars_.insert(scalars_.end(), frame.scalars.begin(), frame.scalars.end());
    poses_.add(frame);
    for (std::size_t b = 1; b <= bodies_; ++b) speed_.add(frame.twists[b].v.norm());
    for (const JointSample& joint : frame.joints) {
      force_.add(joint.wrench.force);
      torque_.add(joint.wrench.torque);
      gap_.add(joint.gap.metres);
      gap_angle_.add(joint.gap.radians);
    }
    for (const double value : frame.tensions) tension_.add(value);
    contacts_.add(frame);
    detached_.add(frame);
  }
  void write(PageData& data) {
    data.description["frames"] = times_.size();
    ColumnWriter columns(data.description, data.bytes);
    columns.plain("time", times_);
    columns.plain("scalars", scalars_);
    poses_.write(columns);
    speed_.write(columns, "speed", bodies_);
    force_.write(columns, "force", 3 * joints_);
    torque_.write(columns, "torque", 3 * joints_);
    gap_.write(columns, "gap", joints_);
    gap_angle_.write(columns, "gap_angle", joints_);
    tension_.write(columns, "tension", springs_);
    contacts_.write(columns);
    data.description["detached"] = detached_.spans();
  }

 private:
  std::size_t bodies_, joints_, springs_;
  std::vector<double> times_, scalars_;
  PoseColumns poses_;
  HalfColumn speed_, force_, torque_, gap_, gap_angle_, tension_;
  ContactColumns contacts_;
  DetachedJoints detached_;
};

}  // namespace

std::string PageData::packed() const {
  const std::string text = description.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::string packed;
  append_little<std::uint64_t>(packed, text.size());
  packed += text;
  packed.resize((packed.size() + 7) / 8 * 8, ' ');
  return packed + bytes;
}

PageData page_data(RecordingReader& recording, std::size_t limit) {
  PageData data;
  const RecordingHeader& header = recording.header();
  data.description = describe(header);
  const std::size_t bodies = header.bodies.size() - 1, joints = header.joints.size();
  const std::size_t per_frame = 16 * bodies + 16 * joints + 2 * header.springs.size() +
                                8 * header.scalars.size() + ContactColumns::kBytes * most_contacts(recording);
  data.stride = static_cast<int>(1 + per_frame * recording.frame_count() / limit);
  PageColumns columns(header, recording.frame_count() / data.stride + 1);
  for (int f = 0; f < recording.frame_count(); f += data.stride) columns.add(recording.frame(f));
  columns.write(data);
  return data;
}

PageData page_frame(const RecordingHeader& header, const Frame& frame, bool with_header) {
  PageData data;
  data.description = with_header ? describe(header) : Json::object();
  PageColumns columns(header, 1);
  columns.add(frame);
  columns.write(data);
  return data;
}

}  // namespace taut
