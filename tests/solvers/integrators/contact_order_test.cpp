#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/joints/joints.h"
#include "solvers/simulator/simulator.h"
#include "tests/solvers/contact_bodies.h"
#include "tests/solvers/integrators/measured_order.h"

/// With contact on curved surfaces steps are of order 2 between events, and bodies stay out of each other.
namespace taut::contact_order_test {
namespace {

constexpr double kG = 9.81;

using namespace contact_worlds;

/// Down a fixed sphere of 1 m without friction: θ̈ = g sin θ / R about the sum R of the radii.
TEST(ContactOrder, of_a_ball_that_slides_down_a_dome_is_2) {
  const double R = 1.1, start = 10 * std::numbers::pi / 180, time = 0.5;
  double theta = start, rate = 0;
  const int steps = 20000;
  for (int i = 0; i < steps; ++i) {  // Runge–Kutta
    const double h = time / steps;
    const auto f = [&](double x) { return kG * std::sin(x) / R; };
    const double k1 = f(theta), k2 = f(theta + 0.5 * h * rate),
                 k3 = f(theta + 0.5 * h * rate + 0.25 * h * h * k1),
                 k4 = f(theta + h * rate + 0.5 * h * h * k2);
    theta += h * rate + h * h / 6 * (k1 + k2 + k3);
    rate += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  double last = 0;
  for (const double dt : {4e-3, 2e-3, 1e-3}) {
    World world = ball_on_dome(start);
    const BodyId ball{1};
    Simulator simulator(world);
    for (int i = 0; i < std::lround(time / dt); ++i) {
      ASSERT_TRUE(simulator.step(dt).exact());
      ASSERT_NEAR(world.pose(ball).p.norm(), R, 2e-10);
    }
    const double error = (world.pose(ball).p - R * Vec3(std::sin(theta), 0, std::cos(theta))).norm();
    EXPECT_LE(error, 0.2 * dt * dt) << dt;
    if (last > 0) {
      EXPECT_NEAR(std::log2(last / error), 2, 0.02);
    }
    last = error;
  }
}

/// How far the disc's lowest point is below the floor.
double depth_of_disc(const World& world, BodyId disc, double r, double half) {
  const Vec3 axis = world.pose(disc).q * Vec3::UnitZ();
  const double across = std::hypot(axis.x(), axis.y());
  return r * across + half * std::abs(axis.z()) - world.pose(disc).p.z();
}

TEST(ContactOrder, of_a_disc_that_rolls_on_its_rim_is_2_and_its_energy_stays) {
  const double order = testing::order_of(rolling_disc, [](const World& world, Simulator&) {
    EXPECT_LE(depth_of_disc(world, BodyId{1}, 0.2, 0.02), 2e-6);
  });
  EXPECT_NEAR(order, 2, 0.1);

  World world = rolling_disc();
  Simulator simulator(world);
  ASSERT_TRUE(simulator.step(1e-3).exact());
  const double start = simulator.report().energy();
  for (int i = 0; i < 5000; ++i) {
    ASSERT_TRUE(simulator.step(1e-3).exact());
    ASSERT_NEAR(simulator.report().energy() / start, 1, 3e-6) << i;
  }
}

struct Rocker {
  double friction;
  Vec3 radii;
};
class RockingEllipsoid : public ::testing::TestWithParam<Rocker> {};

World rocking_ellipsoid(const Rocker& rocker) {
  World world;
  world.add_shape(kGround, HalfSpace{}, {}, rubbing(rocker.friction));
  const Quat q = Quat(Eigen::AngleAxisd(0.3, Vec3::UnitX())) * Quat(Eigen::AngleAxisd(0.4, Vec3::UnitY()));
  const Vec3 n = q.conjugate() * Vec3::UnitZ();
  const Vec3 square = rocker.radii.cwiseAbs2();
  const double height = std::sqrt(square.cwiseProduct(n).dot(n));
  const Vec3 r = rocker.radii;
  const Vec3 moments =
      0.2 * Vec3(r.y() * r.y() + r.z() * r.z(), r.x() * r.x() + r.z() * r.z(), r.x() * r.x() + r.y() * r.y());
  const Vec3 w = rocker.friction > 0 ? Vec3(0, 0, 0.7) : Vec3(0, 0, 2);
  const Vec3 contact = -(q * Vec3(square.cwiseProduct(n) / height));
  const Vec3 v = rocker.friction > 0 ? Vec3(-w.cross(contact)) : Vec3::Zero();
  add_solid(world, Ellipsoid{r}, MassProperties(1.0, Mat3(moments.asDiagonal())),
            {.q = q, .p = {0, 0, height}}, {.w = w, .v = {v.x(), v.y(), -w.cross(contact).z()}},
            rubbing(rocker.friction));
  return world;
}

TEST_P(RockingEllipsoid, is_of_order_2_on_a_plane) {
  const Vec3 square = GetParam().radii.cwiseAbs2();
  const double order = testing::order_of([&] { return rocking_ellipsoid(GetParam()); },
                                         [&](const World& world, Simulator&) {
                                           const Vec3 n = world.pose(BodyId{1}).q.conjugate() * Vec3::UnitZ();
                                           EXPECT_NEAR(world.pose(BodyId{1}).p.z(),
                                                       std::sqrt(square.cwiseProduct(n).dot(n)), 2e-6);
                                         });
  EXPECT_GE(order, 1.9);
}

INSTANTIATE_TEST_SUITE_P(Shapes, RockingEllipsoid,
                         ::testing::Values(Rocker{0, {0.3, 0.2, 0.1}}, Rocker{2, {0.3, 0.2, 0.1}},
                                           Rocker{2, {0.2, 0.2, 0.15}}),
                         [](const auto& rocker) {
                           return std::string("case").append(std::to_string(rocker.index));
                         });

/// A box that tips about its edge, held by friction: a physical pendulum.
TEST(ContactOrder, of_a_box_that_tips_about_its_edge_is_2) {
  const double order = testing::order_of([] {
    World world;
    world.add_shape(kGround, HalfSpace{}, {}, rubbing(2));
    const double angle = 0.9;
    const Quat q(Eigen::AngleAxisd(angle, Vec3::UnitY()));
    const Vec3 half(0.1, 0.15, 0.2);
    const Vec3 edge = q * Vec3(half.x(), 0, -half.z()), w(0, 0.5, 0);
    add_solid(world, Box{2 * half}, MassProperties::box(2 * half, 1), {.q = q, .p = {0, 0, -edge.z()}},
              {.w = w, .v = -w.cross(edge)}, rubbing(2));
    return world;
  });
  EXPECT_GE(order, 1.9);
}

/// A ball that rolls on a turntable: the centre moves on circles.
TEST(ContactOrder, of_a_ball_on_a_turntable_is_2) {
  const double order = testing::order_of([] {
    World world;
    const BodyId table = world.add_body({.name = "table",
                                         .mass = MassProperties::cylinder(2, 0.1, 50),
                                         .pose = {.p = {0, 0, -0.05}},
                                         .twist = {.w = {0, 0, 3}, .v = Vec3::Zero()}});
    world.add_shape(table, Cylinder{2, 0.1}, {}, rubbing(1));
    world.add("axle", Hinge::at(world, kGround, table, Vec3::Zero(), Vec3::UnitZ()));
    // Rolling where the table moves with 3·0.4 m/s.
    add_solid(world, Sphere{0.1}, MassProperties::sphere(0.1, 1), {.p = {0.4, 0, 0.1}},
              {.w = {-8, 0, 0}, .v = {0, 1.2 + 0.8, 0}}, rubbing(1));
    return world;
  });
  EXPECT_GE(order, 1.9);
}

}  // namespace
}  // namespace taut::contact_order_test
