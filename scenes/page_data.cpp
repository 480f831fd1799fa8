#include "scenes/page_data.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenes/byte_order.h"
#include "scenes/shape_json.h"
#include "scenes/shape_mesh.h"

namespace taut {
namespace {

using Json = nlohmann::json;
using Words = std::vector<std::uint16_t>;

/// Columns one behind the other, each with its place in the description.
class ColumnWriter {
 public:
  explicit ColumnWriter(PageData& data) : data_(data) { data_.description["columns"] = Json::object(); }

  template <typename Number>
  void plain(const char* name, const std::vector<Number>& values) {
    begin(name, values.size());
    for (const Number value : values) append_little(data_.bytes, value);
  }
  /// 16-bit words of all frames as differences to what the last `order` frames predict (0: they stay, 1: they
  /// go on as they went), modulo 2¹⁶, low bytes first and then high bytes.
  void predicted(const char* name, const Words& words, std::size_t per_frame, int order) {
    begin(name, words.size());
    data_.description["columns"][name]["order"] = order;
    data_.description["columns"][name]["per_frame"] = per_frame;
    Words rest(words);
    for (int pass = 0; pass < order; ++pass)
      for (std::size_t i = rest.size(); i-- > per_frame;)
        rest[i] = static_cast<std::uint16_t>(rest[i] - rest[i - per_frame]);
    for (const int shift : {0, 8})
      for (const std::uint16_t word : rest) data_.bytes += static_cast<char>(word >> shift & 255);
  }

 private:
  void begin(const char* name, std::size_t count) {
    while (data_.bytes.size() % 8 != 0) data_.bytes += '\0';
    data_.description["columns"][name] = {{"offset", data_.bytes.size()}, {"count", count}};
  }
  PageData& data_;
};

/// Numbers of one kind as halves of their largest absolute value; 8 bits of mantissa are kept.
struct HalfColumn {
  std::vector<float> values;
  void add(double value) { values.push_back(std::isfinite(value) ? static_cast<float>(value) : 0.0f); }
  void add(const Vec3& v) {
    for (int i = 0; i < 3; ++i) add(v[i]);
  }
  bool is_zero() const {
    return std::all_of(values.begin(), values.end(), [](float value) { return value == 0; });
  }
  void write(ColumnWriter& columns, Json& description, const char* name, std::size_t per_frame) const {
    if (is_zero()) return;
    float scale = 0;
    for (const float value : values) scale = std::max(scale, std::abs(value));
    Words words;
    words.reserve(values.size());
    for (const float value : values)
      words.push_back(static_cast<std::uint16_t>((half_float(value / scale) + 2) & ~3));
    columns.predicted(name, words, per_frame, 1);
    description["columns"][name]["scale"] = scale;
  }
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

Json describe(const RecordingHeader& header) {
  Json d{{"scene", header.scene},
         {"parameters", header.parameters},
         {"dt", header.dt},
         {"gravity", vector_to_json(header.gravity)}};
  // Lists of columns: far smaller than a list of objects for ten thousand bodies.
  Json &bodies = d["bodies"], &joints = d["joints"], &drawn = d["drawn"];
  for (const RecordedBody& body : header.bodies) {
    bodies["name"].push_back(body.name);
    bodies["mass"].push_back(body.mass);
    bodies["fixed"].push_back(body.fixed ? 1 : 0);
  }
  joints = {{"name", Json::array()},
            {"type", Json::array()},
            {"a", Json::array()},
            {"b", Json::array()},
            {"anchor", Json::array()}};
  for (const RecordedJoint& joint : header.joints) {
    joints["name"].push_back(joint.name);
    joints["type"].push_back(joint.type);
    joints["a"].push_back(joint.a.index);
    joints["b"].push_back(joint.b.index);
    for (int i = 0; i < 3; ++i) joints["anchor"].push_back(static_cast<float>(joint.anchor_B[i]));
  }
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

void add_contacts(const Frame& frame, std::vector<std::uint32_t>& counts, std::vector<std::uint32_t>& bodies,
                  std::vector<float>& numbers) {
  counts.push_back(static_cast<std::uint32_t>(frame.contacts.size()));
  for (const ContactSample& contact : frame.contacts) {
    bodies.push_back(static_cast<std::uint32_t>(contact.a.index));
    bodies.push_back(static_cast<std::uint32_t>(contact.b.index));
    for (const Vec3& v : {contact.position, contact.normal, contact.force})
      for (int i = 0; i < 3; ++i) numbers.push_back(static_cast<float>(v[i]));
  }
}

}  // namespace

std::uint16_t half_float(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const auto sign = static_cast<std::uint16_t>(bits >> 16 & 0x8000);
  const float magnitude = std::abs(value);
  if (!(magnitude < 65520)) return static_cast<std::uint16_t>(sign | (std::isnan(value) ? 0x7e00 : 0x7c00));
  if (magnitude < 0x1p-14f)  // subnormal: multiples of 2⁻²⁴
    return static_cast<std::uint16_t>(sign | std::lrint(magnitude * 0x1p24f));
  int exponent;
  const float mantissa = std::frexp(magnitude, &exponent);             // in [½, 1)
  const auto rounded = static_cast<int>(std::lrint(mantissa * 2048));  // 1024 … 2048; a carry is right too
  return static_cast<std::uint16_t>(sign | (((exponent + 14) << 10) + rounded - 1024));
}

PageData page_data(RecordingReader& recording, std::size_t limit) {
  PageData data;
  const RecordingHeader& header = recording.header();
  data.description = describe(header);
  const std::size_t bodies = header.bodies.size() - 1, joints = header.joints.size();
  const std::size_t per_frame = 16 * bodies + 16 * joints + 8 * header.scalars.size();
  data.stride = static_cast<int>(1 + per_frame * recording.frame_count() / limit);

  std::vector<double> times, scalars;
  PoseColumns poses(bodies, recording.frame_count() / data.stride + 1);
  HalfColumn speed, force, torque, gap, gap_angle;
  std::vector<std::uint32_t> contact_counts, contact_bodies;
  std::vector<float> contact_numbers;
  for (int f = 0; f < recording.frame_count(); f += data.stride) {
    const Frame& frame = recording.frame(f);
    times.push_back(frame.time);
    scalars.insert(scalars.end(), frame.scalars.begin(), frame.scalars.end());
    poses.add(frame);
    for (std::size_t b = 1; b <= bodies; ++b) speed.add(frame.twists[b].v.norm());
    for (const JointSample& joint : frame.joints) {
      force.add(joint.wrench.force);
      torque.add(joint.wrench.torque);
      gap.add(joint.gap.metres);
      gap_angle.add(joint.gap.radians);
    }
    add_contacts(frame, contact_counts, contact_bodies, contact_numbers);
  }
  data.description["frames"] = times.size();
  ColumnWriter columns(data);
  columns.plain("time", times);
  columns.plain("scalars", scalars);
  poses.write(columns);
  speed.write(columns, data.description, "speed", bodies);
  force.write(columns, data.description, "force", 3 * joints);
  torque.write(columns, data.description, "torque", 3 * joints);
  gap.write(columns, data.description, "gap", joints);
  gap_angle.write(columns, data.description, "gap_angle", joints);
  columns.plain("contact_count", contact_counts);
  columns.plain("contact_bodies", contact_bodies);
  columns.plain("contact_numbers", contact_numbers);
  return data;
}

}  // namespace taut
