#include "scenes/import/mesh_shape.h"

#include "collision/mesh/mesh_file.h"
#include "core/base/check.h"

namespace taut::model {

std::filesystem::path find_mesh(const std::filesystem::path& folder, std::string_view name) {
  std::error_code error;
  for (std::string_view scheme : {"package://", "model://"}) {
    if (!name.starts_with(scheme)) continue;
    const std::string_view rest = name.substr(scheme.size());
    std::filesystem::path above = std::filesystem::absolute(folder, error);
    for (int i = 0; i < 100; ++i, above = above.parent_path())
      if (std::filesystem::is_regular_file(above / rest, error)) return above / rest;
    return {};
  }
  if (name.starts_with("file://")) name.remove_prefix(7);
  const std::filesystem::path path = folder / name;
  return std::filesystem::is_regular_file(path, error) ? path : std::filesystem::path();
}

ConvexHull mesh_hull(const std::filesystem::path& folder, std::string_view name, const Vec3& scale) {
  const std::filesystem::path path = find_mesh(folder, name);
  if (path.empty()) fail("mesh", "there is no such file", std::string(name.substr(0, 200)));
  ConvexHull hull{read_mesh(path.string()).vertices};
  for (Vec3& point : hull.points) point = point.cwiseProduct(scale);
  check_shape(hull);
  return hull;
}

}  // namespace taut::model
