#include "scenes/import/mjcf_geom.h"

#include <algorithm>
#include <filesystem>

#include "core/base/check.h"
#include "scenes/import/link_inertia.h"
#include "scenes/import/mesh_shape.h"

namespace taut::model {
namespace {

/// Two end points in place of pose and length.
struct Ends {
  Vec3 from, to;
};
std::optional<Ends> ends_of(const MjcfElement& geom) {
  const char* found = geom.find("fromto");
  if (!found) return {};
  const auto v = exactly(geom.files(), geom.node(), "fromto", found, 6);
  const Ends ends{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
  if (!((ends.from - ends.to).norm() > 1e-12)) geom.fail("\"fromto\" must be two points");
  return ends;
}

/// Half sizes by type; `ends` give the last.
std::vector<double> half_sizes(const MjcfElement& geom, std::size_t count, const std::optional<Ends>& ends) {
  std::vector<double> size = geom.numbers("size");
  if (ends) {
    if (size.empty()) geom.fail("\"size\" is missing");
    size = std::vector<double>{size[0]};
    while (size.size() + 1 < count) size.push_back(size.front());
    size.push_back((ends->from - ends->to).norm() / 2);
  }
  if (size.size() < count) geom.fail("\"size\" must have " + std::to_string(count) + " number(s)");
  for (std::size_t i = 0; i < count; ++i) positive(geom.files(), geom.node(), "size", size[i]);
  return size;
}

/// A primitive by its name; nothing for other types.
std::optional<Shape> primitive(const MjcfElement& geom, const std::string& type,
                               const std::optional<Ends>& ends) {
  if (type == "sphere") return Sphere{half_sizes(geom, 1, {})[0]};
  if (type == "capsule" || type == "cylinder") {
    const auto s = half_sizes(geom, 2, ends);
    return type == "capsule" ? Shape(Capsule{s[0], 2 * s[1]}) : Shape(Cylinder{s[0], 2 * s[1]});
  }
  if (type != "ellipsoid" && type != "box") return {};
  const auto s = half_sizes(geom, 3, ends);
  const Vec3 half(s[0], s[1], s[2]);
  return type == "box" ? Shape(Box{2 * half}) : Shape(Ellipsoid{half});
}

Surface surface_of(const MjcfElement& geom) {
  const auto friction = geom.numbers("friction", {1, 0.005, 0.0001});
  for (double f : friction) not_negative(geom.files(), geom.node(), "friction", f);
  Surface surface{static_cast<int>(geom.number("condim", 3)), friction[0], friction[1], friction[2]};
  surface.priority = static_cast<int>(std::clamp(geom.number("priority", 0), -1e6, 1e6));
  return surface;
}

int bits(const MjcfElement& geom, const char* key) {
  const double value = geom.number(key, 1);
  if (!(value >= 0 && value <= 2147483647.0))
    geom.fail(std::string("\"") + key + "\" must be a number of 31 bits");
  return static_cast<int>(value);
}

/// Mass, by `mass` or `density`, of a shape in the frame of the body.
LinkInertia weight(const MjcfElement& geom, const LinkShape& shape, const LinkInertia& unit) {
  const char* given = geom.find("mass");
  const double density = geom.number("density", 1000);
  const double factor = given ? exactly(geom.files(), geom.node(), "mass", given, 1)[0] / unit.mass : density;
  not_negative(geom.files(), geom.node(), given ? "mass" : "density", factor);
  return in_frame(shape.X_LS, scaled(unit, factor));
}

/// Corners and triangles of a mesh, from a file or in place; without triangles it is the hull of its corners.
TriangleMesh triangles_of(const MjcfElement& mesh, const MjcfCompiler& compiler) {
  const Vec3 scale = mesh.vector("scale", Vec3::Ones());
  const std::filesystem::path file(mesh.text("file"));
  if (!file.empty()) return scaled_mesh(mesh.files().folder(mesh.node()), compiler.asset(file), scale);
  const std::vector<double> v = mesh.numbers("vertex"), corners = mesh.numbers("face");
  if (v.empty())
    fail("mesh", "has neither file nor vertices", mesh.text("builtin", mesh.text("name").c_str()));
  TriangleMesh result;
  for (std::size_t i = 0; i + 2 < v.size(); i += 3)
    result.vertices.push_back(Vec3(v[i], v[i + 1], v[i + 2]).cwiseProduct(scale));
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    std::array<int, 3> triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      if (!(corners[i + k] >= 0 && corners[i + k] < static_cast<double>(result.vertices.size())))
        mesh.fail("\"face\" names a vertex that is not there");
      triangle[scale.prod() < 0 ? 2 - k : k] = static_cast<int>(corners[i + k]);
    }
    result.triangles.push_back(triangle);
  }
  return result;
}

}  // namespace

