#include "solvers/integrators/reduced/reduced_coordinates.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/joints/joints.h"
#include "core/state/motion.h"
#include "core/world/diagnostics.h"
#include "scenes/builders/scene.h"
#include "solvers/simulator/simulator.h"
#include "tests/core/random_state.h"
#include "tests/solvers/integrators/reduced/reduced_runs.h"

namespace taut::reduced_coordinates_test {
namespace {

using namespace testing;

MassProperties uneven_mass(double mass = 1) {
  return MassProperties(mass, Vec3(mass * Vec3(0.04, 0.09, 0.11)));
}

/// Two bodies of three different moments in space, off their principal axes: a ball joint, then a hinge, with
/// velocities that they allow.
World double_pendulum() {
  World world;
  const BodyId a = world.add_body({.name = "a",
                                   .mass = uneven_mass(),
                                   .pose = {.q = exp_so3(Vec3(0.3, -0.2, 0.4)), .p = {0.4, 0.1, -0.3}}});
  const BodyId b = world.add_body({.name = "b",
                                   .mass = uneven_mass(0.7),
                                   .pose = {.q = exp_so3(Vec3(-0.5, 0.1, 0.2)), .p = {0.9, 0.3, -0.6}}});
  world.add("ball", Ball::at(world, kGround, a, Vec3::Zero()));
  const Vec3 at(0.7, 0.2, -0.4), axis = Vec3(0.2, 1, 0.3).normalized();
  world.add("hinge", Hinge::at(world, a, b, at, axis));
  const Vec3 w(0.8, -0.5, 0.6), turn = w + 1.1 * axis;
  world.set_twist(a, {w, w.cross(world.pose(a).p)});
  world.set_twist(b, {turn, w.cross(at) + turn.cross(world.pose(b).p - at)});
  return world;
}

/// RATTLE of order 8 is another formulation; at 2.5 ms its error is round-off.
TEST(ReducedCoordinates, HaveTheirOrders) {
  World truth = double_pendulum();
  run(truth, fine_settings(Integrator::kRattle8), 1, 400);
  EXPECT_NEAR(order_towards(truth, double_pendulum(), fine_settings(Integrator::kRecursive), 1, 100), 4,
              0.15);
  EXPECT_NEAR(order_towards(truth, double_pendulum(), fine_settings(Integrator::kLagrangian), 1, 100), 4,
              0.15);
  EXPECT_NEAR(order_towards(truth, double_pendulum(), fine_settings(Integrator::kRecursiveMidpoint), 1, 100),
              2, 0.05);
  EXPECT_NEAR(order_towards(truth, double_pendulum(), fine_settings(Integrator::kLagrangianMidpoint), 1, 100),
              2, 0.05);
}

/// The same accelerations, to round-off that the pendulum has made larger.
TEST(ReducedCoordinates, RecursionAndLagrangeGoTheSameWay) {
  World recursive = double_pendulum(), lagrangian = double_pendulum();
  run(recursive, fine_settings(Integrator::kRecursive), 1, 100);
  run(lagrangian, fine_settings(Integrator::kLagrangian), 1, 100);
  EXPECT_LE(distance(recursive, lagrangian), 1e-11);
}

/// With the default settings, through the crack of the whip at 1.35 s: thin rods under high tension, where
/// round-off of the recursion would show.
TEST(ReducedCoordinates, AChainStaysClosed) {
  Scene scene = build_scene("chain", {{"n", 100}});
  scene.settings = {};
  scene.settings.integrator = Integrator::kRecursive;
  Simulator simulator(scene.world, scene.settings);
  const double start = total_energy(scene.world, scene.world.state());
  double widest = 0, fastest = 0, spin = 0;
  for (int i = 0; i < 300; ++i) {
    ASSERT_TRUE(simulator.step(0.005).exact()) << simulator.report().message;
    widest = std::max({widest, simulator.report().gap.metres, simulator.report().gap.radians});
    for (int b = 1; b < scene.world.body_count(); ++b) {
      const Vec3 along = rotate(scene.world.pose({b}).q, Vec3::UnitX());
      spin = std::max(spin, std::abs(scene.world.twist({b}).w.dot(along)));
      fastest = std::max(fastest, scene.world.twist({b}).w.norm());
    }
  }
  EXPECT_LE(widest, 1e-10);
  EXPECT_GT(fastest, 50);  // it has cracked
  EXPECT_LE(spin, 1e-7);   // nothing turns a rod about its axis
  EXPECT_LE(std::abs(total_energy(scene.world, scene.world.state()) - start), 1e-3 * scene.energy_scale);
}

/// 50 s: energy is off by as much in the last fifth as in the first, with what chaos makes of it.  That of
/// Runge–Kutta of the same order would go one way.
TEST(ReducedCoordinates, TheMidpointRuleKeepsEnergyBounded) {
  World world = double_pendulum();
  Simulator simulator(world, fine_settings(Integrator::kRecursiveMidpoint));
  const double start = total_energy(world, world.state());
  double early = 0, late = 0;
  for (int i = 0; i < 10000; ++i) {
    ASSERT_TRUE(simulator.step(0.005).exact()) << simulator.report().message;
    const double off = std::abs(total_energy(world, world.state()) - start);
    if (i < 2000) early = std::max(early, off);
    if (i >= 8000) late = std::max(late, off);
  }
  EXPECT_GT(early, 1e-5);
  EXPECT_LE(late, 10 * early);
  EXPECT_LE(late, 0.01);
}

TEST(ReducedCoordinates, TheMidpointRuleIsReversible) {
  for (const Integrator integrator : {Integrator::kRecursiveMidpoint, Integrator::kLagrangianMidpoint}) {
    const World start = double_pendulum();
    World world = start;
    run(world, fine_settings(integrator), 2, 100);
    EXPECT_GT(distance(world, start), 0.1);
    for (int b = 1; b < world.body_count(); ++b)
      world.set_twist({b}, {-world.twist({b}).w, -world.twist({b}).v});
    run(world, fine_settings(integrator), 2, 100);
    EXPECT_LE(distance(world, start), 1e-9);  // 200 steps to 1e-13, which the pendulum makes larger
  }
}

/// m ẍ = −k (x − x₀) − c ẋ − d ẋ, as e^{−δt} (cos ωt + δ/ω sin ωt).
TEST(ReducedCoordinates, SpringsAndDampersAsInClosedForm) {
  for (const Integrator integrator : kReduced) {
    World world;
    world.set_gravity(Vec3::Zero());
    const BodyId body = world.add_body({.mass = uneven_mass(2), .pose = {.p = {1, 0, 0}}});
    const JointId slider =
        world.add("slider", Slider::at(world, kGround, body, Vec3::UnitX(), Vec3::UnitX()));
    const AxisId axis = world.axis(slider, "displacement");
    world.set_spring(axis, AxisSpring{.stiffness = 50, .damping = 0.7, .rest = 0.3});
    world.set_friction(axis, AxisFriction{.viscous = 0.5});
    Simulator simulator(world, fine_settings(integrator));
    double work = 0;
    for (int i = 0; i < 400; ++i) {
      ASSERT_TRUE(simulator.step(0.0025).exact());
      work += simulator.axis_report(axis).work.damping;
      EXPECT_NEAR(simulator.report().ledger.damping, simulator.axis_report(axis).work.damping, 1e-14);
    }
    const double delta = 1.2 / 4, omega = std::sqrt(25 - delta * delta);
    const double x = 0.3 - 0.3 * std::exp(-delta) * (std::cos(omega) + delta / omega * std::sin(omega));
    const bool midpoint =
        integrator == Integrator::kRecursiveMidpoint || integrator == Integrator::kLagrangianMidpoint;
    const double tolerance = midpoint ? 5e-5 : 1e-9;  // h² ω³/12 · 0.3, h⁴ ω⁵/120 · 0.3
    EXPECT_NEAR(world.axis_value(axis), x, tolerance);
    const double energy = world.spring_energy(world.state()) + kinetic_energy(world, world.state());
    EXPECT_NEAR(work, energy - 0.5 * 50 * 0.09, 100 * tolerance);
    const double force = -50 * (world.axis_value(axis) - 0.3) - 1.2 * world.axis_rate(axis);
    EXPECT_NEAR(simulator.reaction(slider).force.x(), force, 1e-9);
  }
}

/// Forces along the axis of the hinge with kinks, and a spring to the ground.
World servo_arm() {
  World world = double_pendulum();
  const AxisId angle = world.axis(world.joint("hinge"), "angle");
  world.set_motor(angle, AxisMotor{.mode = AxisMotor::Mode::kPosition,
                                   .target = 0.8,
                                   .max_force = 3,
                                   .stiffness = 20,
                                   .damping = 0.5});
  world.set_limits(angle, AxisLimits{.lower = -0.1, .upper = 0.3, .compliance = 0.02});
  world.add_force(SpringDamper(kGround, world.body("b"), Vec3(1, 1, 1), Vec3(0.1, 0, 0), 8, 0.5, 0.2));
  return world;
}

TEST(ReducedCoordinates, ServosSoftLimitsAndSpringsAsRattle) {
  World truth = servo_arm();
  run(truth, fine_settings(Integrator::kRattle), 1, 20000);
  World world = servo_arm();
  const AxisId angle = world.axis(world.joint("hinge"), "angle");
  Simulator simulator(world, fine_settings(Integrator::kRecursive));
  bool saturated = false, beyond = false;
  for (int i = 0; i < 1000; ++i) {
    ASSERT_TRUE(simulator.step(0.001).exact());
    saturated = saturated || simulator.axis_report(angle).saturated;
    beyond = beyond || simulator.axis_report(angle).force.elastic_limit != 0;
  }
  EXPECT_TRUE(saturated && beyond);
  EXPECT_LE(distance(world, truth), 5e-5);  // of order 2 where a force has a kink
}

/// Present and mean forces of joints against those of RATTLE, whose error is h² of them.
TEST(ReducedCoordinates, ReactionsAsThoseOfRattle) {
  const auto reactions_of = [](Integrator integrator) {
    World world = double_pendulum();
    Simulator simulator(world, fine_settings(integrator));
    for (int i = 0; i < 1000; ++i) EXPECT_TRUE(simulator.step(2e-4).exact());
    std::vector<Reaction> reactions;
    for (const char* name : {"ball", "hinge"}) {
      reactions.push_back(simulator.reaction(world.joint(name)));
      reactions.push_back(simulator.mean_reaction(world.joint(name)));
    }
    return reactions;
  };
  const std::vector<Reaction> truth = reactions_of(Integrator::kRattle);
  for (const Integrator integrator : kReduced) {
    const std::vector<Reaction> found = reactions_of(integrator);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      EXPECT_LE((found[i].force - truth[i].force).norm(), 1e-5) << i;
      EXPECT_LE((found[i].torque - truth[i].torque).norm(), 1e-5) << i;
      EXPECT_GT(truth[i].force.norm(), 1) << i;
    }
  }
}

/// A hinge that follows the time, below a ball joint.
World driven() {
  World world = double_pendulum();
  const AxisId angle = world.axis(world.joint("hinge"), "angle");
  world.add("driver", Driver(world, angle, harmonic_motion(0, 0.4, 3)));
  return world;
}

TEST(ReducedCoordinates, DriversMoveTheirAxesAndDoTheirWork) {
  World truth = driven();
  run(truth, fine_settings(Integrator::kRattle8), 1, 400);
  World world = driven();
  Simulator simulator(world, fine_settings(Integrator::kRecursive));
  ASSERT_TRUE(simulator.step(0.001).exact()) << simulator.report().message;
  double drivers = 0, unexplained = 0;
  const double start = total_energy(world, world.state());
  for (int i = 1; i < 1000; ++i) {
    ASSERT_TRUE(simulator.step(0.001).exact());
    drivers += simulator.report().ledger.drivers;
    unexplained += std::abs(simulator.report().ledger.integration);
  }
  EXPECT_LE(distance(world, truth), 1e-8);
  EXPECT_GT(std::abs(drivers), 0.1);
  EXPECT_NEAR(total_energy(world, world.state()) - start, drivers, 1e-8);
  EXPECT_LE(unexplained, 1e-8);
}

/// A tree that hangs on nothing: P exactly but for what closing moves, which is the error of the step.
TEST(ReducedCoordinates, AFloatingBaseKeepsItsMomenta) {
  for (const bool midpoint : {false, true}) {
    const auto lost = [&](int steps) {
      testing::Random random(3);
      World world;
      world.set_gravity(Vec3::Zero());
      BodyId last = world.add_body({.mass = uneven_mass(), .pose = {}, .twist = random.twist()});
      for (int i = 0; i < 4; ++i) {
        const Vec3 at = world.pose(last).p + random.vector(0.3);
        const BodyId next = world.add_body(
            {.mass = uneven_mass(), .pose = {random.rotation(), at + random.vector(0.3)}, .twist = {}});
        if (i % 2 == 0)
          world.add("", Ball::at(world, last, next, at));
        else
          world.add("", Hinge::at(world, last, next, at, random.unit()));
        last = next;
      }
      Simulator simulator(world,
                          fine_settings(midpoint ? Integrator::kRecursiveMidpoint : Integrator::kRecursive));
      EXPECT_TRUE(simulator.step(1e-9).exact());  // what the joints forbid is gone
      const Vec3 P = simulator.report().linear_momentum, L = simulator.report().angular_momentum;
      EXPECT_GT(P.norm() + L.norm(), 0.3);
      for (int i = 0; i < steps; ++i) EXPECT_TRUE(simulator.step(1.0 / steps).exact());
      return (simulator.report().linear_momentum - P).norm() +
             (simulator.report().angular_momentum - L).norm();
    };
    const double coarse = lost(100), fine = lost(200);
    EXPECT_LE(coarse, midpoint ? 1e-2 : 1e-5);
    EXPECT_GT(std::log2(coarse / fine), midpoint ? 1.7 : 3.7);
  }
}

/// Velocities that joints forbid are taken away as by an impact, as RATTLE does.
TEST(ReducedCoordinates, StartsFromForbiddenVelocities) {
  World truth = double_pendulum();
  truth.set_twist(truth.body("b"), {Vec3(1, 2, 3), Vec3(-1, 0, 2)});
  World world = truth;
  Simulator one(truth, fine_settings(Integrator::kRattle8)),
      other(world, fine_settings(Integrator::kRecursive));
  ASSERT_TRUE(one.step(1e-3).exact());
  ASSERT_TRUE(other.step(1e-3).exact());
  EXPECT_LE(distance(world, truth), 1e-10);
  EXPECT_NEAR(other.report().ledger.stabilisation, one.report().ledger.stabilisation, 1e-8);
  EXPECT_LT(other.report().ledger.stabilisation, -0.1);
}

std::string refusal(const World& world, bool contacts = false) {
  for (const Integrator integrator : kReduced) {
    World copy = world;
    Settings settings = fine_settings(integrator);
    settings.contacts = contacts;
    try {
      Simulator simulator(copy, settings);
      return {};
    } catch (const std::invalid_argument& error) {
      if (integrator == Integrator::kLagrangianMidpoint) return error.what();
    }
  }
  return {};
}

void expect_refused(const World& world, std::initializer_list<const char*> words, bool contacts = false) {
  const std::string message = refusal(world, contacts);
  for (const char* word : words) EXPECT_NE(message.find(word), std::string::npos) << word << ": " << message;
}

TEST(ReducedCoordinates, RefuseByNameWhatTheyDoNotHave) {
  EXPECT_EQ(refusal(servo_arm()), "");
  const auto with = [](auto change) {
    World world = double_pendulum();
    change(world, world.joint("hinge"), world.axis(world.joint("hinge"), "angle"));
    return world;
  };
  expect_refused(with([](World& w, JointId, AxisId a) {
                   w.set_motor(a, AxisMotor{.mode = AxisMotor::Mode::kPosition, .target = 1});
                 }),
                 {"hinge", "motor that brakes", "angle"});
  expect_refused(with([](World& w, JointId, AxisId a) { w.set_friction(a, AxisFriction{.per_load = 0.1}); }),
                 {"hinge", "friction that grows", "angle"});
  expect_refused(with([](World& w, JointId, AxisId) {
                   const JointId rope = w.add(
                       "rope", Rope::between(w, kGround, w.body("b"), Vec3(2, 0, 0), Vec3(0.9, 0.3, -0.6)));
                   w.set_motor(w.axis(rope, "length"), AxisMotor::winch(-0.1));
                 }),
                 {"rope", "winch", "length"});
  expect_refused(
      with([](World& w, JointId j, AxisId) { w.set_compliance(j, JointCompliance{.translation = 1e-6}); }),
      {"hinge", "compliance"});
  expect_refused(with([](World& w, JointId j, AxisId) { w.set_break(j, BreakLimits{.force = 10}); }),
                 {"hinge", "break"});
  expect_refused(with([](World& w, JointId, AxisId) { w.add_shape(w.body("a"), Sphere{0.1}); }), {"contacts"},
                 true);
}

TEST(ReducedCoordinates, GoOnFromACheckpointWithTheSameBits) {
  const auto sprung = [] {
    World world = driven();
    world.set_spring(world.axis(world.joint("hinge"), "angle"), AxisSpring{.stiffness = 2, .damping = 0.1});
    return world;
  };
  for (const Integrator integrator : kReduced)
    expect_checkpoints_keep_bits(
        sprung, fine_settings(integrator), 0.003, 20,
        [](const World& whole, Simulator& uninterrupted, const World& second, Simulator& after) {
          EXPECT_EQ(uninterrupted.mean_reaction(whole.joint("ball")).force,
                    after.mean_reaction(second.joint("ball")).force);
        });
}

/// The fixed point contracts for h ω/2 < 1 only: a step that is longer fails with a status, and leaves the
/// world alone.
TEST(ReducedCoordinates, AMidpointThatDoesNotContractIsAStatus) {
  World world;
  const BodyId body = world.add_body({.mass = uneven_mass(), .pose = {.p = {1, 0, 0}}});
  const JointId slider = world.add("slider", Slider::at(world, kGround, body, Vec3::UnitX(), Vec3::UnitX()));
  world.set_spring(world.axis(slider, "displacement"), AxisSpring{.stiffness = 1e8, .rest = 0.1});
  Settings settings = fine_settings(Integrator::kRecursiveMidpoint);
  settings.max_substeps = 4;
  Simulator simulator(world, settings);
  EXPECT_EQ(simulator.step(0.01).status, Status::kNotConverged);
  EXPECT_NE(simulator.report().message.find("midpoint"), std::string::npos) << simulator.report().message;
  EXPECT_EQ(world.pose(body).p, Vec3(1, 0, 0));
  settings.max_substeps = 1024;
  Simulator patient(world, settings);
  EXPECT_TRUE(patient.step(0.01).exact()) << patient.report().message;
  EXPECT_GE(patient.report().substeps, 50);
}

/// A force that is not finite, and a pose far from closed.
TEST(ReducedCoordinates, BadForcesAndPosesAreStatuses) {
  for (const Integrator integrator : kReduced) {
    World world = double_pendulum();
    world.add_force(ForceCallback(
        [](const State& state, std::span<Wrench> wrenches) {
          if (state.time > 0.02) wrenches[1].force.x() = std::nan("");
        },
        false));
    Simulator simulator(world, fine_settings(integrator));
    EXPECT_TRUE(simulator.step(0.01).exact());
    EXPECT_FALSE(simulator.step(0.1).ok());
    EXPECT_EQ(simulator.report().status, Status::kNotFinite);
    EXPECT_NEAR(world.time(), 0.01, 1e-15);

    World open = double_pendulum();
    open.set_pose(open.body("b"), {.q = exp_so3(Vec3(2, 0.3, 0)), .p = {-3, 2, 1}});
    Simulator closing(open, fine_settings(integrator));
    EXPECT_TRUE(closing.step(1e-3).exact()) << closing.report().message;
    EXPECT_LE(closing.report().gap.metres, 1e-10);
  }
}

}  // namespace
}  // namespace taut::reduced_coordinates_test
