#include <functional>
#include <limits>
#include <string>

#include "core/joints/joints.h"
#include "core/world/world.h"
#include "tests/core/expect_invalid.h"

// What users may give a World by mistake: ids that are not there, and numbers that are too large for
// anything.
namespace taut::robust_world_test {
namespace {

using testing::expect_invalid;

World small_world() {
  World world;
  const BodyId a = world.add_body({.name = "a"}), b = world.add_body({.name = "b"});
  world.add("hinge", Hinge::at(world, a, b, Vec3::Zero(), Vec3::UnitZ()));
  world.add_force(PointForce(a, Vec3::Zero(), Vec3::UnitX()));
  world.add_shape(a, Sphere{0.1});
  world.add_material("steel", {});
  return world;
}

/// A function of World that takes an id, asked with this index; what its message must say.
template <typename World>
struct Question {
  std::string name, part;
  std::function<void(World&, int)> ask;
};

TEST(RobustIds, EveryFunctionRefusesAnIdThatIsNotThere) {
  const auto body = [](int i) { return BodyId{i}; };
  const auto axis_of = [](int i) { return AxisId{{i}, 0}; };
  const AxisId good_joint{{0}, 0};
  const std::vector<Question<World>> questions = {
      {"mass_properties", "no such body", [&](World& w, int i) { (void)w.mass_properties(body(i)); }},
      {"is_fixed", "no such body", [&](World& w, int i) { (void)w.is_fixed(body(i)); }},
      {"name of body", "no such body", [&](World& w, int i) { (void)w.name(body(i)); }},
      {"pose", "no such body", [&](World& w, int i) { (void)w.pose(body(i)); }},
      {"twist", "no such body", [&](World& w, int i) { (void)w.twist(body(i)); }},
      {"set_pose", "no such body", [&](World& w, int i) { w.set_pose(body(i), {}); }},
      {"set_twist", "no such body", [&](World& w, int i) { w.set_twist(body(i), {}); }},
      {"is_asleep", "no such body", [&](World& w, int i) { (void)w.is_asleep(body(i)); }},
      {"wake_count", "no such body", [&](World& w, int i) { (void)w.wake_count(body(i)); }},
      {"moves", "no such body", [&](World& w, int i) { (void)w.moves(body(i)); }},
      {"wake", "no such body", [&](World& w, int i) { w.wake(body(i)); }},
      {"add_shape", "no such body", [&](World& w, int i) { w.add_shape(body(i), Sphere{1}); }},
      {"set_collision, first", "no such body", [&](World& w, int i) { w.set_collision(body(i), {1}, true); }},
      {"set_collision, second", "no such body",
       [&](World& w, int i) { w.set_collision({1}, body(i), true); }},
      {"set_collision, both", "no such body",
       [&](World& w, int i) { w.set_collision(body(i), body(i), true); }},
      {"may_collide, first", "no such body", [&](World& w, int i) { (void)w.may_collide(body(i), {1}); }},
      {"may_collide, second", "no such body", [&](World& w, int i) { (void)w.may_collide({1}, body(i)); }},
      {"may_collide, both", "no such body", [&](World& w, int i) { (void)w.may_collide(body(i), body(i)); }},
      {"add", "no such body",
       [&](World& w, int i) { w.add("", Ball({1}, body(i), Vec3::Zero(), Vec3::Zero())); }},
      {"Ball::at", "no such body", [&](World& w, int i) { Ball::at(w, {1}, body(i), Vec3::Zero()); }},
      {"add_force", "no such body",
       [&](World& w, int i) { w.add_force(PointForce(body(i), Vec3::Zero(), Vec3::UnitX())); }},
      {"set_force, its body", "no such body",
       [&](World& w, int i) {
         w.set_force({0}, std::make_shared<PointForce>(body(i), Vec3::Zero(), Vec3::UnitX()));
       }},

      {"name of joint", "no such joint", [](World& w, int i) { (void)w.name(JointId{i}); }},
      {"joint", "no such joint", [](World& w, int i) { (void)w.joint(JointId{i}); }},
      {"set_break", "no such joint", [](World& w, int i) { w.set_break({i}, BreakLimits{.force = 1}); }},
      {"set_break, none", "no such joint", [](World& w, int i) { w.set_break({i}, {}); }},
      {"set_compliance", "no such joint", [](World& w, int i) { w.set_compliance({i}, JointCompliance{}); }},
      {"set_compliance, none", "no such joint", [](World& w, int i) { w.set_compliance({i}, {}); }},
      {"compliance", "no such joint", [](World& w, int i) { (void)w.compliance({i}); }},
      {"detach", "no such joint", [](World& w, int i) { w.detach({i}); }},
      {"detach_all_but", "no such joint",
       [](World& w, int i) {
         w.detach_all_but(std::vector<JointId>{{0}, {i}});
       }},
      {"attach", "no such joint", [](World& w, int i) { w.attach({i}); }},
      {"is_attached", "no such joint", [](World& w, int i) { (void)w.is_attached({i}); }},
      {"spring_energy_of", "no such joint",
       [](World& w, int i) { (void)w.spring_energy_of({i}, w.state()); }},
      {"axis", "no such joint", [](World& w, int i) { (void)w.axis({i}, "angle"); }},
      {"axis_count", "no such joint", [](World& w, int i) { (void)w.axis_count({i}); }},
      {"has_axis_properties", "no such joint", [](World& w, int i) { (void)w.has_axis_properties({i}); }},

      {"force", "no such force", [](World& w, int i) { (void)w.force(ForceId{i}); }},
      {"set_force", "no such force",
       [](World& w, int i) {
         w.set_force({i}, std::make_shared<PointForce>(BodyId{1}, Vec3::Zero(), Vec3::UnitX()));
       }},

      {"shape", "no such shape", [](World& w, int i) { (void)w.shape({i}); }},
      {"set_material", "no such shape", [](World& w, int i) { w.set_material({i}, Material{}); }},
      {"set_material by name", "no such shape", [](World& w, int i) { w.set_material({i}, MaterialId{0}); }},
      {"set_contact_material, first", "no such shape",
       [](World& w, int i) { w.set_contact_material(ShapeId{i}, ShapeId{0}, {}); }},
      {"set_contact_material, second", "no such shape",
       [](World& w, int i) { w.set_contact_material(ShapeId{0}, ShapeId{i}, {}); }},
      {"contact_material, first", "no such shape",
       [](World& w, int i) { (void)w.contact_material({i}, {0}); }},
      {"contact_material, second", "no such shape",
       [](World& w, int i) { (void)w.contact_material({0}, {i}); }},
      {"may_collide of shapes, first", "no such shape",
       [](World& w, int i) { (void)w.may_collide(ShapeId{i}, ShapeId{0}); }},
      {"may_collide of shapes, second", "no such shape",
       [](World& w, int i) { (void)w.may_collide(ShapeId{0}, ShapeId{i}); }},
      {"may_collide of shapes, both", "no such shape",
       [](World& w, int i) { (void)w.may_collide(ShapeId{i}, ShapeId{i}); }},

      {"material", "no such material", [](World& w, int i) { (void)w.material(MaterialId{i}); }},
      {"name of material", "no such material", [](World& w, int i) { (void)w.name(MaterialId{i}); }},
      {"set_material to", "no such material", [](World& w, int i) { w.set_material({0}, MaterialId{i}); }},
      {"set_contact_material of materials, first", "no such material",
       [](World& w, int i) { w.set_contact_material(MaterialId{i}, MaterialId{0}, {}); }},
      {"set_contact_material of materials, second", "no such material",
       [](World& w, int i) { w.set_contact_material(MaterialId{0}, MaterialId{i}, {}); }},

      {"axis_info", "no such joint", [&](World& w, int i) { (void)w.axis_info(axis_of(i)); }},
      {"axis_info, axis", "no such axis",
       [](World& w, int i) {
         (void)w.axis_info({{0}, i});
       }},
      {"axis_index", "no such axis",
       [](World& w, int i) {
         (void)w.axis_index({{0}, i});
       }},
      {"axis_properties", "no such axis",
       [](World& w, int i) {
         (void)w.axis_properties({{0}, i});
       }},
      {"axis_label", "no such axis",
       [](World& w, int i) {
         (void)w.axis_label({{0}, i});
       }},
      {"set_limits", "no such axis",
       [](World& w, int i) {
         w.set_limits({{0}, i}, AxisLimits{-1, 1});
       }},
      {"set_limits, none", "no such axis",
       [](World& w, int i) {
         w.set_limits({{0}, i}, {});
       }},
      {"set_motor", "no such axis",
       [](World& w, int i) {
         w.set_motor({{0}, i}, AxisMotor{});
       }},
      {"set_motor, none", "no such axis",
       [](World& w, int i) {
         w.set_motor({{0}, i}, {});
       }},
      {"set_friction", "no such axis",
       [](World& w, int i) {
         w.set_friction({{0}, i}, AxisFriction{});
       }},
      {"set_spring", "no such axis",
       [](World& w, int i) {
         w.set_spring({{0}, i}, AxisSpring{});
       }},
      {"set_motor_target", "no such axis",
       [](World& w, int i) {
         w.set_motor_target({{0}, i}, 1);
       }},
      {"axis_value", "no such axis",
       [](World& w, int i) {
         (void)w.axis_value({{0}, i});
       }},
      {"axis_rate", "no such axis",
       [](World& w, int i) {
         (void)w.axis_rate({{0}, i});
       }},
      {"set_axis_turns", "no such axis",
       [](World& w, int i) {
         w.set_axis_turns({{0}, i}, 1);
       }},
      {"set_limits, joint", "no such joint", [&](World& w, int i) { w.set_limits(axis_of(i), {}); }},
      {"Gear", "no such axis",
       [&](World& w, int i) {
         w.add("", Gear(w, good_joint, {{0}, i}, 2));
       }},
  };
  constexpr int kLowest = std::numeric_limits<int>::min(), kHighest = std::numeric_limits<int>::max();
  for (const Question<World>& question : questions)
    for (const int index : {-1, 3, 99, kLowest, kHighest}) {
      SCOPED_TRACE(question.name + " of " + std::to_string(index));
      World world = small_world();
      const int topology = world.topology_version(), state = world.state_version();
      expect_invalid([&] { question.ask(world, index); }, {question.part.c_str()});
      EXPECT_EQ(world.topology_version(), topology);
      EXPECT_EQ(world.state_version(), state);
    }
}

TEST(RobustReach, NumbersBeyondAllReasonAreRefusedByName) {
  World world = small_world();
  const BodyId a{1};
  const Vec3 far(0, 1e155, 0), last(0, 1e30, 0);
  expect_invalid(
      [&] {
        world.add_body({.name = "c", .pose = {Quat::Identity(), far}});
      },
      {"position of c", "1e30", "1e+155"});
  expect_invalid([&] { world.add_body({.name = "c", .twist = {Vec3::Zero(), far}}); }, {"velocity of c"});
  expect_invalid(
      [&] {
        world.add_body({.name = "c", .twist = {far, Vec3::Zero()}});
      },
      {"angular velocity of c"});
  expect_invalid([&] { world.set_pose(a, {Quat::Identity(), far}); }, {"position of a", "1e+155"});
  expect_invalid([&] { world.set_twist(a, {far, far}); }, {"angular velocity of a", "1e+155"});
  State state = world.state();
  state.poses[1].p = far;
  expect_invalid([&] { world.set_state(state); }, {"position of a", "1e+155"});
  state = world.state();
  state.twists[1].v = -far;
  expect_invalid([&] { world.set_state(state); }, {"velocity of a", "1e+155"});
  expect_invalid(
      [&] {
        world.add_shape(a, Sphere{0.1}, {Quat::Identity(), far});
      },
      {"position of shape of a", "1e+155"});
  EXPECT_EQ(world.body_count(), 3);
  EXPECT_EQ(world.shape_count(), 1);
  // At the bound itself all is well.
  world.add_body({.pose = {Quat::Identity(), last}, .twist = {last, last}});
  world.set_pose(a, {Quat::Identity(), last});
  world.set_state(world.state());
}

TEST(RobustReach, ShapesBeyondAllReasonAreRefusedByName) {
  constexpr double kHuge = 1e31;
  const std::vector<std::pair<Shape, const char*>> shapes = {
      {Sphere{kHuge}, "sphere radius"},
      {Box{Vec3(1, kHuge, 1)}, "box size"},
      {Capsule{kHuge, 1}, "capsule radius"},
      {Capsule{1, kHuge}, "capsule length"},
      {Cylinder{1, kHuge}, "cylinder length"},
      {Cone{kHuge, 1}, "cone radius"},
      {Ellipsoid{Vec3(1, 1, kHuge)}, "ellipsoid radii"},
      {ConvexHull{{Vec3(0, 0, 0), Vec3(kHuge, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}}, "convex hull point 1"},
      {TriangleMesh{{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, kHuge, 0)}, {{0, 1, 2}}},
       "triangle mesh vertex 2"},
      {HeightField{2, 2, kHuge, 1, {0, 0, 0, 0}}, "height field dx"},
      {HeightField{2, 2, 1, 1, {0, 0, kHuge, 0}}, "height field height 2"},
  };
  expect_invalid([] { check_shape(Sphere{1e-300}); }, {"sphere radius", "1e-30", "e-300"});
  expect_invalid([] { check_shape(Ellipsoid{Vec3(1, 1, 1e-160)}); }, {"ellipsoid radii", "1e-30", "e-161"});
  for (const auto& [shape, name] : shapes)
    expect_invalid([&shape = shape] { check_shape(shape); }, {name, "1e30", "e+30"});
}

}  // namespace
}  // namespace taut::robust_world_test
