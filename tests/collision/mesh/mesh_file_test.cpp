#include "collision/mesh/mesh_file.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <sstream>

#include "core/world/solid.h"
#include "tests/core/expect_invalid.h"
#include "tests/temporary.h"

namespace taut::mesh_file_test {
namespace {

using testing::expect_invalid;

std::filesystem::path mesh_file(const std::string& name, const std::string& content) {
  const std::string file = testing::temporary(name);
  testing::write_text(file, content);
  return file;
}

const char* const kCubeObj =
    "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 0 0 2\nv 2 0 2\nv 2 2 2\nv 0 2 2\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

/// A tetrahedron with the corners 0, x, y, z.
const Vec3 kTetrahedron[4][3] = {{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}},
                                 {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}},
                                 {{0, 0, 0}, {0, 0, 1}, {0, 1, 0}},
                                 {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

std::string text_stl() {
  std::ostringstream text;
  text << "solid tetrahedron\n";
  for (const auto& facet : kTetrahedron) {
    text << "facet normal 0 0 0\n outer loop\n";
    for (const Vec3& v : facet) text << "  vertex " << v.x() << " " << v.y() << " " << v.z() << "\n";
    text << " endloop\nendfacet\n";
  }
  text << "endsolid tetrahedron\n";
  return text.str();
}

std::string binary_stl() {
  std::string data(80, ' ');
  const auto put = [&](const auto& value) {
    char bytes[sizeof(value)];
    std::memcpy(bytes, &value, sizeof(value));
    data.append(bytes, sizeof(value));
  };
  put(std::uint32_t{4});
  for (const auto& facet : kTetrahedron) {
    for (int i = 0; i < 3; ++i) put(0.0f);
    for (const Vec3& v : facet)
      for (int i = 0; i < 3; ++i) put(static_cast<float>(v[i]));
    put(std::uint16_t{0});
  }
  return data;
}

TEST(MeshFile, ObjWithQuadranglesIsAClosedCube) {
  const auto file = mesh_file("cube.obj", kCubeObj);
  const TriangleMesh mesh = read_mesh(file, 0.5);
  EXPECT_EQ(mesh.vertices.size(), 8u);
  EXPECT_EQ(mesh.triangles.size(), 12u);
  const SolidProperties solid = solid_properties(mesh);
  EXPECT_NEAR(solid.volume, 1, 1e-7);
  EXPECT_LT((solid.centre - Vec3(0.5, 0.5, 0.5)).norm(), 1e-7);
}

TEST(MeshFile, StlAsTextAndBinaryIsAClosedTetrahedron) {
  for (const auto& path : {mesh_file("text.stl", text_stl()), mesh_file("binary.STL", binary_stl())}) {
    const TriangleMesh mesh = read_mesh(path);
    EXPECT_EQ(mesh.vertices.size(), 4u);
    EXPECT_NEAR(solid_properties(mesh).volume, 1.0 / 6, 1e-8);
  }
}

TEST(MeshFile, WhatIsWrongIsSaidWithTheFile) {
  expect_invalid([] { read_mesh("nowhere/none.obj"); }, {"nowhere/none.obj", "no such file"});
  expect_invalid([] { read_mesh("part.dae"); }, {"part.dae", ".obj or .stl"});
  expect_invalid([] { read_mesh(std::filesystem::temp_directory_path() / "x.obj" / ".."); }, {"mesh file"});
  const auto expect_bad = [](const std::string& name, const std::string& content) {
    const auto file = mesh_file(name, content);
    expect_invalid([&] { read_mesh(file); }, {file.c_str()});
  };
  expect_bad("empty.obj", "");
  expect_bad("empty.stl", "");
  expect_bad("noise.stl", "this is not a mesh at all");
  expect_bad("points.obj", "v 0 0 0\nv 1 0 0\n");
  expect_bad("line.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n");
  expect_bad("outside.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  expect_bad("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  expect_bad("nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  expect_bad("cut.stl", binary_stl().substr(0, 120));
  const auto cube = mesh_file("cube.obj", kCubeObj);
  expect_invalid([&] { read_mesh(cube, 0); }, {"mesh scale", "0"});
  expect_invalid([&] { read_mesh(cube, std::numeric_limits<double>::infinity()); }, {"mesh scale", "inf"});
}

}  // namespace
}  // namespace taut::mesh_file_test
