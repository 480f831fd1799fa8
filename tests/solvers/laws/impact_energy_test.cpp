#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "core/joints/joints.h"
#include "core/world/diagnostics.h"
#include "solvers/simulator/simulator.h"
#include "tests/solvers/contact_bodies.h"
#include "tests/solvers/contact_energy.h"

/// No impact creates energy, whatever the step, the shapes and the number of contacts; e = 1 without friction
/// keeps it.  Energies are recomputed from masses, poses and twists.
namespace taut::impact_energy_test {
namespace {

constexpr double kG = 9.81;

using namespace contact_worlds;

/// T + V of the bodies, by hand.
double energy(const World& world) {
  double sum = 0;
  for (int b = 1; b < world.body_count(); ++b) {
    const MassProperties& mass = world.mass_properties(BodyId{b});
    const Pose& pose = world.pose(BodyId{b});
    const Twist& V = world.twist(BodyId{b});
    const Vec3 w = pose.q.conjugate() * V.w;
    sum += 0.5 * mass.mass() * V.v.squaredNorm() + 0.5 * w.dot(mass.inertia_B() * w) -
           mass.mass() * world.gravity().dot(pose.p);
  }
  return sum;
}

struct Course {
  double end = 0, most = 0;  ///< E/E₀ − 1 at the end, and the largest at any time
  double booked = 0;         ///< work of contacts and friction in the ledger, over E₀
};

/// Steps a world; in none of them do contacts or friction give energy.
Course run(World& world, double dt, double time, double resting_speed = 1e-4) {
  Settings settings;
  settings.resting_speed = resting_speed;
  Simulator simulator(world, settings);
  const double start = energy(world);
  Course course;
  for (int i = 0; i * dt < time * (1 - 1e-12); ++i) {
    const StepReport& report = simulator.step(dt);
    EXPECT_TRUE(report.ok()) << "step " << i << ": " << report.message;
    if (!report.ok()) break;
    EXPECT_LE(report.ledger.contacts + report.ledger.friction, 1e-8 * start)
        << "step " << i << ": " << report.ledger.contacts << " and " << report.ledger.friction;
    course.booked += (report.ledger.contacts + report.ledger.friction) / start;
    course.end = energy(world) / start - 1;
    course.most = std::max(course.most, course.end);
  }
  return course;
}

TEST(ImpactEnergy, of_a_smooth_box_that_tumbles_on_a_smooth_floor_is_kept) {
  double largest = 0, last = 0;
  for (const double dt : {4e-3, 2e-3, 1e-3, 5e-4}) {
    World world = tumbling_box();
    const Course course = run(world, dt, 4);
    EXPECT_NEAR(course.end, 0, 1e-3) << dt;
    EXPECT_LE(course.most, 1e-3) << dt;
    last = std::max(course.most, std::abs(course.end));
    largest = std::max(largest, last);
  }
  EXPECT_LE(last, largest / 16);  // that of the split rotation between impacts, of order 2
}

TEST(ImpactEnergy, of_two_balls_off_centre_is_kept_and_they_part_along_the_line_of_centres) {
  World world = two_balls();
  const BodyId a{1}, b{2};
  EXPECT_NEAR(run(world, 1e-3, 0.4).end, 0, 1e-12);
  // sin of the angle between the line of centres and x is 0.19/0.2.
  const double s = 0.95, c2 = 1 - s * s;
  EXPECT_NEAR(world.twist(b).v.x(), 3 * c2, 1e-6);
  EXPECT_NEAR(world.twist(a).v.x(), 3 * s * s, 1e-6);
}

TEST(ImpactEnergy, of_a_break_of_fifteen_balls_that_touch_is_kept) {
  World world = ball_break();
  const Course course = run(world, 1e-3, 0.5, 1e-9);
  EXPECT_NEAR(course.end, 0, 1e-9);
}

struct Gas {
  bool boxes;
  double dt;
};
class ImpactGas : public ::testing::TestWithParam<Gas> {};

TEST_P(ImpactGas, keeps_its_energy) {
  World world = gas(GetParam().boxes);
  const Course course = run(world, GetParam().dt, 1);
  EXPECT_NEAR(course.end, 0, 1e-3);
  EXPECT_LE(course.most, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Steps, ImpactGas,
                         ::testing::Values(Gas{false, 4e-3}, Gas{false, 1e-3}, Gas{true, 4e-3},
                                           Gas{true, 1e-3}),
                         [](const auto& gas) {
                           return std::string(gas.param.boxes ? "boxes_" : "balls_")
                               .append(std::to_string(int(1e6 * gas.param.dt)))
                               .append("us");
                         });

struct Oblique {
  double restitution, friction;
};
class ObliqueImpact : public ::testing::TestWithParam<Oblique> {};

/// J_n = (1 + e) m v_n and J_t = min(μ J_n, 2/7 m |v_t|) for a sphere.
TEST_P(ObliqueImpact, of_a_ball_is_that_of_the_closed_form) {
  const auto [e, mu] = GetParam();
  const double vx = 1.5, vz = -2, r = 0.1;
  World world = oblique_ball({.speed_x = vx, .speed_z = vz, .spin = 4, .radius = r, .height = 0.0503}, e, mu);
  const BodyId ball{1};
  const Course course = run(world, 1e-3, 0.05);
  EXPECT_NEAR(course.booked, course.end, 1e-9);
  const double slip = vx - 4 * r;  // of the lowest point
  const double friction = std::min(mu * (1 + e) * -vz, 2.0 / 7 * std::abs(slip));
  // Without restitution the impact begins with the step, as far above the floor as the ball is then.
  const double tolerance = e > 0 ? 1e-8 : 1e-3;
  EXPECT_NEAR(world.twist(ball).v.z(), -e * vz, 1e-8);
  EXPECT_NEAR(world.twist(ball).v.x(), vx - std::copysign(friction, slip), tolerance);
}

/// Rods and boxes that strike with a corner: Newton's law with friction would give energy in some of these.
TEST_P(ObliqueImpact, of_rods_and_boxes_never_gives_energy) {
  const auto [e, mu] = GetParam();
  std::mt19937 random(11);
  for (int i = 0; i < 12; ++i) {
    World world = thrown_box(random, i % 2 == 0, e, mu);
    const Course course = run(world, 2e-3, 0.6, 1e-3);
    EXPECT_LE(course.most, 2e-4) << i;  // of the flow between impacts
  }
}

INSTANTIATE_TEST_SUITE_P(Materials, ObliqueImpact,
                         ::testing::Values(Oblique{0, 0}, Oblique{0, 0.3}, Oblique{0, 1}, Oblique{0.3, 0.1},
                                           Oblique{0.3, 1}, Oblique{0.7, 0}, Oblique{0.7, 0.3},
                                           Oblique{0.7, 1}, Oblique{1, 0.1}, Oblique{1, 0.3}, Oblique{1, 1}));

/// Painlevé's rod: its end on a rough floor, sliding.
TEST(ImpactEnergy, of_a_rod_that_slides_on_a_rough_floor_never_grows) {
  for (const double degrees : {25.0, 40.0, 55.0, 70.0})
    for (const double mu : {0.4, 1.0, 1.5}) {
      const double angle = degrees * std::numbers::pi / 180;
      World world = sliding_rod({.angle = angle, .height = 0.015, .speed_z = -1, .spin = 1}, 0.5, mu);
      EXPECT_LE(run(world, 1e-3, 0.5, 1e-3).most, 1e-5) << degrees << "°, " << mu;
    }
}

/// A heavy box that falls on a light one wedges it against the floor, and the wedge parts within a step.
TEST(ImpactEnergy, of_a_box_wedged_under_a_heavy_one_never_grows) {
  for (const std::uint32_t seed : {31u, 65u, 253u, 262u}) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto unit = [&] { return 2 * (random() / 4294967295.0) - 1; };
    const auto vector = [&](double most) {
      const double x = unit(), y = unit(), z = unit();
      return Vec3(most * x, most * y, most * z);
    };
    World world;
    const Vec3 size = Vec3::Constant(0.18);
    world.add_shape(kGround, HalfSpace{}, {}, rubbing(0.76));
    for (const bool heavy : {false, true}) {
      const Vec3 axis = vector(1);
      const Quat q(Eigen::AngleAxisd(3 * unit(), axis.normalized()));
      const Vec3 place = vector(0.05);
      const BodyId body = world.add_body({.name = heavy ? "heavy" : "light",
                                          .mass = MassProperties::box(size, heavy ? 25 : 0.2),
                                          .pose = {q, {place.x(), place.y(), heavy ? 0.5 : 0.17}}});
      const Vec3 w = vector(5), v = vector(1) - Vec3(0, 0, heavy ? 2 : 1);
      world.set_twist(body, {w, v});
      world.add_shape(body, Box{size}, {}, rubbing(0.76));
    }
    Simulator simulator(world);
    // 4e-3 to 7e-2 if the wedge's impulses are taken back whole; rigid contacts that turn give 1e-6.
    testing::expect_contacts_give_nothing(simulator, 2e-3, 250, 1e-5);
  }
}

/// Chains of capsules, elastic and not, and one body that strikes with two materials at once.
TEST(ImpactEnergy, of_chains_and_of_bodies_of_two_materials_never_grows) {
  for (const double e : {0.0, 0.5, 1.0})
    for (const double mu : {0.0, 0.4}) {
      SCOPED_TRACE(std::string("e ").append(std::to_string(e)).append(", mu ").append(std::to_string(mu)));
      World world;
      world.add_shape(kGround, HalfSpace{}, {}, rubbing(mu, e));
      BodyId last = kGround;
      for (int i = 0; i < 5; ++i) {
        const BodyId link = world.add_body({.name = std::string("link").append(std::to_string(i)),
                                            .mass = MassProperties::box({0.2, 0.04, 0.04}, 1),
                                            .pose = {.p = {0.2 * i, 0.01 * i, 0.3 + 0.03 * i}}});
        world.add_shape(link, Capsule{0.02, 0.15},
                        {.q = Quat(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitY()))},
                        rubbing(mu, e));
        if (i > 0)
          world.add(std::string("pin").append(std::to_string(i)),
                    Ball::at(world, last, link, Vec3(0.2 * i - 0.1, 0.01 * i - 0.005, 0.285 + 0.03 * i)));
        last = link;
      }
      EXPECT_LE(run(world, 2e-3, 1, 1e-3).most, 5e-4) << e << ", " << mu;  // of the flow, of order 2
    }
  World world;
  world.add_shape(kGround, HalfSpace{}, {}, rubbing(0, 1));
  const BodyId body = add_box(world, {0.1, 0.1, 0.1}, {.p = {0, 0, 0.5}}, {.w = {0, 0.4, 0}, .v = {0, 0, -1}},
                              rubbing(0, 0.2));
  world.add_shape(body, Sphere{0.05}, {.p = {0.3, 0, 0}}, rubbing(0, 0.9));
  world.add_shape(body, Sphere{0.05}, {.p = {-0.3, 0, 0}}, rubbing(0, 0.1));
  EXPECT_LE(run(world, 2e-3, 1, 1e-3).most, 2e-4);
}

}  // namespace
}  // namespace taut::impact_energy_test
