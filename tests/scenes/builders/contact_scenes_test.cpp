#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "scenes/builders/scene.h"
#include "scenes/files/state_file.h"
#include "scenes/recording/gap_meter.h"
#include "solvers/simulator/simulator.h"
#include "tests/allocation_counter.h"
#include "tests/source_dir.h"

/// The builders with contact: what each of them is to show, and joints that stay closed meanwhile.
namespace taut::contact_scenes_test {
namespace {

constexpr double kG = 9.81;

/// Steps a scene; each step must succeed, with joints closed to 1e-9 and the laws met to 1e-8.
void run(Scene& scene, Simulator& simulator, double duration) {
  GapMeter meter(scene.world);
  const int steps = static_cast<int>(std::lround(duration / scene.dt));
  for (int i = 0; i < steps; ++i) {
    const StepReport& report = simulator.step(scene.dt);
    ASSERT_TRUE(report.exact()) << scene.name << " step " << i << ": " << report.message;
    ASSERT_LE(report.natural_residual, 1e-8) << scene.name << " step " << i;
    const Gap gap = meter.largest(scene.world);
    ASSERT_LE(std::max(gap.metres, gap.radians), 1e-9) << scene.name << " step " << i;
  }
}

/// The farthest that a body's centre has gone [m].
double largest_motion(const World& world, const State& since) {
  double largest = 0;
  for (int b = 1; b < world.body_count(); ++b)
    largest = std::max(largest, (world.pose(BodyId{b}).p - since.poses[b].p).norm());
  return largest;
}

// All torque of the four motors goes into the vehicle and its wheels; it pitches a little as it starts.
TEST(VehicleBridge, its_motors_speed_the_vehicle_up_on_the_bank) {
  Scene scene = build_scene("vehicle-bridge", {{"n", 10}, {"load", 200}});
  Simulator simulator(scene.world, scene.settings);
  run(scene, simulator, 0.4);
  const double load = 200, wheel = 5, radius = 0.18, torque = 0.1 * load * kG * radius;
  const double acceleration = 4 * torque / radius / (load + 4 * wheel * 1.5);
  EXPECT_NEAR(scene.world.twist(scene.world.body("chassis")).v.x(), 0.4 * acceleration,
              0.02 * 0.4 * acceleration);
}

// Euler's law of the capstan: from the acceleration of the weights follow the tensions on both sides.
TEST(Capstan, the_chain_slides_as_euler_says) {
  const double friction = 0.3, ratio = 2.9;
  Scene scene = build_scene("chain-over-cylinder", {{"friction", friction}, {"ratio", ratio}});
  Simulator simulator(scene.world, scene.settings);
  run(scene, simulator, 0.15);
  const double a = -scene.world.twist(scene.world.body("heavy")).v.z() / scene.world.time();
  const double hanging = 6 * 0.05, light = 10 + hanging, heavy = 10 * ratio + hanging;
  const double tensions = heavy * (kG - a) / (light * (kG + a));
  // The weight and inertia of the links on the drum are 2 % of what they carry.
  EXPECT_NEAR(tensions, std::exp(friction * std::numbers::pi * 0.3 / 0.315), 0.02 * tensions);
}

/// How far links that lie on the drum, the middle half of them, move in the last 3 s of 4 [m].
double creep_on_the_drum(double ratio) {
  Scene scene = build_scene("chain-over-cylinder", {{"ratio", ratio}});
  const World& world = scene.world;
  Simulator simulator(scene.world, scene.settings);
  run(scene, simulator, 1);
  const State settled = world.state();
  run(scene, simulator, 3);
  double farthest = 0;
  for (int k = 6; k < 18; ++k) {
    const BodyId link = world.body("link_" + std::to_string(k));
    farthest = std::max(farthest, (world.pose(link).p - settled.poses[link.index].p).norm());
  }
  return farthest;
}

// Its twelve contacts share the load in infinitely many ways; none of them is to slip, though other divisions
// than the present one would let some.  What hangs swings on joints without friction for ever, by as much as
// the chain slid before it held: nothing to speak of at 1.5 and 2.3, some 10 µm at 2.4, 2 % below where it
// slides.  So the load on the drum changes all the time, and links move within the tolerances of gaps and
// joints, 1e-10 m, of which some add up along the drum.
TEST(Capstan, the_chain_holds_without_creep) {
  for (const double ratio : {1.5, 2.3, 2.4}) EXPECT_LT(creep_on_the_drum(ratio), 1e-9) << ratio;
}

TEST(CardHouse, stands_still) {
  Scene scene = build_scene("card-house", {{"n", 2}});
  const State start = scene.world.state();
  Simulator simulator(scene.world, scene.settings);
  run(scene, simulator, 0.3);
  EXPECT_LE(largest_motion(scene.world, start), 1e-6);
}

TEST(Wall, of_ten_rows_stands_still) {
  Scene scene = build_scene("wall", {{"n", 10}});
  const State start = scene.world.state();
  Simulator simulator(scene.world, scene.settings);
  run(scene, simulator, 1);
  EXPECT_LE(largest_motion(scene.world, start), 1e-9);
}

/// How far a stack of twenty that has settled moves.  Without sleep: what each step adds would add up.
double motion_of_twenty(bool top_heavy, int steps) {
  Scene scene = build_scene("stack", {{"n", 20}, {"top_heavy", top_heavy ? 1 : 0}});
  Simulator simulator(scene.world, scene.settings);
  run(scene, simulator, 1);
  const State settled = scene.world.state();
  for (int i = 0; i < steps; ++i) {
    const StepReport& report = simulator.step(scene.dt);
    EXPECT_TRUE(report.exact()) << report.message;
    EXPECT_LE(report.natural_residual, 1e-8) << i;
    if (::testing::Test::HasFailure()) break;
  }
  return largest_motion(scene.world, settled);
}

TEST(Stack, of_twenty_boxes_does_not_move_in_10000_steps) { EXPECT_LE(motion_of_twenty(false, 10000), 1e-9); }

// It wobbles by 7e-7 m in the first thousand of them, and by no more in a hundred thousand.
TEST(Stack, top_heavy_does_not_creep_in_20000_steps) { EXPECT_LE(motion_of_twenty(true, 20000), 1e-6); }

// No energy comes from contacts and limits of joints.
TEST(RagdollStairs, a_ragdoll_falls_down_and_loses_energy) {
  Scene scene = build_scene("ragdoll-stairs");
  Simulator simulator(scene.world, scene.settings);
  double energy = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 12; ++i) {
    run(scene, simulator, 0.1);
    if (HasFatalFailure()) return;
    EXPECT_LE(simulator.report().energy(), energy + 1e-3 * scene.energy_scale);
    energy = simulator.report().energy();
    EXPECT_LE(simulator.report().penetration, 1e-4);
  }
  EXPECT_LT(scene.world.pose(scene.probes[0].body).p.z(), -1);
}

TEST(NetCatch, a_light_ball_is_caught) {
  Scene scene = build_scene("net-catch", {{"n", 5}, {"mass", 2}, {"drop", 0.05}});
  const BodyId ball = scene.world.body("ball");
  Simulator simulator(scene.world, scene.settings);
  run(scene, simulator, 0.5);
  EXPECT_LT(scene.world.twist(ball).v.norm(), 0.5);  // it has fallen at 1.5 m/s and more
  EXPECT_GT(simulator.report().contacts, 0);
}

// On flat ground all of it slides straight on after a second: friction is μ times its weight, the bar pulls
// with as much, and all that it works is rubbed away.
TEST(NetDrag, is_dragged_over_flat_ground_by_its_friction) {
  const double n = 5, load = 5, speed = 0.5, friction = 0.4, measured = 0.2;
  Scene scene = build_scene(
      "net-drag", {{"n", n}, {"load", load}, {"speed", speed}, {"friction", friction}, {"bump", 0}});
  Simulator simulator(scene.world, scene.settings);
  run(scene, simulator, 1.2);
  const JointId drive = scene.world.joint("drive");
  const int steps = static_cast<int>(std::lround(measured / scene.dt));
  double pull = 0, rubbed = 0, driven = 0;
  for (int i = 0; i < steps; ++i) {
    const StepReport& report = simulator.step(scene.dt);
    ASSERT_TRUE(report.exact()) << report.message;
    pull += simulator.mean_reaction(drive).force.x() / steps;
    rubbed -= report.ledger.friction;
    driven += report.ledger.drivers;
  }
  // The box still swings a little on the knots that give way: 1e-4.
  const double expected = friction * (2 * n * (n - 1) * 0.1 + load) * kG;
  EXPECT_NEAR(pull, expected, 1e-3 * expected);
  EXPECT_NEAR(rubbed, expected * speed * measured, 1e-3 * rubbed);
  EXPECT_NEAR(driven, expected * speed * measured, 1e-3 * driven);
}

/// Work of the contacts of the last step on the bodies, Σ F·(v_Q − v_P) dt, with the mean of the velocities
/// before and after it [J].
double contact_work(const Simulator& simulator, const std::vector<Twist>& before) {
  const World& world = simulator.world();
  const auto velocity = [&](BodyId body, const Vec3& p) -> Vec3 {
    const Twist &V0 = before[body.index], &V1 = world.twist(body);
    return 0.5 * (V0.v + V1.v + (V0.w + V1.w).cross(world.pose(body).q * p));
  };
  double work = 0;
  for (const ContactReport& report : simulator.contacts()) {
    const Contact& c = report.contact;
    work += report.force.dot(velocity(c.B, c.p_BQ) - velocity(c.A, c.p_AP)) * simulator.report().dt;
  }
  return work;
}

// Over bumps: energy comes from the bar alone, by pull times speed, and goes into contacts, by forces times
// slip.
TEST(NetDrag, drags_its_load_over_bumps) {
  const double speed = 1;
  Scene scene = build_scene("net-drag", {{"n", 4}, {"speed", speed}});
  const World& world = scene.world;
  Simulator simulator(scene.world, scene.settings);
  run(scene, simulator, 0.5);
  const JointId drive = world.joint("drive");
  const BodyId load = world.body("load"), rod = world.body("rod_x_1_1");
  const double start = simulator.report().energy(), rest = world.pose(load).p.z();
  double drivers = 0, lost = 0, pulled = 0, rubbed = 0, highest = 0;
  while (world.time() < 2) {
    const std::vector<Twist> before = world.state().twists;
    run(scene, simulator, scene.dt);
    if (HasFatalFailure()) return;
    const StepReport& report = simulator.report();
    // Knots and load sink by 0.6 mm at rest, and are pressed harder as the load lurches.
    ASSERT_LE(report.penetration, 3e-3);
    ASSERT_LE((world.pose(load).p - world.pose(rod).p).norm(), 0.16);  // it lies where it lay
    pulled += simulator.mean_reaction(drive).force.x() * speed * scene.dt;
    rubbed -= contact_work(simulator, before);
    drivers += report.ledger.drivers;
    lost -= report.ledger.friction + report.ledger.contacts;
    highest = std::max(highest, world.pose(load).p.z());
  }
  EXPECT_GT(highest, rest + 0.02);
  EXPECT_NEAR(drivers, pulled, 1e-6 * pulled);
  EXPECT_NEAR(drivers - lost, simulator.report().energy() - start, 1e-3 * drivers);
  // Impacts within a step, and sub-steps, are not the mean of what was before and after.
  EXPECT_NEAR(lost, rubbed, 5e-3 * lost);
}

// Contacts come, slip, stick and go.
TEST(Pile, meets_its_laws_while_it_falls_in) {
  for (const double compliance : {0.0, 5e-10}) {
    Scene scene = build_scene("pile", {{"n", 30}, {"compliance", compliance}});
    Simulator simulator(scene.world, scene.settings);
    run(scene, simulator, 1.5);
    EXPECT_GT(simulator.report().contacts, 50);
  }
}

/// All that a pile at rest bears, with the bodies awake; first it settles, since a solver that starts anew
/// knows nothing of the contacts.
void bears_its_weight(Scene& scene, double compliance, int settling, int steps) {
  Settings settings = scene.settings;
  settings.sleep = false;
  settings.threads = 1;  // another one allocates when it first gets work
  Simulator simulator(scene.world, settings);
  run(scene, simulator, settling * scene.dt);
  if (::testing::Test::HasFatalFailure()) return;
  for (int i = 0; i < steps; ++i) {
    const long before = allocation_count();
    const StepReport& report = simulator.step(scene.dt);
    EXPECT_EQ(allocation_count(), before);
    EXPECT_TRUE(report.exact()) << report.message;
    EXPECT_LE(report.natural_residual, 1e-8);
    EXPECT_EQ(report.counts.analyses, 0);
    EXPECT_LE(report.penetration, 1e-5);
  }
  double weight = 0, carried = 0;
  for (int b = 1; b < scene.world.body_count(); ++b)
    weight += kG * scene.world.mass_properties(BodyId{b}).mass();
  for (const ContactReport& contact : simulator.contacts()) {
    const bool on_ground = contact.contact.A == kGround || contact.contact.B == kGround;
    if (contact.contact.A == kGround) carried += contact.force.z();
    if (contact.contact.B == kGround) carried -= contact.force.z();
    const double sinks = (on_ground ? 1 : 2) * compliance * contact.normal_force;
    EXPECT_NEAR(std::max(0.0, -contact.contact.gap), sinks, 1e-8);
  }
  EXPECT_NEAR(carried, weight, 1e-3 * weight);
}

// Each contact gives way by its force times the compliance of both, and the ground carries all bodies.
// Newton's method has a guess that its sweeps brought near.  While bodies tumble a stage is solved until the
// gaps are closed that their surfaces open as they turn: 77 steps a step until all sleep, 37 with planes.
TEST(Pile, of_stiff_bodies_comes_to_rest_and_falls_asleep) {
  constexpr double kCompliance = 5e-10;
  constexpr int kBodies = 40, kMostSteps = 10 * 240;
  Scene scene = build_scene("pile", {{"n", kBodies}, {"compliance", kCompliance}});
  scene.settings.sleep = true;
  Simulator simulator(scene.world, scene.settings);
  long newton = 0;
  int steps = 0;
  for (; steps < kMostSteps && simulator.report().asleep < kBodies; ++steps) {
    run(scene, simulator, scene.dt);
    if (HasFatalFailure()) return;
    newton += simulator.report().counts.contact_iterations;
  }
  EXPECT_EQ(simulator.report().asleep, kBodies);
  EXPECT_LT(newton, 130 * steps);  // 76 a step with 300 sweeps of a guess, which takes 1.3 times as long
  bears_its_weight(scene, kCompliance, 24, 20);
}

// The state is that at the end of `taut run pile --set n=1000 --time 9 --sleep`, when all sleep.
TEST(Pile, of_1000_at_rest_needs_no_analysis_and_no_allocation) {
  Scene scene = build_scene("pile", {{"n", 1000}});
  load_state_file(scene.world, testing::source_dir() + "/benchmarks/states/pile-1000.json");
  bears_its_weight(scene, 5e-10, 12, 8);
  double fastest = 0;
  for (int b = 1; b < scene.world.body_count(); ++b)
    fastest = std::max(fastest, scene.world.twist(BodyId{b}).v.norm());
  EXPECT_LT(fastest, 1e-6);
}

TEST(Pile, stays_within_its_walls) {
  Scene scene = build_scene("pile", {{"n", 8}, {"compliance", 0}});
  scene.dt = 2e-3;
  Simulator simulator(scene.world, scene.settings);
  run(scene, simulator, 0.6);
  const int side = 2;
  for (int b = 1; b < scene.world.body_count(); ++b)
    for (int i = 0; i < 2; ++i) {
      EXPECT_GT(scene.world.pose(BodyId{b}).p[i], -0.3);
      EXPECT_LT(scene.world.pose(BodyId{b}).p[i], 0.6 * (side - 0.5));
    }
}

}  // namespace
}  // namespace taut::contact_scenes_test