MjcfMeshes::MjcfMeshes(XmlFiles& files, const MjcfDefaults& defaults, const MjcfCompiler& compiler,
                       const pugi::xml_node& mujoco) {
  for (const pugi::xml_node& asset : files.children(mujoco, "asset"))
    for (const pugi::xml_node& node : files.children(asset, "mesh"))
      files.attempt([&] {
        const MjcfElement mesh = defaults.element(node, "");
        const std::string file = mesh.text("file");
        meshes_[mesh.text("name", std::filesystem::path(file).stem().string().c_str())] =
            read(mesh, compiler);
      });
}

MjcfMeshes::Mesh MjcfMeshes::read(const MjcfElement& mesh, const MjcfCompiler& compiler) const {
  Mesh result;
  try {
    const char *at = mesh.find("refpos"), *turned = mesh.find("refquat");
    if (at || turned) fail("mesh", "is moved by refpos or refquat", mesh.text("name"));
    const TriangleMesh triangles = triangles_of(mesh, compiler);
    result.hull.points = triangles.vertices;
    check_shape(result.hull);
    const std::string kind = mesh.text("inertia", "legacy");
    if (kind == "shell") fail("mesh", "a mass of the surface has no counterpart", mesh.text("name"));
    result.inertia =
        triangles.triangles.empty() || kind == "convex"
            ? inertia_of_shape(result.hull)
            : mesh_inertia(triangles, kind == "exact" ? MeshVolume::kExact : MeshVolume::kLegacy);
  } catch (const ImportError&) {
    throw;
  } catch (const std::invalid_argument& error) {
    result.problem = mesh.place().text() + ": " + error.what();
  }
  return result;
}

const MjcfMeshes::Mesh& MjcfMeshes::mesh(const std::string& name) const {
  const auto found = meshes_.find(name);
  if (found == meshes_.end()) fail("mesh", "there is none of this name" + near_name(name, meshes_), name);
  if (!found->second.problem.empty()) throw std::invalid_argument(found->second.problem);
  return found->second;
}

namespace {

/// @throws std::invalid_argument for what has no counterpart.
Shape shape_of(const MjcfElement& geom, const std::string& type, const std::optional<Ends>& ends,
               const MjcfMeshes& meshes, const MjcfFields& fields) {
  const std::string mesh = geom.text("mesh");
  if (type == "plane") {
    geom.find("size");
    return HalfSpace{};
  }
  if (type == "mesh") return meshes.mesh(mesh).hull;
  if (type == "hfield") return fields.field(geom.text("hfield"));
  if (type == "sdf") fail("geom", "has no counterpart", type);
  if (!mesh.empty()) {
    (void)meshes.mesh(mesh);
    fail("geom", "a primitive that is fitted to a mesh has no counterpart", mesh);
  }
  const auto found = primitive(geom, type, ends);
  if (!found)
    geom.fail("unknown type of geom" +
              meant_type(type, {"plane", "hfield", "sphere", "capsule", "ellipsoid", "cylinder", "box",
                                "mesh", "sdf"}) +
              " (value: " + type + ")");
  return *found;
}

}  // namespace

MjcfGeom read_geom(const MjcfElement& geom, const MjcfCompiler& compiler, const MjcfMeshes& meshes,
                   const MjcfFields& fields) {
  MjcfGeom result;
  const std::string mesh = geom.text("mesh"), type = geom.text("type", mesh.empty() ? "sphere" : "mesh");
  result.group = static_cast<int>(std::clamp(geom.number("group", 0), -1e6, 1e6));
  result.weighs = type != "plane" && type != "hfield";
  const auto ends = type == "mesh" || type == "sphere" ? std::optional<Ends>() : ends_of(geom);
  LinkShape shape;
  shape.X_LS = geom.pose(compiler);
  if (ends) shape.X_LS = {z_to(ends->from - ends->to), (ends->from + ends->to) / 2};
  shape.surface = surface_of(geom);
  shape.touches.type = bits(geom, "contype");
  shape.touches.affinity = bits(geom, "conaffinity");
  shape.name = geom.text("name");
  try {
    shape.shape = shape_of(geom, type, ends, meshes, fields);
    if (result.weighs)
      result.inertia =
          weight(geom, shape, type == "mesh" ? meshes.mesh(mesh).inertia : inertia_of_shape(shape.shape));
    result.shape = std::move(shape);
  } catch (const ImportError&) {
    throw;
  } catch (const std::invalid_argument& error) {
    result.problem = error.what();
  }
  return result;
}

}  // namespace taut::model
