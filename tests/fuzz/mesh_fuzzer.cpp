#include <stdexcept>

#include "collision/mesh/mesh_file.h"
#include "core/world/shape.h"
#include "tests/fuzz/input_file.h"

// Mesh files: OBJ if the first byte is 'o', else STL, then the file.

// Assimp does not free what it had read of a mesh file that is broken.
extern "C" const char* __lsan_default_suppressions() { return "leak:libassimp"; }  // NOLINT: its name

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace taut::fuzz;
  static InputFile obj(".obj"), stl(".stl");
  if (size == 0) return 0;
  InputFile& file = data[0] == 'o' ? obj : stl;
  file.set(text_of(data + 1, size - 1));
  try {
    const taut::TriangleMesh mesh = taut::read_mesh(file.path());
    if (mesh.triangles.empty()) found("a mesh without triangles");
    taut::check_shape(mesh);  // what is read is sound
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
