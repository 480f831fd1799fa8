#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>

#include "scenes/export/mjcf_export.h"
#include "scenes/files/scene_file.h"
#include "scenes/import/height_picture.h"
#include "scenes/import/imported_model.h"
#include "scenes/support/base64.h"
#include "solvers/simulator/simulator.h"
#include "tests/scenes/import/text_checks.h"
#include "tests/temporary.h"

// Height fields of MJCF and SDF: which way round they are, what pictures say, and cones of SDF.
namespace taut::field_test {
namespace {

using testing::notes;

// Pictures that another encoder's reader has read so, too.
const char* const kGrey =  // 4 × 5, each row with another filter
    "iVBORw0KGgoAAAANSUhEUgAAAAQAAAAFCAAAAABHxhIHAAAAB0lEQVR42mPgEpE762oT5QAAABtJREFUwchgZDOTifPazP/"
    "MCSrn61nmeykwAwBVggdrZgkhPAAAAABJRU5ErkJggg==";
const char* const kRed16 =  // 2 × 2
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACEAIAAACtREYwAAAAB0lEQVR42mNhZOIEXIfRUQAAABlJREFUgn9/GYCAmeE/KysLC2Pjjx"
    "8/fwIAQGoHn8ZkbJ0AAAAASUVORK5CYII=";
const char* const kPalette =  // 3 × 2, 4 bits
    "iVBORw0KGgoAAAANSUhEUgAAAAMAAAACBAMAAABvWnspAAAACVBMVEUFAABkAQH/"
    "AgK97ZhVAAAAB0lEQVR42mNgVGBSS+1drAAAAAdJREFUeAAAAbEBJM/pY7oAAAAASUVORK5CYII=";
const char* const kOneBit =  // 3 × 2
    "iVBORw0KGgoAAAANSUhEUgAAAAMAAAACAQAAAAC1D1u3AAAAB0lEQVR42mNYwJAAFbFMqwAAAAVJREFUAAJEAQH/"
    "CrWJAAAAAElFTkSuQmCC";
const char* const kGreyAlpha =  // 2 × 2
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAQAAADYv8WvAAAAB0lEQVR42mNk/"
    "8/EIVHuLQAAAAtJREFUwBLLmMIIAAqtAdHJL4CtAAAAAElFTkSuQmCC";

std::vector<double> read_values(const char* picture, double most) {
  std::vector<double> values = model::read_png(from_base64(picture).value()).values;
  for (double& value : values) value = std::round(value * most * 1e6) / 1e6;
  return values;
}

TEST(ImportFields, PicturesOfAllKinds) {
  using Values = std::vector<double>;
  EXPECT_EQ(read_values(kGrey, 255),
            (Values{10, 20, 30, 200, 0, 50, 110, 7, 9, 8, 7, 6, 100, 90, 255, 1, 3, 77, 31, 4}));
  EXPECT_EQ(read_values(kRed16, 65535), (Values{258, 65535, 0, 32768}));
  EXPECT_EQ(read_values(kPalette, 255), (Values{5, 100, 255, 255, 100, 5}));
  EXPECT_EQ(read_values(kOneBit, 1), (Values{1, 0, 1, 0, 1, 1}));
  EXPECT_EQ(read_values(kGreyAlpha, 255), (Values{7, 9, 100, 200}));
}

/// Any byte that is another, or the end of them, is told.
TEST(RobustImportFields, DamagedPicturesAreRefused) {
  for (const char* picture : {kGrey, kRed16, kPalette}) {
    const std::string sound = from_base64(picture).value();
    for (std::size_t i = 0; i < sound.size(); ++i) {
      std::string damaged = sound;
      damaged[i] = static_cast<char>(damaged[i] ^ 0x41);
      EXPECT_THROW((void)model::read_png(damaged), std::invalid_argument) << i;
      EXPECT_THROW((void)model::read_png(sound.substr(0, i)), std::invalid_argument) << i;
    }
  }
}

/// Levels of a field 6 m by 3 m, one in each quadrant, steep in between; in rows from +y on, from −x on.
const std::string kLevels = "10 10 30 30  10 10 30 30  50 50 20 20  50 50 20 20";
const std::string kSize = "size='3 1.5 0.4 0.1'";
const double kNorthWest = 0, kNorthEast = 0.2, kSouthWest = 0.4, kSouthEast = 0.1;

std::string field_model(const std::string& hfield, const std::string& pose = "") {
  std::string bodies;
  for (const char* at : {"-2 1", "2 1", "-2 -1", "2 -1"})
    bodies += std::string("<body name='") + at + "' pos='" + at +
              " 0.6'><freejoint/><geom size='0.1' mass='1'/></body>";
  return "<mujoco><asset>\n<hfield name='h' " + hfield +
         "/></asset><worldbody>\n<geom type='hfield' hfield='h' " + pose + "/>" + bodies +
         "</worldbody></mujoco>";
}

/// A second on, each ball rests on the level under it.
void expect_levels(Scene scene, double north_west, double north_east, double south_west, double south_east) {
  Simulator simulator(scene.world, scene.settings);
  for (int i = 0; i < 250; ++i) ASSERT_TRUE(simulator.step(4e-3).ok()) << simulator.report().message;
  const auto height = [&](const char* name) { return scene.world.pose(scene.world.body(name)).p.z() - 0.1; };
  EXPECT_NEAR(height("-2 1"), north_west, 1e-6);
  EXPECT_NEAR(height("2 1"), north_east, 1e-6);
  EXPECT_NEAR(height("-2 -1"), south_west, 1e-6);
  EXPECT_NEAR(height("2 -1"), south_east, 1e-6);
}

Scene scene_of(const std::string& mjcf, const std::filesystem::path& file = "m.xml") {
  return parse_scene(import_model_text(mjcf, file).document.dump(), "m.xml");
}

TEST(ImportFields, BallsRestOnTheLevelsOfAField) {
  const std::string hfield = "nrow='4' ncol='4' elevation='" + kLevels + "' " + kSize;
  expect_levels(scene_of(field_model(hfield)), kNorthWest, kNorthEast, kSouthWest, kSouthEast);
  // Half a turn, and lower.
  expect_levels(scene_of(field_model(hfield, "euler='0 0 180' pos='0 0 -.3'")), kSouthEast - 0.3,
                kSouthWest - 0.3, kNorthEast - 0.3, kNorthWest - 0.3);
  EXPECT_TRUE(notes(import_model_text(field_model(hfield), "m.xml"),
                    "m.xml:2: <hfield>: it has no base and no sides, all that is below it is solid"));
}

/// A file of MuJoCo's own format has its first row at −y.
TEST(ImportFields, ABinaryFileBeginsAtTheOtherSide) {
  const std::int32_t size[2] = {4, 4};
  const float values[16] = {5, 5, 2, 2, 5, 5, 2, 2, 1, 1, 3, 3, 1, 1, 3, 3};
  std::ofstream(testing::temporary("field.bin"), std::ios::binary)
      .write(reinterpret_cast<const char*>(size), sizeof size)
      .write(reinterpret_cast<const char*>(values), sizeof values);
  expect_levels(scene_of(field_model("file='field.bin' " + kSize), testing::temporary("m.xml")), kNorthWest,
                kNorthEast, kSouthWest, kSouthEast);
  std::ofstream(testing::temporary("short.bin"), std::ios::binary)
      .write(reinterpret_cast<const char*>(size), sizeof size);
  EXPECT_TRUE(notes(import_model_text(field_model("file='short.bin' " + kSize), testing::temporary("m.xml")),
                    "has not as many bytes of heights as rows and columns"));
}

TEST(ImportFields, APictureBeginsAtPlusY) {
  std::ofstream(testing::temporary("grey.png"), std::ios::binary) << from_base64(kGrey).value();
  const Scene scene = scene_of(field_model("file='grey.png' size='3 2 0.51 1'"), testing::temporary("m.xml"));
  const auto& field = std::get<HeightField>(*scene.world.shape(ShapeId{0}).shape);
  EXPECT_EQ(field.nx, 4);
  EXPECT_EQ(field.ny, 5);
  EXPECT_NEAR(field.dx, 2, 1e-15);
  EXPECT_NEAR(field.dy, 1, 1e-15);
  EXPECT_NEAR(field.heights[0], 3 * 0.002, 1e-15);    // the last row
  EXPECT_NEAR(field.heights[18], 30 * 0.002, 1e-15);  // the first
}

/// Both halves of a cell meet between its corners of the least and the greatest x and y, as MuJoCo has them
/// (its mj_ray() finds 0 there): a ball rests in this valley.
TEST(ImportFields, ACellIsHalvedAsInMuJoCo) {
  Scene scene = scene_of(
      "<mujoco><asset><hfield name='h' nrow='2' ncol='2' elevation='1 0 0 1' size='1 1 1 "
      "1'/></asset><worldbody>"
      "<geom type='hfield' hfield='h'/><body name='b' pos='0 0 0.3'><freejoint/><geom size='.1' mass='1'/>"
      "</body></worldbody></mujoco>");
  Simulator simulator(scene.world, scene.settings);
  for (int i = 0; i < 200; ++i) ASSERT_TRUE(simulator.step(5e-3).ok()) << simulator.report().message;
  EXPECT_NEAR(scene.world.pose(scene.world.body("b")).p.z(), 0.1 * std::sqrt(1.5), 1e-6);
}

TEST(ImportFields, AFieldComesBackAsItWas) {
  const std::string hfield = "nrow='4' ncol='4' elevation='" + kLevels + "' " + kSize;
  Scene scene = scene_of(field_model(hfield));
  HeightField field = std::get<HeightField>(*scene.world.shape(ShapeId{0}).shape);
  for (double& height : field.heights) height -= 3;  // not from 0 on
  scene.world.add_shape(kGround, field, {Quat::Identity(), Vec3(0, 0, 3)});
  std::vector<std::string> notices;
  const Scene back = scene_of(mjcf_of(scene, notices));
  EXPECT_TRUE(notices.empty()) << notices[0];
  for (int s : {0, scene.world.shape_count() - 1}) {
    const ShapeRecord &was = scene.world.shape(ShapeId{s}), &is = back.world.shape(ShapeId{s == 0 ? 0 : 1});
    const auto &a = std::get<HeightField>(*was.shape), &b = std::get<HeightField>(*is.shape);
    ASSERT_EQ(a.heights.size(), b.heights.size());
    for (std::size_t i = 0; i < a.heights.size(); ++i)
      EXPECT_NEAR(a.heights[i] + was.pose.p.z(), b.heights[i] + is.pose.p.z(), 1e-14);
    EXPECT_NEAR(a.dx, b.dx, 1e-15);
    EXPECT_NEAR(a.dy, b.dy, 1e-15);
  }
  expect_levels(scene_of(mjcf_of(scene_of(field_model(hfield)), notices)), kNorthWest, kNorthEast, kSouthWest,
                kSouthEast);
}

TEST(ImportFields, WrongFieldsAreNamedWithFileAndLine) {
  const auto refused = [](const std::string& hfield, const std::string& message) {
    testing::expect_refused([&] { return import_model_text(field_model(hfield), "m.xml"); }, message,
                            "m.xml:2:");
  };
  refused("nrow='2' ncol='2' elevation='1 2 3' size='1 1 1 1'", "\"elevation\" must have nrow·ncol numbers");
  refused("nrow='1' ncol='2' elevation='1 2' size='1 1 1 1'", "\"nrow\" and \"ncol\" must be 2 or more");
  refused("nrow='2' ncol='2' size='1 1 0 1'", "\"size\" must be positive");
  refused("nrow='1e9' ncol='1e9' size='1 1 1 1'", "at most 4200000 heights");
  EXPECT_TRUE(notes(import_model_text(field_model("nrow='2' ncol='2' size='1 1 1 1'"), "m.xml"),
                    "m.xml:2: <hfield> whose heights a program sets later: it is flat"));
  EXPECT_TRUE(notes(import_model_text(field_model("file='none.png' size='1 1 1 1'"), "m.xml"),
                    "m.xml:3: <geom>: its shape is left out: m.xml:2: height field: there is no such file"));
}

std::string sdf_collision(const std::string& geometry) {
  return "<sdf version='1.12'><model name='m'><static>true</static><link name='l'><collision name='c'>\n"
         "<pose>1 2 3 0 0 0</pose><geometry>" +
         geometry + "</geometry></collision></link></model></sdf>";
}

TEST(ImportFields, AHeightmapOfSdf) {
  std::ofstream(testing::temporary("map.png"), std::ios::binary) << from_base64(kGrey).value();
  const ImportedModel model = import_model_text(
      sdf_collision("<heightmap><uri>file://map.png</uri><size>6 4 10.2</size><pos>0 0 -4</pos></heightmap>"),
      testing::temporary("m.sdf"));
  EXPECT_TRUE(notes(model, "m.sdf:2: <heightmap>: all that is below it is solid"));
  const Scene scene = parse_scene(model.document.dump(), "m.sdf");
  const ShapeRecord& record = scene.world.shape(ShapeId{0});
  const auto& field = std::get<HeightField>(*record.shape);
  EXPECT_NEAR(field.dx, 2, 1e-15);
  EXPECT_NEAR(field.dy, 1, 1e-15);
  EXPECT_NEAR(field.heights[0], 3 * 0.04, 1e-14);    // the last row; 255 is 10.2 m
  EXPECT_NEAR(field.heights[18], 30 * 0.04, 1e-14);  // the first
  EXPECT_LT((record.pose.p - Vec3(1, 2, -1)).norm(), 1e-14);
  EXPECT_TRUE(notes(import_model_text(sdf_collision("<heightmap><uri>a.tif</uri></heightmap>"), "m.sdf"),
                    "its shape is left out: height field: there is no such file (value: a.tif)"));
}

/// As Drake calls them.
TEST(ImportFields, ShapesOfDrake) {
  const auto shape_of = [](const ImportedModel& model) {
    const Scene scene = parse_scene(model.document.dump(), "m");
    return *scene.world.shape(ShapeId{0}).shape;
  };
  const auto urdf = [](const std::string& geometry) {
    return import_model_text("<robot name='r'><link name='world'><collision><geometry>" + geometry +
                                 "</geometry></collision></link></robot>",
                             "r.urdf");
  };
  Shape shape = shape_of(urdf("<drake:ellipsoid a='1' b='2' c='3'/>"));
  EXPECT_EQ(std::get<Ellipsoid>(shape).radii, Vec3(1, 2, 3));
  shape = shape_of(urdf("<drake:capsule radius='1' length='2'/>"));
  EXPECT_EQ(std::get<Capsule>(shape).length, 2);
  const auto sdf = [](const std::string& geometry) {
    return import_model_text(sdf_collision(geometry), "m.sdf");
  };
  shape = shape_of(sdf("<drake:ellipsoid><a>1</a><b>2</b><c>3</c></drake:ellipsoid>"));
  EXPECT_EQ(std::get<Ellipsoid>(shape).radii, Vec3(1, 2, 3));
  shape = shape_of(sdf("<drake:capsule><radius>1</radius><length>2</length></drake:capsule>"));
  EXPECT_EQ(std::get<Capsule>(shape).length, 2);
  testing::expect_refused([&] { return urdf("<cube size='1 1 1'/>"); }, "did you mean \"box\"?");
  testing::expect_refused([&] { return urdf("<shpere radius='1'/>"); }, "did you mean \"sphere\"?");
}

/// Its frame is in the middle between base and apex.
TEST(ImportFields, AConeOfSdf) {
  const ImportedModel model =
      import_model_text(sdf_collision("<cone><radius>0.5</radius><length>2</length></cone>"), "m.sdf");
  const Scene scene = parse_scene(model.document.dump(), "m.sdf");
  const ShapeRecord& record = scene.world.shape(ShapeId{0});
  const auto& cone = std::get<Cone>(*record.shape);
  EXPECT_EQ(cone.radius, 0.5);
  EXPECT_EQ(cone.height, 2);
  // The apex is 3/4 of the height above the origin of the shape.
  EXPECT_LT((record.pose.point(Vec3(0, 0, 1.5)) - Vec3(1, 2, 4)).norm(), 1e-14);
}

}  // namespace
}  // namespace taut::field_test
