#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scenes/gap_meter.h"
#include "scenes/scene.h"
#include "scenes/track.h"
#include "solvers/simulator.h"

/// The builders with contact: what each of them is to show, and joints that stay closed meanwhile.
namespace taut {
namespace {

constexpr double kG = 9.81;

/// Steps a scene; each step must succeed, with joints closed to 1e-9 and the laws met to 1e-8.
void run(Scene& scene, Simulator& simulator, double duration) {
  GapMeter meter(scene.world);
  const int steps = static_cast<int>(std::lround(duration / scene.dt));
  for (int i = 0; i < steps; ++i) {
    const StepReport& report = simulator.step(scene.dt);
    ASSERT_TRUE(report.ok()) << scene.name << " step " << i << ": " << report.message;
    ASSERT_LE(report.complementarity_residual, 1e-8) << scene.name << " step " << i;
    const Gap gap = meter.largest(scene.world);
    ASSERT_LE(std::max(gap.metres, gap.radians), 1e-9) << scene.name << " step " << i;
  }
}

double mass_of(const World& world) {
  double mass = 0;
  for (int b = 0; b < world.body_count(); ++b)
    if (!world.is_fixed(BodyId{b})) mass += world.mass_properties(BodyId{b}).mass();
  return mass;
}

// Round two equal wheels: every pin is ρ = √((R + d)² + p²/4) from the segment between their centres.
TEST(Track, links_of_one_pitch_close_a_ring_around_its_wheels) {
  const double offset = 0.02;
  for (const int links : {20, 61}) {
    const TrackPins track = lay_track({{1, 0, 0.3}, {-1, 0, 0.3}}, links, offset);
    ASSERT_EQ(track.pin.size(), static_cast<std::size_t>(links));
    const double radius = std::hypot(0.3 + offset, track.pitch / 2);
    for (int k = 0; k < links; ++k) {
      const Eigen::Vector2d p = track.pin[k], next = track.pin[(k + 1) % links];
      EXPECT_NEAR((next - p).norm(), track.pitch, 1e-12) << k;
      EXPECT_NEAR((p - Eigen::Vector2d(std::clamp(p.x(), -1.0, 1.0), 0)).norm(), radius, 1e-12) << k;
      // Anticlockwise, and no link enters a wheel's circle of R + d.
      EXPECT_GT(p.x() * next.y() - p.y() * next.x(), 0) << k;
      for (const double x : {-1.0, 1.0}) {
        const Eigen::Vector2d centre(x, 0), along = (next - p).normalized();
        const double s = std::clamp((centre - p).dot(along), 0.0, track.pitch);
        EXPECT_GE((p + s * along - centre).norm(), 0.3 + offset - 1e-12) << k;
      }
    }
  }
  EXPECT_THROW((void)lay_track({{0, 0, 1}}, 20, 0), std::invalid_argument);
  EXPECT_THROW((void)lay_track({{0, 0, 1}, {3, 0, 1}}, 7, 0), std::invalid_argument);
}

TEST(Tank, has_two_rings_of_shoes_and_sprung_wheels) {
  for (const int n : {30, 60}) {
    const Scene scene = build_scene("tank", {{"n", n}});
    // A side: n shoes, sprocket, idler, five wheels and five arms.
    EXPECT_EQ(scene.world.moving_body_count(), 1 + 2 * (n + 12));
    EXPECT_EQ(scene.world.joint_count(), 2 * (n + 12));
    EXPECT_EQ(Simulator(const_cast<World&>(scene.world)).analyze_rank().redundant.size(), 6u);
  }
}

// Without friction and motors: the ground's impulse less the weight's is the momentum.
TEST(Tank, settles_on_its_tracks_without_friction) {
  Scene scene = build_scene("tank");
  World& world = scene.world;
  for (int s = 0; s < world.shape_count(); ++s) {
    Material smooth = world.shape(ShapeId{s}).material;
    smooth.static_friction = smooth.dynamic_friction = 0;
    world.set_material(ShapeId{s}, smooth);
  }
  for (const char* drive : {"left_drive", "right_drive"})
    world.set_motor(world.axis(world.joint(drive), "angle"), std::nullopt);
  Simulator simulator(world, scene.settings);
  double impulse = 0;
  for (int i = 0; i < 150; ++i) {
    run(scene, simulator, scene.dt);
    if (HasFatalFailure()) return;
    for (const ContactReport& contact : simulator.contacts())
      if (world.shape(contact.contact.a).body == kGround) impulse += scene.dt * contact.force.z();
  }
  const double momentum = simulator.report().linear_momentum.z();
  // Round-off of 150 sums of forces of 1e4 N.
  EXPECT_NEAR(impulse - mass_of(world) * kG * world.time(), momentum, 1e-6);
  EXPECT_LT(world.pose(world.body("hull")).p.z(), 0.75);
  EXPECT_GT(world.pose(world.body("hull")).p.z(), 0.68);
}

// All torque of the four motors goes into the vehicle and its wheels; it pitches a little as it starts.
TEST(VehicleBridge, its_motors_speed_the_vehicle_up_on_the_bank) {
  Scene scene = build_scene("vehicle-bridge", {{"n", 10}});
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

TEST(CardHouse, stands_still) {
  Scene scene = build_scene("card-house", {{"n", 2}});
  const State start = scene.world.state();
  Simulator simulator(scene.world, scene.settings);
  run(scene, simulator, 0.3);
  for (int b = 1; b < scene.world.body_count(); ++b)
    EXPECT_LE((scene.world.pose(BodyId{b}).p - start.poses[b].p).norm(), 1e-6) << b;
}

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

TEST(Pile, stays_within_its_walls) {
  Scene scene = build_scene("pile", {{"n", 8}});
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
}  // namespace taut
