#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <pugixml.hpp>
#include <sstream>

#include "scenes/export/coil.h"
#include "scenes/export/exports.h"
#include "scenes/export/page_columns.h"
#include "scenes/export/page_data.h"
#include "scenes/export/svg_plot.h"
#include "scenes/support/base64.h"
#include "tests/run_program.h"
#include "tests/scenes/program/resource_limit.h"
#include "tests/scenes/recording/sample_recording.h"
#include "tests/temporary.h"

namespace taut::testing::export_test {
namespace {

constexpr int kFrames = 5;

std::string sample_file() {
  const std::string file = temporary("export.taut");
  write_sample(file, kFrames);
  return file;
}

/// glTF's world has y up: (x, y, z) of ours is (x, z, −y) there.
Vec3 y_up(const Vec3& v) { return {v.x(), v.z(), -v.y()}; }

const aiNode* body_node(const aiScene& scene, const char* name) {
  const aiNode* node = scene.mRootNode->FindNode(name);
  EXPECT_NE(node, nullptr) << name;
  return node;
}

aiMatrix4x4 world_matrix(const aiNode* node) {
  aiMatrix4x4 matrix;
  for (; node; node = node->mParent) matrix = node->mTransformation * matrix;
  return matrix;
}

const aiNodeAnim* channel_of(const aiAnimation& animation, std::string_view node) {
  for (unsigned c = 0; c < animation.mNumChannels; ++c)
    if (animation.mChannels[c]->mNodeName.C_Str() == node) return animation.mChannels[c];
  return nullptr;
}

// assimp reads what tinygltf wrote: two libraries that know nothing of each other.
TEST(Gltf, AssimpFindsBodiesShapesAndMotion) {
  RecordingReader recording(sample_file());
  const std::string file = temporary("s.glb");
  ASSERT_TRUE(export_recording(recording, {.html = {}, .gltf = file, .vtk_folder = {}, .plot = {}, .csv = {}})
                  .errors.empty());
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(file, aiProcess_ValidateDataStructure);
  ASSERT_NE(scene, nullptr) << importer.GetErrorString();

  // The first pose, with all parents.
  const Pose start = sample_frame(0).poses[2];
  const aiMatrix4x4 world = world_matrix(body_node(*scene, "ball, red"));
  const Vec3 expected = y_up(start.p);
  EXPECT_NEAR(world.a4, expected.x(), 1e-6);
  EXPECT_NEAR(world.b4, expected.y(), 1e-6);
  EXPECT_NEAR(world.c4, expected.z(), 1e-6);
  const Vec3 z_axis = y_up(start.q * Vec3::UnitZ());  // third column of the rotation
  EXPECT_NEAR(world.a3, z_axis.x(), 1e-6);
  EXPECT_NEAR(world.b3, z_axis.y(), 1e-6);
  EXPECT_NEAR(world.c3, z_axis.z(), 1e-6);

  // Only the moving body, the rod, the spring and the damper are animated, with every frame.
  ASSERT_EQ(scene->mNumAnimations, 1u);
  const aiAnimation& animation = *scene->mAnimations[0];
  ASSERT_EQ(animation.mNumChannels, 4u);
  ASSERT_TRUE(channel_of(animation, "ball, red") && channel_of(animation, "strut"));
  const aiNodeAnim &channel = *channel_of(animation, "ball, red"), &rod = *channel_of(animation, "strut");
  ASSERT_EQ(rod.mNumScalingKeys, static_cast<unsigned>(kFrames));
  ASSERT_EQ(channel.mNumPositionKeys, static_cast<unsigned>(kFrames));
  ASSERT_EQ(channel.mNumRotationKeys, static_cast<unsigned>(kFrames));
  const double per_second = animation.mTicksPerSecond > 0 ? animation.mTicksPerSecond : 1000;
  for (int i = 0; i < kFrames; ++i) {
    const Frame frame = sample_frame(i);
    EXPECT_NEAR(channel.mPositionKeys[i].mTime / per_second, frame.time, 1e-5);
    const aiVector3D& p = channel.mPositionKeys[i].mValue;
    EXPECT_LT((Vec3(p.x, p.y, p.z) - frame.poses[2].p).norm(), 1e-6);
    const aiQuaternion& q = channel.mRotationKeys[i].mValue;
    EXPECT_LT(Quat(q.w, q.x, q.y, q.z).angularDistance(frame.poses[2].q), 1e-6);
    const double length = (frame.poses[2].point({0.125, 0, 0}) - frame.poses[1].point({0, 0, 0.5})).norm();
    EXPECT_NEAR(rod.mScalingKeys[i].mValue.z, i == 3 ? 0 : length, 1e-6);  // detached in frame 3
  }

  // The sphere of radius 0.25, in its body's frame.
  const aiNode* shape = body_node(*scene, "ball, red")->mChildren[0];
  ASSERT_EQ(shape->mNumMeshes, 1u);
  const aiMesh& mesh = *scene->mMeshes[shape->mMeshes[0]];
  EXPECT_GT(mesh.mNumFaces, 100u);
  for (unsigned v = 0; v < mesh.mNumVertices; ++v) EXPECT_NEAR(mesh.mVertices[v].Length(), 0.25, 1e-6);
}

// Both ends of coil and cylinder are where those of the spring and the damper are, in each frame.
TEST(Gltf, SpringsReachFromEndToEnd) {
  RecordingReader recording(sample_file());
  const std::string file = temporary("springs.glb");
  ASSERT_TRUE(export_recording(recording, {.html = {}, .gltf = file, .vtk_folder = {}, .plot = {}, .csv = {}})
                  .errors.empty());
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(file, aiProcess_ValidateDataStructure);
  ASSERT_NE(scene, nullptr) << importer.GetErrorString();
  for (const RecordedSpring& spring : sample_header().springs) {
    const aiNodeAnim* channel = channel_of(*scene->mAnimations[0], spring.name);
    ASSERT_NE(channel, nullptr) << spring.name;
    ASSERT_EQ(channel->mNumScalingKeys, static_cast<unsigned>(kFrames));
    const aiMesh& mesh = *scene->mMeshes[body_node(*scene, spring.name.c_str())->mMeshes[0]];
    Vec3 low = Vec3::Constant(1e9), high = -low;
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const Vec3 p(mesh.mVertices[v].x, mesh.mVertices[v].y, mesh.mVertices[v].z);
      low = low.cwiseMin(p), high = high.cwiseMax(p);
    }
    EXPECT_NEAR(low.z(), -0.5, 1e-3);
    EXPECT_NEAR(high.z(), 0.5, 1e-3);
    EXPECT_NEAR(high.x(), -low.x(), 0.05);  // about the axis
    for (int i = 0; i < kFrames; ++i) {
      const Frame frame = sample_frame(i);
      const Vec3 from = frame.poses[spring.from.body.index].point(spring.from.p_BP),
                 to = frame.poses[spring.to.body.index].point(spring.to.p_BP);
      const aiVector3D &p = channel->mPositionKeys[i].mValue, &s = channel->mScalingKeys[i].mValue;
      const aiQuaternion& q = channel->mRotationKeys[i].mValue;
      const Vec3 half = Quat(q.w, q.x, q.y, q.z) * Vec3(0, 0, s.z / 2), middle(p.x, p.y, p.z);
      EXPECT_LT((middle + half - to).norm(), 1e-6) << spring.name << " in frame " << i;
      EXPECT_LT((middle - half - from).norm(), 1e-6) << spring.name << " in frame " << i;
    }
  }
}

// The divergence theorem gives the volume of what the surface and the two discs at its open ends enclose.
TEST(Coil, IsAWireOfTheLengthOfItsHelix) {
  const int turns = 9;
  const DrawingMesh mesh = coil_mesh(turns, 48, 24);
  double volume = 0, outward = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto slim = [&](int i) {
      const Vec3& v = mesh.vertices[i];
      return Vec3(kCoilSlimness * v.x(), kCoilSlimness * v.y(), v.z());
    };
    volume += slim(a).dot(slim(b).cross(slim(c))) / 6;
    const Vec3 normal = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
    outward += normal.dot(mesh.normals[a]) > 0;
  }
  // Where the wire leaves the axis it bends more sharply than it is thick.
  EXPECT_GT(outward, 0.98 * static_cast<double>(mesh.triangles.size()));
  const double area = std::numbers::pi * std::pow(0.16 * kCoilSlimness, 2), radius = kCoilSlimness;
  const double discs = 2 * 0.5 * area / 3;  // at z = ±½
  // Within the first and the last half turn the radius grows from 0: half a turn is missing in all.
  const double length = std::hypot(2 * std::numbers::pi * radius * (turns - 0.5), 0.8) + 0.2;
  EXPECT_NEAR(volume + discs, area * length, 0.03 * volume);  // of a wire of 24 corners 1 % is missing
}

