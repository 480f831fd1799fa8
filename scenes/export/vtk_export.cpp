#include "scenes/export/vtk_export.h"

#include <cstdio>
#include <pugixml.hpp>
#include <span>

#include "scenes/export/shape_mesh.h"
#include "scenes/recording/recorder.h"
#include "scenes/recording/recording_chunk.h"
#include "scenes/support/base64.h"
#include "scenes/support/byte_order.h"
#include "scenes/support/output_file.h"

namespace taut {
namespace {

template <typename Number>
constexpr const char* kVtkType = nullptr;
template <>
constexpr const char* kVtkType<float> = "Float32";
template <>
constexpr const char* kVtkType<std::int32_t> = "Int32";

/// VTK's compressed form: the number of blocks, their size, that of a part block, the compressed sizes; then
/// the blocks.  One block is enough.
std::string packed(std::string_view bytes) {
  const std::string block = deflate(bytes, 3);
  std::string head;
  for (const std::uint64_t number :
       {std::uint64_t{1}, std::uint64_t{bytes.size()}, std::uint64_t{0}, std::uint64_t{block.size()}})
    append_little(head, number);
  return base64(head) + base64(block);
}

template <typename Number>
void add_array(pugi::xml_node parent, const char* name, int components, std::span<const Number> values) {
  pugi::xml_node array = parent.append_child("DataArray");
  array.append_attribute("type").set_value(kVtkType<Number>);
  array.append_attribute("Name").set_value(name);
  array.append_attribute("NumberOfComponents").set_value(components);
  // Readers differ on what no block at all looks like; as text, nothing is nothing.
  array.append_attribute("format").set_value(values.empty() ? "ascii" : "binary");
  const std::string_view bytes(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  array.text().set(values.empty() ? " " : packed(bytes).c_str());
}

/// A field of numbers per point or cell.
struct Field {
  const char* name;
  int components;
  std::vector<float> values;
  void add(double value) { values.push_back(static_cast<float>(value)); }
  void add(const Vec3& v) {
    for (int i = 0; i < 3; ++i) add(v[i]);
  }
};

/// What a .vtp file holds.
struct PolyData {
  enum Cells { kVertices = 1, kLines = 2, kTriangles = 3 };  // points of each
  Cells cells = kVertices;
  std::vector<float> points;
  std::vector<std::int32_t> corners;  // of all cells; vertices are the points themselves
  std::vector<Field> fields;          // of cells
  std::vector<std::pair<const char*, std::vector<std::int32_t>>> indices;  // the same, whole numbers
};

void add_cells(pugi::xml_node piece, const char* kind, std::span<const std::int32_t> corners, int per_cell) {
  pugi::xml_node cells = piece.append_child(kind);
  std::vector<std::int32_t> offsets;
  for (std::size_t end = per_cell; end <= corners.size(); end += per_cell)
    offsets.push_back(static_cast<std::int32_t>(end));
  add_array<std::int32_t>(cells, "connectivity", 1, corners);
  add_array<std::int32_t>(cells, "offsets", 1, offsets);
}

pugi::xml_node add_root(pugi::xml_document& document, const char* type) {
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  declaration.append_attribute("version").set_value("1.0");
  pugi::xml_node root = document.append_child("VTKFile");
  root.append_attribute("type").set_value(type);
  root.append_attribute("version").set_value("1.0");
  root.append_attribute("byte_order").set_value("LittleEndian");
  root.append_attribute("header_type").set_value("UInt64");
  root.append_attribute("compressor").set_value("vtkZLibDataCompressor");
  return root;
}

bool save(const pugi::xml_document& document, const std::filesystem::path& file, const char* indent,
          unsigned format) {
  OutputFile output(file.string());
  document.save(output.out(), indent, format);
  return output.finish();
}

bool write_poly_data(const PolyData& data, const std::filesystem::path& file) {
  pugi::xml_document document;
  pugi::xml_node piece = add_root(document, "PolyData").append_child("PolyData").append_child("Piece");
  const std::size_t points = data.points.size() / 3;
  std::vector<std::int32_t> corners = data.corners;
  for (std::size_t i = 0; data.cells == PolyData::kVertices && i < points; ++i)
    corners.push_back(static_cast<std::int32_t>(i));
  const char* const kind = data.cells == PolyData::kVertices ? "Verts"
                           : data.cells == PolyData::kLines  ? "Lines"
                                                             : "Polys";
  piece.append_attribute("NumberOfPoints").set_value(points);
  piece.append_attribute((std::string("NumberOf") + kind).c_str()).set_value(corners.size() / data.cells);
  pugi::xml_node fields = piece.append_child(data.cells == PolyData::kVertices ? "PointData" : "CellData");
  for (const auto& [name, values] : data.indices) add_array<std::int32_t>(fields, name, 1, values);
  for (const Field& field : data.fields) add_array<float>(fields, field.name, field.components, field.values);
  add_array<float>(piece.append_child("Points"), "Points", 3, data.points);
  add_cells(piece, kind, corners, data.cells);
  return save(document, file, "", pugi::format_raw);
}

/// Surfaces of all bodies.
class BodySurfaces {
 public:
  explicit BodySurfaces(const RecordingHeader& header) : header_(header) {
    const int segments = header.drawn.size() > 2000 ? 8 : header.drawn.size() > 200 ? 12 : 24;
    for (const Shape& shape : header.shapes) meshes_.push_back(drawing_mesh(shape, segments));
  }
  PolyData at(const Frame& frame) const {
    PolyData data{.cells = PolyData::kTriangles, .points = {}, .corners = {}, .fields = {}, .indices = {}};
    std::vector<double> largest(header_.bodies.size(), 0);
    for (std::size_t j = 0; j < header_.joints.size(); ++j)
      for (BodyId body : {header_.joints[j].a, header_.joints[j].b})
        largest[body.index] = std::max(largest[body.index], frame.joints[j].wrench.force.norm());
    data.indices = {{"body", {}}};
    data.fields = {{"velocity", 3, {}}, {"angular_velocity", 3, {}}, {"joint_force", 1, {}}};
    for (const DrawnShape& drawn : header_.drawn) {
      const DrawingMesh& mesh = meshes_[drawn.shape];
      const Pose& body = frame.poses[drawn.body.index];
      const auto first = static_cast<std::int32_t>(data.points.size() / 3);
      for (const Vec3& vertex : mesh.vertices) {
        const Vec3 p = body.point(drawn.pose.point(vertex));
        for (int i = 0; i < 3; ++i) data.points.push_back(static_cast<float>(p[i]));
      }
      for (const auto& triangle : mesh.triangles) {
        for (const int corner : triangle) data.corners.push_back(first + corner);
        data.indices[0].second.push_back(drawn.body.index);
        data.fields[0].add(frame.twists[drawn.body.index].v);
        data.fields[1].add(frame.twists[drawn.body.index].w);
        data.fields[2].add(largest[drawn.body.index]);
      }
    }
    return data;
  }

 private:
  const RecordingHeader& header_;
  std::vector<DrawingMesh> meshes_;
};

void add_point(PolyData& data, const Vec3& point) {
  for (int i = 0; i < 3; ++i) data.points.push_back(static_cast<float>(point[i]));
}

PolyData joint_points(const RecordingHeader& header, const Frame& frame) {
  PolyData data;
  data.indices = {{"joint", {}}, {"attached", {}}};
  data.fields = {{"force", 3, {}}, {"torque", 3, {}}, {"gap", 1, {}}, {"gap_angle", 1, {}}};
  for (std::size_t j = 0; j < header.joints.size(); ++j) {
    const JointSample& joint = frame.joints[j];
    add_point(data, frame.poses[header.joints[j].b.index].point(header.joints[j].anchor_B));
    data.indices[0].second.push_back(static_cast<std::int32_t>(j));
    data.indices[1].second.push_back(joint.attached ? 1 : 0);
    data.fields[0].add(joint.wrench.force);
    data.fields[1].add(joint.wrench.torque);
    data.fields[2].add(joint.gap.metres);
    data.fields[3].add(joint.gap.radians);
  }
  return data;
}

/// The sections of rods, ropes and wires that are attached, with the size of their joint's force.
PolyData wire_lines(const RecordingHeader& header, const Frame& frame) {
  PolyData data{.cells = PolyData::kLines, .points = {}, .corners = {}, .fields = {}, .indices = {}};
  data.indices = {{"joint", {}}};
  data.fields = {{"force", 1, {}}};
  for (std::size_t j = 0; j < header.joints.size(); ++j) {
    const std::vector<WirePoint>& course = header.joints[j].course;
    for (std::size_t i = 0; frame.joints[j].attached && i < course.size(); ++i) {
      const auto index = static_cast<std::int32_t>(data.points.size() / 3);
      add_point(data, frame.poses[course[i].body.index].point(course[i].p_BP));
      if (i == 0) continue;
      data.corners.insert(data.corners.end(), {index - 1, index});
      data.indices[0].second.push_back(static_cast<std::int32_t>(j));
      data.fields[0].add(frame.joints[j].wrench.force.norm());
    }
  }
  return data;
}

/// Springs and dampers, with their tension.
PolyData spring_lines(const RecordingHeader& header, const Frame& frame) {
  PolyData data{.cells = PolyData::kLines, .points = {}, .corners = {}, .fields = {}, .indices = {}};
  data.indices = {{"spring", {}}};
  data.fields = {{"tension", 1, {}}};
  for (std::size_t s = 0; s < header.springs.size(); ++s) {
    const auto first = static_cast<std::int32_t>(2 * s);
    for (const WirePoint& end : {header.springs[s].from, header.springs[s].to})
      add_point(data, frame.poses[end.body.index].point(end.p_BP));
    data.corners.insert(data.corners.end(), {first, first + 1});
    data.indices[0].second.push_back(static_cast<std::int32_t>(s));
    data.fields[0].add(frame.tensions[s]);
  }
  return data;
}

PolyData contact_points(const Frame& frame) {
  PolyData data;
  data.indices = {{"body_a", {}}, {"body_b", {}}};
  data.fields = {{"normal", 3, {}}, {"force", 3, {}}};
  for (const ContactSample& contact : frame.contacts) {
    add_point(data, contact.position);
    data.indices[0].second.push_back(contact.a.index);
    data.indices[1].second.push_back(contact.b.index);
    data.fields[0].add(contact.normal);
    data.fields[1].add(contact.force);
  }
  return data;
}

/// A .pvd file and the .vtp files that it lists.
class Series {
 public:
  Series(std::filesystem::path folder, std::string name)
      : folder_(std::move(folder)), name_(std::move(name)) {
    collection_ = add_root(document_, "Collection").append_child("Collection");
  }
  bool add(double time, const PolyData& data) {
    char number[16];
    std::snprintf(number, sizeof number, "_%05d", count_++);
    const std::string file = name_ + number + ".vtp";
    pugi::xml_node entry = collection_.append_child("DataSet");
    entry.append_attribute("timestep").set_value(shortest(time).c_str());
    entry.append_attribute("part").set_value(0);
    entry.append_attribute("file").set_value(file.c_str());
    return write_poly_data(data, folder_ / file);
  }
  bool finish() const { return save(document_, folder_ / (name_ + ".pvd"), " ", pugi::format_default); }

 private:
  std::filesystem::path folder_;
  std::string name_;
  pugi::xml_document document_;
  pugi::xml_node collection_;
  int count_ = 0;
};

bool write_names(const RecordingHeader& header, const std::filesystem::path& file) {
  OutputFile output(file.string());
  std::ostream& out = output.out();
  out << "kind,index,name\n";
  for (std::size_t b = 0; b < header.bodies.size(); ++b)
    out << "body," << b << ',' << csv_field(header.bodies[b].name) << '\n';
  for (std::size_t j = 0; j < header.joints.size(); ++j)
    out << "joint," << j << ',' << csv_field(header.joints[j].name) << '\n';
  for (std::size_t s = 0; s < header.springs.size(); ++s)
    out << "spring," << s << ',' << csv_field(header.springs[s].name) << '\n';
  return output.finish();
}

}  // namespace

bool write_vtk(RecordingReader& recording, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  const RecordingHeader& header = recording.header();
  const BodySurfaces surfaces(header);
  Series bodies(folder, "bodies"), joints(folder, "joints"), wires(folder, "wires"),
      springs(folder, "springs"), contacts(folder, "contacts");
  bool good = write_names(header, folder / "names.csv");
  for (int f = 0; good && f < recording.frame_count(); ++f) {
    const Frame& frame = recording.frame(f);
    good = bodies.add(frame.time, surfaces.at(frame)) &&
           joints.add(frame.time, joint_points(header, frame)) &&
           wires.add(frame.time, wire_lines(header, frame)) &&
           springs.add(frame.time, spring_lines(header, frame)) &&
           contacts.add(frame.time, contact_points(frame));
  }
  return good && bodies.finish() && joints.finish() && wires.finish() && springs.finish() &&
         contacts.finish();
}

}  // namespace taut
