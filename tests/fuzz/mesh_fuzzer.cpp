#include <stdexcept>

#include "collision/mesh_file.h"
#include "core/shape.h"
#include "tests/fuzz/input_file.h"

// Mesh files: OBJ if the first byte is 'o', else STL, then the file.

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