TEST(Svg, CurvesPassThroughTheValues) {
  RecordingReader recording(sample_file());
  pugi::xml_document document;
  const std::string text = svg_plot(recording);
  ASSERT_TRUE(document.load_string(text.c_str()));
  const auto title = document.select_node("/svg/title").node();
  EXPECT_EQ(std::string(title.text().get()), sample_header().scene);  // with its < and &
  const auto lines = document.select_nodes("//path[@class='line']");
  ASSERT_EQ(lines.size(), 3u + 2 + 1);  // energies with their sum, gaps, the probe
  // Kinetic energy grows by the same in each frame: a straight line that goes up.
  std::string path = lines[0].node().attribute("d").value();
  std::replace_if(
      path.begin(), path.end(), [](char c) { return c == 'M' || c == 'L'; }, ' ');
  std::istringstream in(path);
  std::vector<double> numbers;
  for (double number; in >> number;) numbers.push_back(number);
  ASSERT_EQ(numbers.size(), 2u * kFrames);
  for (int i = 1; i < kFrames; ++i) {
    EXPECT_NEAR(numbers[2 * i] - numbers[2 * i - 2], numbers[2] - numbers[0],
                0.011);  // two decimals are written
    EXPECT_NEAR(numbers[2 * i + 1] - numbers[2 * i - 1], numbers[3] - numbers[1], 0.011);
    EXPECT_LT(numbers[2 * i + 1], numbers[2 * i - 1]);
  }
}

