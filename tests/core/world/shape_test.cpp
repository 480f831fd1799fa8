#include "core/world/shape.h"

#include <limits>

#include "core/joints/joints.h"
#include "core/world/world.h"
#include "tests/core/expect_invalid.h"
#include "tests/core/random_state.h"

namespace taut::shape_test {
namespace {

using testing::expect_invalid;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Shape, WrongSizesAreNamedWithTheirValue) {
  const auto expect_bad = [](const Shape& shape, std::initializer_list<const char*> parts) {
    expect_invalid([&] { check_shape(shape); }, parts);
  };
  expect_bad(Sphere{0}, {"sphere radius", "0"});
  expect_bad(Sphere{kNan}, {"sphere radius", "nan"});
  expect_bad(Box{Vec3(1, -2, 3)}, {"box size", "-2"});
  expect_bad(Box{Vec3(1, kInfinity, 3)}, {"box size", "inf"});
  expect_bad(Capsule{-1, 1}, {"capsule radius", "-1"});
  expect_bad(Capsule{1, -1}, {"capsule length", "-1"});
  expect_bad(Cylinder{1, 0}, {"cylinder length", "0"});
  expect_bad(Cylinder{0, 1}, {"cylinder radius", "0"});
  expect_bad(Ellipsoid{Vec3(1, 1, 0)}, {"ellipsoid radii", "0"});
  expect_bad(Cone{1, -3}, {"cone height", "-3"});
  expect_bad(HeightField{1, 2, 1, 1, {0, 0}}, {"height field nx", "1"});
  expect_bad(HeightField{2, 2, 1, 1, {0, 0, 0}}, {"height field", "nx·ny", "3"});
  expect_bad(HeightField{2, 2, 0, 1, {0, 0, 0, 0}}, {"height field dx", "0"});
  expect_bad(HeightField{2, 2, 1, 1, {0, 0, kNan, 0}}, {"height field height 2", "nan"});
  EXPECT_NO_THROW(check_shape(Capsule{1, 0}));
  EXPECT_NO_THROW(check_shape(HalfSpace{}));
}

TEST(Shape, DegenerateMeshesAndHullsAreRefused) {
  const std::vector<Vec3> square{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)};
  expect_invalid([&] { check_shape(ConvexHull{square}); }, {"hull without volume"});
  expect_invalid([] { check_shape(ConvexHull{{Vec3::Zero(), Vec3::UnitX()}}); }, {"four points", "2"});
  expect_invalid([] { check_shape(ConvexHull{std::vector<Vec3>(9, Vec3(1, 2, 3))}); },
                 {"hull without volume"});
  expect_invalid([] { check_shape(ConvexHull{std::vector<Vec3>(9, Vec3(1, kNan, 3))}); },
                 {"convex hull point 0", "nan"});
  expect_invalid([] { check_shape(TriangleMesh{}); }, {"no triangles"});
  expect_invalid(
      [&] {
        check_shape(TriangleMesh{square, {{0, 1, 4}}});
      },
      {"triangle 0", "no such vertex", "4"});
  expect_invalid([&] { check_shape(TriangleMesh{square, {{0, 1, -1}}}); }, {"no such vertex", "-1"});
  expect_invalid(
      [&] {
        check_shape(TriangleMesh{square, {{0, 1, 2}, {0, 1, 1}}});
      },
      {"triangle 1", "no area"});
  std::vector<Vec3> broken = square;
  broken[3].z() = kNan;
  expect_invalid([&] { check_shape(TriangleMesh{broken, {{0, 1, 2}}}); }, {"vertex 3", "nan"});
}

