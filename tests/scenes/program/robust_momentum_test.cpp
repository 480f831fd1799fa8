#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/joints/joints.h"
#include "core/world/diagnostics.h"
#include "scenes/files/scene_file.h"
#include "solvers/simulator/simulator.h"
#include "tests/source_dir.h"

// Implicit tension acts between bodies: what nothing holds keeps its momenta.
namespace taut::robust_momentum_test {
namespace {

/// Σ |m v| and Σ |x × m v| + |I ω|, with which momenta are compared.
struct Scales {
  double linear = 0, angular = 0;
};

Scales scales(const World& world) {
  Scales sum;
  for (int b = 1; b < world.body_count(); ++b) {
    const State& state = world.state();
    const MassProperties& mass = world.mass_properties(BodyId{b});
    const Vec3 P = mass.mass() * state.twists[b].v;
    sum.linear += P.norm();
    sum.angular += state.poses[b].p.cross(P).norm() +
                   angular_momentum_about_centre(mass, state.poses[b], state.twists[b].w).norm();
  }
  return sum;
}

struct Kept {
  double linear = 0, angular = 0, energy = 0;  ///< largest relative changes; of energy a gain
  double tension = 0, gap = 0;
  int contacts = 0;
};

Kept run(World& world, double dt, int steps) {
  Settings settings;
  settings.tension = TensionPolicy::kImplicit;
  settings.position_tolerance = 1e-12;  // what joints are open by is the arm of a couple
  settings.max_rotation = 1;
  Simulator simulator(world, settings);
  Vec3 P, L;
  double energy = 0, highest = 0;
  Scales scale;
  Kept kept;
  for (int i = 0; i <= steps; ++i) {
    const StepReport& report = simulator.step(dt);
    EXPECT_TRUE(report.exact()) << "step " << i << ": " << report.message;
    if (!report.exact()) break;
    if (i == 0) {  // whose start makes velocities tangent
      P = report.linear_momentum, L = report.angular_momentum;
      energy = report.energy();
      highest = std::abs(report.kinetic_energy);
    }
    const Scales now = scales(world);
    scale = {std::max(scale.linear, now.linear), std::max(scale.angular, now.angular)};
    kept.linear = std::max(kept.linear, (report.linear_momentum - P).norm() / scale.linear);
    kept.angular = std::max(kept.angular, (report.angular_momentum - L).norm() / scale.angular);
    kept.energy = std::max(kept.energy, (report.energy() - energy) / highest);
    kept.contacts += report.contacts;
    kept.tension = std::max(kept.tension, report.tension_number);
    kept.gap = std::max({kept.gap, report.gap.metres, report.gap.radians});
  }
  return kept;
}

Kept run_file(const std::string& name, double dt) {
  Scene scene = load_scene_file(testing::source_dir() + "/tests/adversary/" + name);
  return run(scene.world, dt, 60);
}

TEST(RobustMomentum, OfFilesIsKept) {
  const std::pair<const char*, double> files[] = {{"implicit_momentum_200383.json", 1.0 / 60},
                                                  {"implicit_distance_momentum.json", 0.1}};
  for (const auto& [name, dt] : files) {
    SCOPED_TRACE(name);
    const Kept kept = run_file(name, dt);
    EXPECT_GT(kept.tension, 0.7);
    EXPECT_LE(kept.linear, 1e-12);
    EXPECT_LE(kept.angular, 1e-12);
    EXPECT_LE(kept.energy, 1e-2);
    EXPECT_LE(kept.gap, 1e-9);
  }
}

/// A tree of bodies of 0.1 to 1000 kg that spins, with joints of all kinds.
World random_mechanism(int seed) {
  std::mt19937 random(seed);
  const auto number = [&random](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto vector = [&number](double size) -> Vec3 {
    return Vec3(number(-size, size), number(-size, size), number(-size, size));
  };
  World world;
  world.set_gravity(Vec3::Zero());
  std::vector<BodyId> bodies;
  std::vector<Vec3> places;
  const int count = 3 + seed % 6;
  const Vec3 spin = vector(6), drift = vector(2);
  for (int i = 0; i < count; ++i) {
    const int to = i == 0 ? 0 : static_cast<int>(random() % i);
    const Vec3 step = vector(0.5), p = i == 0 ? Vec3::Zero() : Vec3(places[to] + step);
    const double mass = std::pow(10, number(-1, 3));
    bodies.push_back(world.add_body({.mass = MassProperties::box(Vec3(0.3, 0.2, 0.1), mass),
                                     .pose = {.q = exp_so3(vector(3)), .p = p},
                                     .twist = {spin, drift + spin.cross(p) + vector(0.5)}}));
    places.push_back(p);
    if (i == 0) continue;
    const BodyId a = bodies[to], b = bodies[i];
    const Vec3 at = p - 0.5 * step + vector(0.1), axis = vector(1).normalized();
    Vec3 u, v;
    complete_frame(axis, u, v);
    switch (random() % 7) {
      case 0: {
        const AxisId angle{world.add("", Hinge::at(world, a, b, at, axis)), 0};
        world.set_limits(angle, AxisLimits{.lower = -0.3, .upper = 0.2});
        world.set_friction(angle, AxisFriction{0.1});
        break;
      }
      case 1:
        world.add("", Universal::at(world, a, b, at, u, v));
        break;
      case 2:
        world.add("", Planar::at(world, a, b, at, axis, u));
        break;
      case 3:
        world.add("", Distance::between(world, a, b, at, p + vector(0.1)));
        break;
      case 4:
        world.add("", Cylindrical::at(world, a, b, at, axis));
        break;
      default:
        world.add("", Ball::at(world, a, b, at));
    }
  }
  return world;
}

TEST(RobustMomentum, OfFreeMechanismsIsKeptAtLargeSteps) {
  int stiff = 0;
  for (int seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    World world = random_mechanism(seed);
    const Kept kept = run(world, 1.0 / 60, 90);
    stiff += kept.tension > 2;
    EXPECT_LE(kept.linear, 1e-12);
    EXPECT_LE(kept.angular, 1e-12);
    EXPECT_LE(kept.energy, 1e-3);
    EXPECT_LE(kept.gap, 1e-9);
  }
  EXPECT_GE(stiff, 5);
}

/// A heavy and a light ball on a chain of light links, whirling, and a ball that hits it.
TEST(RobustMomentum, IsSharedByWhatTouches) {
  World world;
  world.set_gravity(Vec3::Zero());
  BodyId last = kGround;
  const double length = 0.2;
  for (int i = 0; i < 6; ++i) {
    const double mass = i == 0 ? 100 : i == 5 ? 10 : 0.01;
    const Vec3 p(length * i, 0, 0);
    const BodyId link = world.add_body({.mass = MassProperties::sphere(0.08, mass),
                                        .pose = {.p = p},
                                        .twist = {Vec3(0, 0, 8), Vec3(0, 8, 0) * p.x()}});
    world.add_shape(link, Sphere{0.08}, {},
                    {.restitution = 0.5, .static_friction = 0.5, .dynamic_friction = 0.5});
    if (i > 0) world.add("", Ball::at(world, last, link, p - Vec3(0.5 * length, 0, 0)));
    last = link;
  }
  const BodyId ball = world.add_body({.mass = MassProperties::sphere(0.1, 5),
                                      .pose = {.p = {1.05, 0.5, 0.03}},
                                      .twist = {Vec3(0, 3, 0), Vec3(-1, -2, 0)}});
  world.add_shape(ball, Sphere{0.1}, {}, {.static_friction = 0.5, .dynamic_friction = 0.5});
  const Kept kept = run(world, 1.0 / 100, 100);
  EXPECT_GT(kept.tension, 2);
  EXPECT_GT(kept.contacts, 0);
  EXPECT_LE(kept.linear, 1e-12);
  EXPECT_LE(kept.angular, 1e-11);  // contacts act at two points, a gap apart
  EXPECT_LE(kept.energy, 1e-3);
}

}  // namespace
}  // namespace taut::robust_momentum_test
