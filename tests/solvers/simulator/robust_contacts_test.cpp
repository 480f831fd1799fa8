#include <chrono>
#include <limits>
#include <string>

#include "core/joints/joints.h"
#include "solvers/diagnosis/start_checks.h"
#include "solvers/simulator/simulator.h"
#include "tests/core/expect_invalid.h"

// Steps whose contacts cannot be had: a status or a mark in the report says so, by name.
namespace taut::robust_contacts_test {
namespace {

using testing::expect_invalid;

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string numbered(int i) { return std::string("b").append(std::to_string(i)); }

void add_ball(World& world, const std::string& name, const Vec3& p, const Vec3& v = Vec3::Zero()) {
  const BodyId ball = world.add_body({.name = name,
                                      .mass = MassProperties::sphere(0.1, 1),
                                      .pose = {Quat::Identity(), p},
                                      .twist = {Vec3::Zero(), v}});
  world.add_shape(ball, Sphere{0.1});
}

TEST(RobustIds, SimulatorRefusesIdsThatAreNotThere) {
  World world;
  const BodyId a = world.add_body({.name = "a"});
  world.add("hinge", Hinge::at(world, kGround, a, Vec3::Zero(), Vec3::UnitX()));
  Simulator simulator(world);
  ASSERT_TRUE(simulator.step(1e-3).exact());
  for (const int i : {-1, 1, 99, std::numeric_limits<int>::min(), std::numeric_limits<int>::max()}) {
    expect_invalid([&] { (void)simulator.mean_reaction({i}); }, {"no such joint"});
    expect_invalid([&] { (void)simulator.reaction({i}); }, {"no such joint"});
    expect_invalid([&] { (void)simulator.axis_report({{i}, 0}); }, {"no such joint"});
    expect_invalid([&] { (void)simulator.axis_report({{0}, i}); }, {"no such axis"});
    expect_invalid([&] { simulator.set_contact_stretches({{.a = {i}, .b = {0}}}); }, {"no such shape"});
  }
  EXPECT_TRUE(simulator.step(1e-3).exact());
}

TEST(RobustCrowd, AStepWithTooManyContactsIsNotDoneAndSaysWhere) {
  for (const Integrator integrator : {Integrator::kRattle, Integrator::kMoreauJean}) {
    World world;
    for (int i = 0; i < 300; ++i) add_ball(world, numbered(i), Vec3::Zero());
    Simulator simulator(world, {.integrator = integrator});
    const State before = world.state();
    const auto start = std::chrono::steady_clock::now();
    const StepReport& report = simulator.step(1.0 / 240);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    EXPECT_LT(seconds.count(), 10);  // some 10 ms
    EXPECT_EQ(report.status, Status::kCrowded);
    EXPECT_EQ(to_string(report.status), "crowded");
    EXPECT_EQ(report.crowd.most, 25000);
    ASSERT_EQ(report.crowd.shapes.size(), 4u);
    const std::string& first = world.name(world.shape(report.crowd.shapes[0]).body);
    for (const std::string part : {"25000", "max_contacts", first.c_str()})
      EXPECT_TRUE(has(report.message, part)) << report.message;
    EXPECT_EQ(world.state().poses[1].p, before.poses[1].p);
    EXPECT_EQ(world.time(), 0);
    // It goes on when the heap is taken apart.
    State apart = before;
    for (int b = 1; b < world.body_count(); ++b) apart.poses[b].p.x() = b;
    world.set_state(apart);
    EXPECT_TRUE(simulator.step(1.0 / 240).exact()) << simulator.report().message;
    EXPECT_TRUE(simulator.report().crowd.empty());
  }
}

TEST(RobustCrowd, ACrowdThatComesTogetherInAStepEndsItBeforeItsStart) {
  // Two balls that come nearer to each other than the bound of none allows, in the middle of a run.
  for (const Integrator integrator : {Integrator::kRattle, Integrator::kMoreauJean}) {
    World world;
    world.set_gravity(Vec3::Zero());
    for (int i = 0; i < 3; ++i) add_ball(world, numbered(i), Vec3(i, 0, 0), Vec3(1 - i, 0, 0));
    Simulator simulator(world, {.integrator = integrator, .max_contacts = 1});
    int steps = 0;
    State before;
    do before = world.state();
    while (simulator.step(0.01).exact() && ++steps < 200);
    EXPECT_GT(steps, 70);
    EXPECT_EQ(simulator.report().status, Status::kCrowded) << simulator.report().message;
    for (int b = 1; b < 4; ++b) {
      EXPECT_EQ(world.state().poses[b].p, before.poses[b].p);
      EXPECT_EQ(world.state().twists[b].v, before.twists[b].v);
    }
    // The bound is a setting: another simulator takes it from here.
    Simulator other(world, {.integrator = integrator});
    for (int i = 0; i < 50; ++i) ASSERT_TRUE(other.step(0.01).exact()) << other.report().message;
  }
}

TEST(RobustReach, ABodyThatFliesBeyondAllReasonEndsTheStepByName) {
  for (const Integrator integrator : {Integrator::kRattle, Integrator::kRattle4, Integrator::kMoreauJean,
                                      Integrator::kForceEuler, Integrator::kForceRungeKutta})
    for (const bool shapes : {false, true}) {
      if (shapes && integrator != Integrator::kRattle && integrator != Integrator::kMoreauJean) continue;
      World world;
      for (const char* name : {"near", "flier", "other"}) {
        const BodyId body = world.add_body({.name = name, .mass = MassProperties::sphere(0.1, 1)});
        world.set_pose(body, {Quat::Identity(), Vec3(10 * body.index, 0, 0)});
        if (shapes) world.add_shape(body, Sphere{0.1});
      }
      world.set_twist(world.body("flier"), {Vec3::Zero(), Vec3(0, 0.9e30, 0)});
      Simulator simulator(world, {.integrator = integrator});
      int steps = 0;
      while (simulator.step(0.4).exact() && ++steps < 10) {
      }
      const StepReport& report = simulator.report();
      EXPECT_EQ(report.status, Status::kNotFinite) << static_cast<int>(integrator) << report.message;
      EXPECT_LT(steps, 10);
      EXPECT_TRUE(has(report.message, "flier") || !shapes) << report.message;
    }
}

TEST(RobustReach, ALightBodyUnderAGreatForceEndsTheStep) {
  World world;
  const BodyId dust = world.add_body({.name = "dust", .mass = {1e-300, Vec3(1e-300, 1e-300, 1e-300)}});
  add_ball(world, "ball", Vec3(1, 0, 0));
  world.add_shape(dust, Sphere{0.1});
  world.add_force(PointForce(dust, Vec3::Zero(), Vec3(1, 0, 0)));
  Simulator simulator(world);
  const StepReport& report = simulator.step(0.01);
  EXPECT_EQ(report.status, Status::kNotFinite);
  EXPECT_TRUE(has(report.message, "dust")) << report.message;
  EXPECT_EQ(world.pose(dust).p, Vec3(Vec3::Zero()));
}

TEST(RobustReach, AMassWithoutAnInverseEndsTheStep) {
  World world;
  const BodyId a = world.add_body({.name = "a"});
  world.add_body({.name = "dust", .mass = {1e-310, Vec3(1, 1, 1)}});
  world.add("joint", Ball(kGround, a, Vec3(1, 0, 0), Vec3::Zero()));  // open: it is closed at the start
  Simulator simulator(world);
  EXPECT_FALSE(simulator.step(0.01).exact());
  EXPECT_FALSE(simulator.report().message.empty());
  EXPECT_EQ(world.pose(a).p, Vec3(Vec3::Zero()));
}

Shape cube() {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back(0.1 * Vec3(i & 4 ? 1 : -1, i & 2 ? 1 : -1, i & 1 ? 1 : -1));
  mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5}, {0, 5, 1},
                    {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
  return mesh;
}

TEST(RobustPairs, ShapesThatPassThroughEachOtherAreNamedWhenTheyMeet) {
  World world;
  const BodyId low = world.add_body({.name = "low", .fixed = true}),
               up = world.add_body({.name = "up",
                                    .mass = MassProperties::box(Vec3(0.2, 0.2, 0.2), 8),
                                    .pose = {Quat::Identity(), Vec3(0, 0, 0.6)}});
  const ShapeId a = world.add_shape(low, cube()), b = world.add_shape(up, cube());
  const UnsupportedPairs all = unsupported_pairs(world);
  EXPECT_EQ(all.count, 1);
  ASSERT_EQ(all.first.size(), 1u);
  EXPECT_EQ(all.first[0], std::pair(a, b));
  Simulator simulator(world);
  ASSERT_TRUE(simulator.step(0.01).exact());
  EXPECT_EQ(simulator.report().unsupported_pairs, 0);
  int met = 0;
  for (int i = 0; i < 60; ++i) {
    const StepReport& report = simulator.step(0.01);
    ASSERT_TRUE(report.exact());
    if (report.unsupported_pairs == 0) continue;
    ++met;
    ASSERT_EQ(report.unsupported.size(), 1u);
    EXPECT_EQ(report.unsupported[0], std::pair(a, b));
    EXPECT_EQ(name_of(report.unsupported[0], world), "triangle_mesh of low and triangle_mesh of up");
  }
  EXPECT_GT(met, 3);
  EXPECT_LT(world.pose(up).p.z(), -0.3);
  EXPECT_EQ(simulator.report().unsupported_pairs, 0);  // it is through
  world.set_collision(low, up, false);
  EXPECT_EQ(unsupported_pairs(world).count, 0);
}

TEST(RobustThreads, SettingsBoundTheirNumber) {
  World world;
  add_ball(world, "", Vec3::Zero());
  expect_invalid([&] { Simulator(world, {.threads = 1000000}); }, {"settings threads", "1024", "1000000"});
  expect_invalid([&] { Simulator(world, {.max_contacts = -5}); }, {"settings max_contacts", "-5"});
}

TEST(RobustCrowd, StartChecksTellIt) {
  World world;
  for (int i = 0; i < 300; ++i) add_ball(world, numbered(i), Vec3::Zero());
  EXPECT_EQ(start_crowd(world, {}, 0.01).most, 25000);
  EXPECT_EQ(start_overlaps(world).size(), 0u);
  EXPECT_TRUE(start_crowd(world, {.max_contacts = 50000}, 0.01).empty());
  EXPECT_TRUE(start_crowd(world, {.contacts = false}, 0.01).empty());
}

}  // namespace
}  // namespace taut::robust_contacts_test