TEST(Material, Combination) {
  const Material ice{.restitution = 0.1,
                     .static_friction = 0.04,
                     .dynamic_friction = 0.01,
                     .rolling_friction = 0.001,
                     .compliance = 1e-6,
                     .spinning_friction_linear = 0.003},
      rubber{.restitution = 0.8,
             .static_friction = 1,
             .dynamic_friction = 0.81,
             .spinning_friction = 0.02,
             .compliance = 2e-5,
             .rolling_friction_linear = 0.004,
             .spinning_friction_linear = 0.001};
  const Material both = combined(ice, rubber);
  EXPECT_EQ(both, combined(rubber, ice));
  EXPECT_EQ(both.restitution, 0.1);
  EXPECT_DOUBLE_EQ(both.static_friction, 0.2);
  EXPECT_DOUBLE_EQ(both.dynamic_friction, 0.09);
  EXPECT_EQ(both.rolling_friction, 0.001);
  EXPECT_EQ(both.spinning_friction, 0.02);
  EXPECT_DOUBLE_EQ(both.compliance, 2.1e-5);
  EXPECT_EQ(both.rolling_friction_linear, 0.004);
  EXPECT_EQ(both.spinning_friction_linear, 0.003);
  EXPECT_EQ(combined(rubber, rubber).static_friction, 1);
}

TEST(Material, BadValues) {
  expect_invalid([] { check_material({.restitution = 1.1}); }, {"restitution", "1.1"});
  expect_invalid([] { check_material({.restitution = -0.1}); }, {"restitution", "-0.1"});
  expect_invalid([] { check_material({.static_friction = 0.1, .dynamic_friction = 0.2}); },
                 {"static friction", "0.1"});
  expect_invalid([] { check_material({.static_friction = kNan}); }, {"static friction", "nan"});
  expect_invalid([] { check_material({.rolling_friction = -1}); }, {"rolling friction", "-1"});
  expect_invalid([] { check_material({.spinning_friction = kInfinity}); }, {"spinning friction", "inf"});
  expect_invalid([] { check_material({.compliance = -1}); }, {"compliance", "-1"});
  for (const auto& [bad, text] : {std::pair(-0.5, "-0.5"), {kNan, "nan"}, {kInfinity, "inf"}}) {
    expect_invalid([value = bad] { check_material({.rolling_friction_linear = value}); },
                   {"linear rolling friction", text});
    expect_invalid([value = bad] { check_material({.spinning_friction_linear = value}); },
                   {"linear spinning friction", text});
  }
}

TEST(WorldShapes, AreCheckedAndKept) {
  World world;
  const BodyId body = world.add_body({.name = "crate"});
  const int topology = world.topology_version(), geometry = world.geometry_version();
  const Pose X{exp_so3(Vec3(0.1, 0.2, 0.3)), Vec3(1, 2, 3)};
  const ShapeId box = world.add_shape(body, Box{Vec3(1, 1, 1)}, X, {.restitution = 0.3}, {2, 5});
  const ShapeId ball = world.add_shape(kGround, Sphere{1});
  EXPECT_EQ(world.topology_version(), topology);
  EXPECT_NE(world.geometry_version(), geometry);
  EXPECT_EQ(world.shape_count(), 2);
  EXPECT_EQ(world.shape(box).body, body);
  EXPECT_EQ(world.shape(box).pose.p, X.p);
  EXPECT_EQ(world.shape(box).filter.mask, 5u);
  EXPECT_STREQ(shape_name(*world.shape(box).shape), "box");
  EXPECT_EQ(world.contact_material(box, ball), combined({.restitution = 0.3}, {}));
  world.set_contact_material(ball, box, {.restitution = 0.9});
  EXPECT_EQ(world.contact_material(box, ball).restitution, 0.9);
  world.set_material(ball, {.restitution = 0.5});
  EXPECT_EQ(world.shape(ball).material.restitution, 0.5);

  expect_invalid([&] { world.add_shape({7}, Sphere{1}); }, {"body", "7"});
  expect_invalid([&] { world.add_shape(body, Sphere{-1}); }, {"sphere radius", "-1"});
  expect_invalid([&] { world.add_shape(body, std::shared_ptr<const Shape>()); }, {"crate", "null"});
  expect_invalid(
      [&] {
        world.add_shape(body, Sphere{1}, {Quat(2, 0, 0, 0), Vec3::Zero()});
      },
      {"orientation of shape of crate"});
  expect_invalid(
      [&] {
        world.add_shape(body, Sphere{1}, {Quat::Identity(), Vec3(kNan, 0, 0)});
      },
      {"position of shape of crate"});
  expect_invalid([&] { world.add_shape(body, Sphere{1}, {}, {.restitution = 2}); }, {"restitution", "2"});
  expect_invalid([&] { world.shape({2}); }, {"shape id", "2"});
  expect_invalid([&] { world.set_contact_material(box, {-1}, {}); }, {"shape id", "-1"});
  expect_invalid([&] { world.set_collision(body, body, false); }, {"crate", "itself"});
  EXPECT_EQ(world.shape_count(), 2);
}