TEST(Svg, TicksAreRoundAndInside) {
  EXPECT_EQ(axis_ticks(0, 10, 5), (std::vector<double>{0, 2, 4, 6, 8, 10}));
  EXPECT_EQ(axis_ticks(-1, 1, 4), (std::vector<double>{-1, -0.5, 0, 0.5, 1}));
  EXPECT_EQ(axis_ticks(120, 190, 3), (std::vector<double>{150}));
  for (const double scale : {1e-300, 1e-12, 1.0, 3e7, 1e300})
    EXPECT_FALSE(axis_ticks(-0.4 * scale, 0.7 * scale, 5).empty());
}

TEST(Base64, IsThatOfTheStandard) {  // [RFC 4648, section 10]
  const std::pair<const char*, const char*> cases[] = {{"", ""},
                                                       {"f", "Zg=="},
                                                       {"fo", "Zm8="},
                                                       {"foo", "Zm9v"},
                                                       {"foob", "Zm9vYg=="},
                                                       {"fooba", "Zm9vYmE="},
                                                       {"foobar", "Zm9vYmFy"}};
  for (const auto& [bytes, text] : cases) EXPECT_EQ(base64(bytes), text);
  EXPECT_EQ(base64("\xfb\xff\xbf"), "+/+/");
}

/// The value of a half by its definition.
double half_value(int bits) {
  const int exponent = bits >> 10 & 31, mantissa = bits & 1023;
  const double magnitude =
      exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(1024 + mantissa, exponent - 25);
  return bits & 0x8000 ? -magnitude : magnitude;
}

TEST(HalfFloat, EveryFiniteHalfIsItself) {
  for (int bits = 0; bits < 65536; ++bits) {
    if ((bits >> 10 & 31) == 31) continue;  // infinities and what is no number
    EXPECT_EQ(half_float(static_cast<float>(half_value(bits))), bits);
  }
}

TEST(HalfFloat, RoundsToTheNearest) {
  for (int bits = 0; bits < 0x7bff; ++bits) {
    const double below = half_value(bits), above = half_value(bits + 1);
    EXPECT_EQ(half_float(static_cast<float>(below + 0.49 * (above - below))), bits);
    EXPECT_EQ(half_float(static_cast<float>(below + 0.51 * (above - below))), bits + 1);
  }
  EXPECT_EQ(half_float(1e9f), 0x7c00);
  EXPECT_EQ(half_float(-std::numeric_limits<float>::infinity()), 0xfc00);
  EXPECT_EQ(half_float(std::numeric_limits<float>::quiet_NaN()) & 0x7fff, 0x7e00);
}

TEST(PageData, LeavesFramesOutAboveItsLimit) {
  RecordingReader recording(sample_file());
  EXPECT_EQ(page_data(recording).stride, 1);
  const PageData small = page_data(recording, 150);  // one frame has 108 bytes
  EXPECT_GT(small.stride, 1);
  EXPECT_EQ(small.description["frames"], (kFrames + small.stride - 1) / small.stride);
}

// Of a disk that fills up: the reason is said, and no half of a page is left.
TEST(Exports, WhatFillsUpIsSaidAndTakenAway) {
  RecordingReader recording(sample_file());
  const ExportFiles files{.html = {},
                          .gltf = temporary("full.glb"),
                          .vtk_folder = temporary("full_vtk"),
                          .plot = temporary("full.svg"),
                          .csv = temporary("full.csv")};
  ExportOutcome outcome;
  {
    const FileSizeLimit limit(200);
    outcome = export_recording(recording, files);
  }
  ASSERT_EQ(outcome.errors.size(), 4u);
  for (const std::string& error : outcome.errors)
    EXPECT_NE(error.find("File too large"), std::string::npos) << error;
  for (const std::string& file : {files.gltf, files.plot, files.csv})
    EXPECT_FALSE(std::filesystem::exists(file)) << file;
}

TEST(Exports, ASingleFrameAndAWorldWithoutBodiesAreShown) {
  RecordingHeader header;
  header.scene = "nothing";
  header.bodies = {{"ground", 0, true}};
  const std::string file = temporary("nothing.taut");
  {
    RecordingWriter writer(file, header);
    Frame frame;
    frame.poses.resize(1);
    frame.twists.resize(1);
    writer.append(frame);
    EXPECT_TRUE(writer.finish("success", ""));
  }
  RecordingReader recording(file);
  const ExportOutcome outcome = export_recording(recording, {.html = {},
                                                             .gltf = temporary("n.glb"),
                                                             .vtk_folder = temporary("n_vtk"),
                                                             .plot = temporary("n.svg"),
                                                             .csv = temporary("n.csv")});
  EXPECT_TRUE(outcome.errors.empty());
  EXPECT_EQ(read_text(temporary("n.csv")), "time\n0\n");
  EXPECT_EQ(page_data(recording).description["frames"], 1);
}

}  // namespace
}  // namespace taut::testing::export_test
