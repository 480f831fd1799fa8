#include "scenes/export/gltf_export.h"

#include <tiny_gltf.h>

#include <ostream>

#include "scenes/export/coil.h"
#include "scenes/export/shape_mesh.h"

namespace taut {
namespace {

using tinygltf::Model;

std::vector<double> numbers(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
std::vector<double> numbers(const Quat& q) { return {q.x(), q.y(), q.z(), q.w()}; }

/// Accessors on one buffer.
class BufferBuilder {
 public:
  explicit BufferBuilder(Model& model) : model_(model) { model_.buffers.emplace_back(); }

  int floats(const std::vector<float>& values, int type, int target = 0) {
    return add(values, type, TINYGLTF_COMPONENT_TYPE_FLOAT, target);
  }
  int indices(const std::vector<std::uint32_t>& values) {
    return add(values, TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
               TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
  }

 private:
  template <typename Number>
  int add(const std::vector<Number>& values, int type, int component_type, int target) {
    std::vector<unsigned char>& bytes = model_.buffers[0].data;
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = bytes.size();
    view.byteLength = values.size() * sizeof(Number);
    view.target = target;
    const auto* begin = reinterpret_cast<const unsigned char*>(values.data());
    bytes.insert(bytes.end(), begin, begin + view.byteLength);
    model_.bufferViews.push_back(view);

    const auto width = static_cast<std::size_t>(tinygltf::GetNumComponentsInType(type));
    tinygltf::Accessor accessor;
    accessor.bufferView = static_cast<int>(model_.bufferViews.size()) - 1;
    accessor.componentType = component_type;
    accessor.type = type;
    accessor.count = values.size() / width;
    for (std::size_t i = 0; i < width && !values.empty(); ++i) {
      Number least = values[i], most = values[i];
      for (std::size_t k = i; k < values.size(); k += width)
        least = std::min(least, values[k]), most = std::max(most, values[k]);
      accessor.minValues.push_back(least);
      accessor.maxValues.push_back(most);
    }
    model_.accessors.push_back(accessor);
    return static_cast<int>(model_.accessors.size()) - 1;
  }
  Model& model_;
};

int add_material(Model& model, const std::string& name, std::vector<double> color) {
  tinygltf::Material material;
  material.name = name;
  material.pbrMetallicRoughness.baseColorFactor = std::move(color);
  material.pbrMetallicRoughness.metallicFactor = 0.1;
  material.pbrMetallicRoughness.roughnessFactor = 0.6;
  model.materials.push_back(material);
  return static_cast<int>(model.materials.size()) - 1;
}

int add_mesh(Model& model, BufferBuilder& buffer, const std::string& name, const DrawingMesh& drawing,
             int material) {
  std::vector<float> positions, normals;
  std::vector<std::uint32_t> indices;
  for (std::size_t v = 0; v < drawing.vertices.size(); ++v)
    for (int i = 0; i < 3; ++i) {
      positions.push_back(static_cast<float>(drawing.vertices[v][i]));
      normals.push_back(static_cast<float>(drawing.normals[v][i]));
    }
  for (const auto& triangle : drawing.triangles)
    for (const int corner : triangle) indices.push_back(static_cast<std::uint32_t>(corner));
  tinygltf::Primitive primitive;
  primitive.attributes["POSITION"] =
      buffer.floats(positions, TINYGLTF_TYPE_VEC3, TINYGLTF_TARGET_ARRAY_BUFFER);
  primitive.attributes["NORMAL"] = buffer.floats(normals, TINYGLTF_TYPE_VEC3, TINYGLTF_TARGET_ARRAY_BUFFER);
  primitive.indices = buffer.indices(indices);
  primitive.material = material;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  tinygltf::Mesh mesh;
  mesh.name = name;
  mesh.primitives.push_back(primitive);
  model.meshes.push_back(mesh);
  return static_cast<int>(model.meshes.size()) - 1;
}

int add_node(Model& model, int parent, const std::string& name, const Pose& pose, int mesh = -1) {
  tinygltf::Node node;
  node.name = name;
  node.translation = numbers(pose.p);
  node.rotation = numbers(pose.q);
  node.mesh = mesh;
  model.nodes.push_back(node);
  const int index = static_cast<int>(model.nodes.size()) - 1;
  if (parent >= 0) model.nodes[parent].children.push_back(index);
  return index;
}

/// Something between two points that the animation places and stretches: a mesh of length 1 along z.
struct Stretched {
  std::string name;
  WirePoint from, to;
  std::size_t joint = kNoJoint;  ///< with which it comes and goes
  double width = 1;              ///< scale in x and y
  int node = -1;

  static constexpr std::size_t kNoJoint = static_cast<std::size_t>(-1);

  /// Pose and length at a frame; a section of a detached joint has no length.
  std::pair<Pose, double> place(const Frame& frame) const {
    const Vec3 begin = frame.poses[from.body.index].point(from.p_BP);
    const Vec3 d = frame.poses[to.body.index].point(to.p_BP) - begin;
    const double length = joint == kNoJoint || frame.joints[joint].attached ? d.norm() : 0;
    const Quat turn = rotation_between(Vec3::UnitZ(), d.norm() > 0 ? d : Vec3(Vec3::UnitZ()));
    return {{turn, begin + d / 2}, length};
  }
};

void add_node(Model& model, Stretched& item, const Frame& start, int mesh) {
  const auto [pose, length] = item.place(start);
  item.node = add_node(model, model.scenes[0].nodes[0], item.name, pose, mesh);
  model.nodes[item.node].scale = {item.width, item.width, length};
}

/// The sections of the rods, ropes and wires, as cylinders.
std::vector<Stretched> add_wires(Model& model, BufferBuilder& buffer, const RecordingHeader& header,
                                 const Frame& start) {
  constexpr double kThickness = 0.004;  // diameter, part of the longest section at the start
  std::vector<Stretched> wires;
  double longest = 0;
  for (std::size_t j = 0; j < header.joints.size(); ++j) {
    const std::string& name = header.joints[j].name;
    const std::vector<WirePoint>& course = header.joints[j].course;
    for (std::size_t i = 1; i < course.size(); ++i) {
      wires.push_back({.name = name, .from = course[i - 1], .to = course[i], .joint = j});
      longest = std::max(longest, wires.back().place(start).second);
    }
  }
  if (wires.empty()) return wires;
  const int material = add_material(model, "wire", {0.2, 0.2, 0.22, 1});
  const Cylinder unit{std::max(kThickness / 2 * longest, 1e-6), 1};
  const int mesh = add_mesh(model, buffer, "wire", drawing_mesh(unit, 8), material);
  for (Stretched& wire : wires) add_node(model, wire, start, mesh);
  return wires;
}

/// Springs as coils, mere dampers as thick cylinders.
std::vector<Stretched> add_springs(Model& model, BufferBuilder& buffer, const RecordingHeader& header,
                                   const Frame& start) {
  std::vector<Stretched> springs;
  if (header.springs.empty()) return springs;
  const int material = add_material(model, "spring", {0.62, 0.3, 0.22, 1});
  const int coil = add_mesh(model, buffer, "spring", coil_mesh(), material);
  const int tube = add_mesh(model, buffer, "damper", drawing_mesh(Cylinder{0.6, 1}, 16), material);
  for (const RecordedSpring& spring : header.springs) {
    Stretched& item =
        springs.emplace_back(Stretched{.name = spring.name, .from = spring.from, .to = spring.to});
    item.width = std::max(kCoilSlimness * item.place(start).second, 1e-6);
    add_node(model, item, start, spring.elastic ? coil : tube);
  }
  return springs;
}

/// The nodes of all bodies, with their shapes below them.  @returns the node of each body.
std::vector<int> add_bodies(Model& model, BufferBuilder& buffer, const RecordingHeader& header,
                            const Frame& start) {
  const Vec3 up = header.gravity.isZero(0) ? Vec3::UnitZ() : Vec3(-header.gravity.normalized());
  const int root = add_node(model, -1, header.scene, {rotation_between(up, Vec3::UnitY()), Vec3::Zero()});
  model.scenes[0].nodes = {root};
  std::vector<int> nodes;
  for (std::size_t b = 0; b < header.bodies.size(); ++b)
    nodes.push_back(add_node(model, root, header.bodies[b].name, start.poses[b]));

  const int moving = add_material(model, "moving", {0.36, 0.52, 0.72, 1});
  const int fixed = add_material(model, "fixed", {0.45, 0.45, 0.47, 1});
  const int segments = header.drawn.size() > 2000 ? 12 : 24;
  std::map<std::pair<int, bool>, int> mesh_of;
  for (const DrawnShape& drawn : header.drawn) {
    const bool is_fixed = header.bodies[drawn.body.index].fixed;
    const auto [mesh, is_new] = mesh_of.try_emplace({drawn.shape, is_fixed}, 0);
    const Shape& shape = header.shapes[drawn.shape];
    if (is_new)
      mesh->second = add_mesh(model, buffer, shape_name(shape), drawing_mesh(shape, segments),
                              is_fixed ? fixed : moving);
    add_node(model, nodes[drawn.body.index], shape_name(shape), drawn.pose, mesh->second);
  }
  return nodes;
}

void add_channel(tinygltf::Animation& animation, int node, const char* path, int times, int values) {
  tinygltf::AnimationSampler sampler;
  sampler.input = times;
  sampler.output = values;
  sampler.interpolation = "LINEAR";
  animation.samplers.push_back(sampler);
  tinygltf::AnimationChannel channel;
  channel.sampler = static_cast<int>(animation.samplers.size()) - 1;
  channel.target_node = node;
  channel.target_path = path;
  animation.channels.push_back(channel);
}

/// What moves a node: a number of floats per instant for each.
struct Track {
  std::vector<float> positions, rotations, scales;

  void add(const Pose& pose) {
    for (int i = 0; i < 3; ++i) positions.push_back(static_cast<float>(pose.p[i]));
    Eigen::Vector4f q = pose.q.coeffs().cast<float>();
    // The shorter way from quaternion to quaternion.
    if (!rotations.empty() && q.dot(Eigen::Map<Eigen::Vector4f>(rotations.data() + rotations.size() - 4)) < 0)
      q = -q;
    for (int i = 0; i < 4; ++i) rotations.push_back(q[i]);
  }
  void write(BufferBuilder& buffer, tinygltf::Animation& animation, int node, int times) const {
    add_channel(animation, node, "translation", times, buffer.floats(positions, TINYGLTF_TYPE_VEC3));
    add_channel(animation, node, "rotation", times, buffer.floats(rotations, TINYGLTF_TYPE_VEC4));
    if (!scales.empty())
      add_channel(animation, node, "scale", times, buffer.floats(scales, TINYGLTF_TYPE_VEC3));
  }
};

void add_animation(Model& model, BufferBuilder& buffer, RecordingReader& recording,
                   const std::vector<int>& nodes, const std::vector<Stretched>& stretched) {
  std::vector<float> times;
  std::vector<Track> bodies(nodes.size()), sections(stretched.size());
  for (int f = 0; f < recording.frame_count(); ++f) {
    const Frame& frame = recording.frame(f);
    const auto time = static_cast<float>(frame.time - recording.time(0));
    if (!times.empty() && time <= times.back()) continue;  // glTF wants ascending times
    times.push_back(time);
    for (std::size_t b = 1; b < bodies.size(); ++b) bodies[b].add(frame.poses[b]);
    for (std::size_t s = 0; s < sections.size(); ++s) {
      const auto [pose, length] = stretched[s].place(frame);
      sections[s].add(pose);
      const auto width = static_cast<float>(length > 0 ? stretched[s].width : 0);
      sections[s].scales.insert(sections[s].scales.end(), {width, width, static_cast<float>(length)});
    }
  }
  if (times.size() < 2) return;
  const int input = buffer.floats(times, TINYGLTF_TYPE_SCALAR);
  tinygltf::Animation animation;
  animation.name = "simulation";
  for (std::size_t b = 1; b < bodies.size(); ++b)
    if (!recording.header().bodies[b].fixed) bodies[b].write(buffer, animation, nodes[b], input);
  for (std::size_t s = 0; s < sections.size(); ++s)
    sections[s].write(buffer, animation, stretched[s].node, input);
  if (!animation.channels.empty()) model.animations.push_back(animation);
}

}  // namespace

bool write_gltf(RecordingReader& recording, std::ostream& out) {
  Model model;
  model.asset.version = "2.0";
  model.asset.generator = "taut " TAUT_VERSION;
  model.scenes.emplace_back();
  model.scenes[0].name = recording.header().scene;
  model.defaultScene = 0;
  BufferBuilder buffer(model);
  const std::vector<int> nodes = add_bodies(model, buffer, recording.header(), recording.frame(0));
  std::vector<Stretched> stretched = add_wires(model, buffer, recording.header(), recording.frame(0));
  const std::vector<Stretched> springs = add_springs(model, buffer, recording.header(), recording.frame(0));
  stretched.insert(stretched.end(), springs.begin(), springs.end());
  add_animation(model, buffer, recording, nodes, stretched);
  return tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, out, false, true);
}

}  // namespace taut
