#pragma once

#include <optional>

#include "scenes/import/mjcf_hfield.h"
#include "scenes/import/robot_model.h"

namespace taut::model {

/// A geom: what it weighs, and what it collides as.
struct MjcfGeom {
  std::optional<LinkShape> shape;  ///< none: it has no counterpart, which `problem` says
  LinkInertia inertia;             ///< in the frame of the body
  std::string problem;             ///< why there is no shape; its mass is not known then, unless it is 0
  bool weighs = true;              ///< false: planes and height fields
  int group = 0;
};

/// Meshes by name, as convex hulls, which is how geoms collide, with the masses that MJCF gives them.
class MjcfMeshes {
 public:
  MjcfMeshes(XmlFiles& files, const MjcfDefaults& defaults, const MjcfCompiler& compiler,
             const pugi::xml_node& mujoco);
  struct Mesh {
    ConvexHull hull;
    LinkInertia inertia;  ///< of density 1
    std::string problem;
  };
  /// @throws std::invalid_argument if there is no such mesh, or it cannot be read or weighed.
  const Mesh& mesh(const std::string& name) const;

 private:
  Mesh read(const MjcfElement& mesh, const MjcfCompiler& compiler) const;
  std::map<std::string, Mesh> meshes_;
};

/// @throws ImportError for sizes that are wrong or missing.
MjcfGeom read_geom(const MjcfElement& geom, const MjcfCompiler& compiler, const MjcfMeshes& meshes,
                   const MjcfFields& fields);

}  // namespace taut::model