TEST(WorldShapes, PairsOfNamedMaterials) {
  World world;
  const BodyId body = world.add_body({.name = "crate"});
  const MaterialId ice = world.add_material("ice", {.static_friction = 0.1, .dynamic_friction = 0.1}),
                   rubber = world.add_material("rubber", {.restitution = 0.8});
  const ShapeId floor = world.add_shape(kGround, HalfSpace{}), sole = world.add_shape(body, Sphere{1}),
                heel = world.add_shape(body, Sphere{1});
  world.set_material(floor, ice);
  world.set_material(sole, rubber);
  world.set_material(heel, rubber);
  EXPECT_EQ(world.shape(floor).material, world.material(ice));
  EXPECT_EQ(world.contact_material(floor, sole), combined(world.material(ice), world.material(rubber)));
  world.set_contact_material(rubber, ice, {.restitution = 0.25});
  EXPECT_EQ(world.contact_material(floor, sole).restitution, 0.25);
  EXPECT_EQ(world.contact_material(sole, floor).restitution, 0.25);
  EXPECT_EQ(world.contact_material(sole, heel).restitution, 0.8);
  world.set_contact_material(rubber, rubber, {.restitution = 0.9});
  EXPECT_EQ(world.contact_material(sole, heel).restitution, 0.9);
  world.set_contact_material(floor, heel, {.restitution = 0.5});  // what is said of shapes wins
  EXPECT_EQ(world.contact_material(floor, heel).restitution, 0.5);
  EXPECT_EQ(world.contact_material(floor, sole).restitution, 0.25);

  World whole;
  whole.add_material("ice", {});
  const Relocation to = whole.append(world, "part/");
  EXPECT_EQ(whole.contact_material(to(floor), to(sole)).restitution, 0.25);
  EXPECT_EQ(whole.name(whole.shape(to(sole)).named), "part/rubber");
  world.set_material(sole, Material{.restitution = 0.8});  // the same values without the name
  EXPECT_EQ(world.contact_material(floor, sole), combined(world.material(ice), {.restitution = 0.8}));

  EXPECT_EQ(world.material("rubber"), rubber);
  expect_invalid([&] { world.material("tar"); }, {"material", "none of this name", "tar"});
  expect_invalid([&] { world.add_material("ice", {}); }, {"material", "already taken", "ice"});
  expect_invalid([&] { world.add_material("", {}); }, {"material", "must have a name"});
  expect_invalid([&] { world.add_material("tar", {.restitution = 2}); }, {"restitution", "2"});
  expect_invalid([&] { world.set_material(sole, MaterialId{7}); }, {"material id", "7"});
  expect_invalid([&] { world.set_contact_material(ice, MaterialId{}, {}); }, {"material id", "-1"});
  World clash;
  clash.add_material("part/ice", {});
  expect_invalid([&] { clash.append(world, "part/"); }, {"material", "already taken", "part/ice"});
}

TEST(WorldShapes, WhoMayCollide) {
  World world;
  const BodyId a = world.add_body({}), b = world.add_body({.pose = {Quat::Identity(), Vec3(1, 0, 0)}}),
               post = world.add_body({.fixed = true});
  EXPECT_TRUE(world.may_collide(a, b));
  EXPECT_FALSE(world.may_collide(a, a));
  EXPECT_TRUE(world.may_collide(a, kGround));
  EXPECT_FALSE(world.may_collide(post, kGround));
  world.add("pin", Ball::at(world, b, a, Vec3(0.5, 0, 0)));
  EXPECT_FALSE(world.may_collide(a, b));
  const World copy = world;
  world.set_collision(a, b, true);
  EXPECT_TRUE(world.may_collide(b, a));
  EXPECT_FALSE(copy.may_collide(b, a));
}

}  // namespace
}  // namespace taut::shape_test
