#include "collision/mesh/mesh_file.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <filesystem>
#include <map>
#include <tuple>

#include "core/base/check.h"

namespace taut {
namespace {

/// No file is read that is longer [bytes]: some ten million triangles.
constexpr std::uintmax_t kMostMeshBytes = std::uintmax_t{1} << 30;

std::string lower_extension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

/// Merges vertices in the same place.
class MeshBuilder {
 public:
  int vertex(const Vec3& p) {
    const auto [entry, fresh] =
        index_.emplace(std::tuple(p.x(), p.y(), p.z()), static_cast<int>(mesh.vertices.size()));
    if (fresh) mesh.vertices.push_back(p);
    return entry->second;
  }
  TriangleMesh mesh;

 private:
  std::map<std::tuple<double, double, double>, int> index_;
};

}  // namespace

TriangleMesh read_mesh(const std::string& file, double scale) {
  require_positive("mesh scale", scale);
  const std::string name = "mesh file " + file;
  const std::string extension = lower_extension(file);
  if (extension != ".obj" && extension != ".stl") fail(name, "must be .obj or .stl", extension);
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) fail(name, "there is no such file", file);
  if (const auto size = std::filesystem::file_size(file, error); size > kMostMeshBytes)
    fail(name, "is too long: at most " + std::to_string(kMostMeshBytes) + " bytes are read", size);

  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(file, aiProcess_Triangulate | aiProcess_PreTransformVertices);
  if (!scene || (scene->mFlags & AI_SCENE_FLAGS_INCOMPLETE))
    fail(name, "cannot be read", importer.GetErrorString());
  MeshBuilder builder;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& part = *scene->mMeshes[m];
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices != 3) continue;  // points and lines have no inside
      std::array<int, 3> triangle;
      for (unsigned i = 0; i < 3; ++i) {
        const aiVector3D& p = part.mVertices[face.mIndices[i]];
        const Vec3 vertex = scale * Vec3(p.x, p.y, p.z);
        if (!vertex.allFinite()) fail_with(name, "has a vertex that is not finite", vertex);
        triangle[i] = builder.vertex(vertex);
      }
      builder.mesh.triangles.push_back(triangle);
    }
  }
  if (builder.mesh.triangles.empty()) fail(name, "has no triangles", file);
  try {
    check_shape(builder.mesh);
  } catch (const std::invalid_argument& bad) {
    throw std::invalid_argument(name + ": " + bad.what());
  }
  return std::move(builder.mesh);
}

}  // namespace taut
