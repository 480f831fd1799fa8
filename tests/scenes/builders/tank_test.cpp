#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scenes/builders/scene.h"
#include "scenes/builders/track.h"
#include "scenes/recording/gap_meter.h"
#include "solvers/simulator/simulator.h"

/// The tracked vehicle: its track, how it drives and turns, and joints that stay closed meanwhile.
namespace taut::tank_test {
namespace {

/// Steps a tank; each step must succeed, with joints closed to 1e-9 and the laws met to 1e-8.
struct Drive {
  explicit Drive(const std::map<std::string, double>& parameters)
      : scene(build_scene("tank", parameters)),
        simulator(scene.world, scene.settings),
        hull(scene.world.body("hull")) {}

  void run(double duration) {
    GapMeter meter(scene.world);
    const int steps = static_cast<int>(std::lround(duration / scene.dt));
    for (int i = 0; i < steps; ++i) {
      const StepReport& report = simulator.step(scene.dt);
      ASSERT_TRUE(report.exact()) << "step " << i << ": " << report.message;
      ASSERT_LE(report.natural_residual, 1e-8) << "step " << i;
      const Gap gap = meter.largest(scene.world);
      ASSERT_LE(std::max(gap.metres, gap.radians), 1e-9) << "step " << i;
    }
  }
  Vec3 position() const { return scene.world.pose(hull).p; }
  double heading() const {
    const Vec3 ahead = scene.world.pose(hull).q * Vec3::UnitX();
    return std::atan2(ahead.y(), ahead.x());
  }

  Scene scene;
  Simulator simulator;
  BodyId hull;
};

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
    EXPECT_TRUE(Simulator(const_cast<World&>(scene.world)).analyze_rank().redundant.empty());
  }
}

// Of the speed of its tracks: what the chords of a ring of 30 shoes and slip at the start leave of it.
TEST(Tank, drives_with_the_speed_of_its_tracks) {
  Drive drive({{"n", 30}, {"left", 0.8}, {"right", 0.8}});
  drive.run(0.3);
  const Vec3 start = drive.position();
  drive.run(0.4);
  const Vec3 way = drive.position() - start;
  EXPECT_NEAR(way.x(), 0.8 * 0.4, 0.1 * 0.8 * 0.4);
  EXPECT_NEAR(way.y(), 0, 1e-3);
  EXPECT_NEAR(drive.heading(), 0, 1e-3);
}

// On the plane, with gravity as on a slope of 20°.
TEST(Tank, climbs) {
  Drive drive({{"n", 30}, {"left", 0.5}, {"right", 0.5}});
  const double slope = 20 * std::numbers::pi / 180;
  drive.scene.world.set_gravity(9.81 * Vec3(-std::sin(slope), 0, -std::cos(slope)));
  drive.run(0.4);
  const double start = drive.position().x();
  drive.run(0.3);
  EXPECT_NEAR(drive.position().x() - start, 0.5 * 0.3, 0.15 * 0.5 * 0.3);
}

TEST(Tank, turns_where_it_stands_if_its_tracks_run_against_each_other) {
  Drive drive({{"n", 30}, {"left", -1}, {"right", 1}});
  drive.run(0.6);
  EXPECT_GT(drive.heading(), 0.1);
  EXPECT_LT(std::hypot(drive.position().x(), drive.position().y()), 0.15);
}

// The impulse of the ground less that of the weight is the momentum, as long as all forces are counted.
TEST(Tank, is_carried_by_the_ground) {
  Drive drive({{"n", 30}});
  const World& world = drive.scene.world;
  double mass = 0, impulse = 0;
  for (int b = 0; b < world.body_count(); ++b)
    if (!world.is_fixed(BodyId{b})) mass += world.mass_properties(BodyId{b}).mass();
  for (int i = 0; i < 100; ++i) {
    drive.run(drive.scene.dt);
    if (HasFatalFailure()) return;
    for (const ContactReport& contact : drive.simulator.contacts())
      if (world.shape(contact.contact.a).body == kGround) impulse += drive.scene.dt * contact.force.z();
  }
  // Round-off of 100 sums of forces of 1e4 N.
  EXPECT_NEAR(impulse - mass * 9.81 * world.time(), drive.simulator.report().linear_momentum.z(), 1e-6);
}

}  // namespace
}  // namespace taut::tank_test
