#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "core/joints/joints.h"
#include "scenes/files/scene_file.h"
#include "tests/solvers/laws/sliding_block.h"
#include "tests/source_dir.h"

/// Servos, motors that brake, winches and stops against closed forms.
namespace taut::motors_test {
namespace {

using testing::kG;
using testing::run;
using testing::Slide;
using Mode = AxisMotor::Mode;

constexpr Integrator kBoth[] = {Integrator::kRattle, Integrator::kMoreauJean};

Settings with(Integrator integrator) {
  Settings settings;
  settings.integrator = integrator;
  return settings;
}

/// x(t) of m ẍ + d ẋ + k (x − 1) = 0 from rest at 0, ω² = k/m, d = 2 ζ ω m, ζ < 1.
double step_response(double omega, double zeta, double t) {
  const double fast = omega * std::sqrt(1 - zeta * zeta);
  return 1 - std::exp(-zeta * omega * t) * (std::cos(fast * t) + zeta * omega / fast * std::sin(fast * t));
}

double servo_error(double h, double zeta) {
  const double mass = 2, omega = 10;
  Slide s(Vec3::UnitX(), mass);
  s.world.set_motor(s.axis, AxisMotor{.mode = Mode::kPosition,
                                      .target = 1,
                                      .stiffness = mass * omega * omega,
                                      .damping = 2 * zeta * omega * mass});
  Simulator simulator(s.world);
  run(simulator, h, static_cast<int>(std::lround(0.5 / h)));
  return std::abs(s.world.axis_value(s.axis) - step_response(omega, zeta, 0.5));
}

TEST(AxisServo, AnswersAStepOfItsTargetWithTheSecondOrder) {
  for (const double zeta : {0.0, 0.5, 0.9}) {
    const double coarse = servo_error(0.005, zeta), fine = servo_error(0.0025, zeta);
    EXPECT_NEAR(std::log2(coarse / fine), 2, 0.05) << zeta;  // the next term is of order 4: ωh is 1/20
    EXPECT_LE(fine, 2e-3) << zeta;
  }
}

/// The spring of an axis that is damped alike is the same system.
TEST(AxisServo, IsTheSpringAndDamperOfAnAxis) {
  Slide servo(Vec3::UnitX()), spring(Vec3::UnitX());
  servo.world.set_motor(servo.axis,
                        AxisMotor{.mode = Mode::kPosition, .target = 0.3, .stiffness = 200, .damping = 8});
  spring.world.set_spring(spring.axis, AxisSpring{.stiffness = 200, .damping = 8, .rest = 0.3});
  Simulator one(servo.world), other(spring.world);
  run(one, 2e-3, 300);
  run(other, 2e-3, 300);
  EXPECT_NEAR(servo.world.axis_value(servo.axis), spring.world.axis_value(spring.axis), 1e-12);
  EXPECT_NEAR(servo.world.axis_rate(servo.axis), spring.world.axis_rate(spring.axis), 1e-12);
}

TEST(AxisServo, IsStableWithAnyGainsAtAnyStep) {
  for (const Integrator integrator : kBoth)
    for (const double k : {1e-3, 1.0, 1e4, 1e8, 1e12})
      for (const double d : {0.0, 1.0, 1e4, 1e8}) {
        Slide s(Vec3::UnitX());
        s.world.set_motor(s.axis,
                          AxisMotor{.mode = Mode::kPosition, .target = 1, .stiffness = k, .damping = d});
        Simulator simulator(s.world, with(integrator));
        double largest = 0;
        for (int i = 0; i < 300; ++i) {
          ASSERT_TRUE(simulator.step(1.0 / 60).exact()) << k << " " << d << simulator.report().message;
          largest = std::max(largest, std::abs(s.world.axis_value(s.axis) - 1));
        }
        EXPECT_LE(largest, 1 + 1e-9) << k << " " << d;  // never further away than at the start
      }
}

TEST(AxisServo, OfAnyStiffnessIsTheExactMotor) {
  for (const Integrator integrator : kBoth) {
    Slide s(Vec3::UnitZ());
    s.world.set_motor(s.axis, AxisMotor{.mode = Mode::kPosition, .target = 0.5, .stiffness = 1e12});
    Simulator simulator(s.world, with(integrator));
    for (int i = 0; i < 60; ++i) ASSERT_TRUE(simulator.step(1.0 / 60).exact());
    EXPECT_NEAR(s.world.axis_value(s.axis), 0.5, 2 * kG / 1e12 + 1e-9);
    EXPECT_LE(std::abs(s.world.axis_rate(s.axis)), 1e-9);
    // The round-off of 0.5 m, 1e-16, times the stiffness, a few times.
    EXPECT_NEAR(simulator.axis_report(s.axis).force.motor, 2 * kG, 1e-3);
  }
}

/// A force limit far below what the gains ask for: constant acceleration, exactly, and its work in the books.
TEST(AxisServo, GivesNoMoreThanItsForce) {
  for (const Integrator integrator : kBoth) {
    Slide s(Vec3::UnitX());
    s.world.set_motor(
        s.axis,
        AxisMotor{.mode = Mode::kPosition, .target = 100, .max_force = 3, .stiffness = 1e6, .damping = 1e3});
    Simulator simulator(s.world, with(integrator));
    double work = 0;
    for (int i = 0; i < 100; ++i) {
      run(simulator, 0.01, 1);
      work += simulator.report().ledger.motors;
      EXPECT_TRUE(simulator.axis_report(s.axis).saturated);
    }
    EXPECT_NEAR(s.world.axis_rate(s.axis), 1.5, 1e-9);
    EXPECT_NEAR(s.world.axis_value(s.axis), 0.75, 1e-9);
    EXPECT_NEAR(work, 0.5 * 2 * 1.5 * 1.5, 1e-9);
  }
}

/// θ = sin t with the rate as feed-forward: behind by m r̈/k alone, not by d ṙ/k.
TEST(AxisServo, HasTheRateOfATrajectoryAsFeedForward) {
  Slide s(Vec3::UnitX());
  s.world.set_twist(s.block, {Vec3::Zero(), Vec3(1, 0, 0)});
  s.world.set_motor(s.axis, AxisMotor{.mode = Mode::kTrajectory,
                                      .trajectory = harmonic_motion(0, 1, 1),
                                      .stiffness = 2e4,
                                      .damping = 400});
  Simulator simulator(s.world);
  for (int i = 0; i < 3000; ++i) {
    run(simulator, 1e-3, 1);
    ASSERT_NEAR(s.world.axis_value(s.axis), std::sin(s.world.time()), 1.2 * 2 / 2e4) << i;
  }
}

TEST(AxisServo, DampingAloneControlsASpeed) {
  Slide s(Vec3::UnitX());
  s.world.set_motor(s.axis, AxisMotor{.target = 2, .damping = 4});
  Simulator simulator(s.world);
  run(simulator, 1e-3, 500);
  EXPECT_NEAR(s.world.axis_rate(s.axis), 2 * (1 - std::exp(-4 / 2.0 * 0.5)), 1e-6);
}

/// Half of the way with all of the force, half against it: 2 √(d m/F).
TEST(AxisMotorThatBrakes, ArrivesInTheLeastTimeAndStays) {
  for (const Integrator integrator : kBoth)
    for (const double h : {1e-3, 1.0 / 240, 1.0 / 60}) {
      Slide s(Vec3::UnitX(), 1);
      s.world.set_motor(s.axis, AxisMotor{.mode = Mode::kPosition, .target = 0.5, .max_force = 10});
      Simulator simulator(s.world, with(integrator));
      const double least = 2 * std::sqrt(0.5 / 10);
      double arrival = 0, furthest = 0;
      while (s.world.time() < 2) {
        run(simulator, h, 1);
        const double x = s.world.axis_value(s.axis), v = s.world.axis_rate(s.axis);
        furthest = std::max(furthest, x);
        if (std::abs(x - 0.5) > 1e-8 || std::abs(v) > 1e-6) arrival = s.world.time();
      }
      const int after = integrator == Integrator::kRattle ? 3 : 30;  // Moreau–Jean halves what is left
      EXPECT_GE(arrival, least - h) << h;
      EXPECT_LE(arrival, least + after * h) << h;
      EXPECT_LE(furthest - 0.5, integrator == Integrator::kRattle ? 1e-9 : 0.5 * 10 * h * h) << h;
      EXPECT_LE(std::abs(simulator.axis_report(s.axis).force.motor), 1e-6) << h;
    }
}

TEST(AxisMotorThatBrakes, KnowsTheLoadThatDrivesItOn) {
  for (const double direction : {-1.0, 1.0}) {
    Slide s(Vec3::UnitZ());
    s.world.set_motor(s.axis, AxisMotor{.mode = Mode::kPosition, .target = direction, .max_force = 30});
    Simulator simulator(s.world);
    double furthest = 0;
    for (int i = 0; i < 3000; ++i) {
      run(simulator, 1e-3, 1);
      furthest = std::max(furthest, direction * s.world.axis_value(s.axis));
    }
    EXPECT_LE(furthest, 1 + 1e-8) << direction;
    EXPECT_NEAR(s.world.axis_value(s.axis), direction, 1e-9);
    EXPECT_NEAR(simulator.axis_report(s.axis).force.motor, 2 * kG, 1e-6);
  }
}

/// The first hinge of an arm of three rods moves eighty times what its own two bodies weigh.
TEST(AxisMotorThatBrakes, KnowsHowHeavyAnArmIs) {
  for (const Integrator integrator : kBoth) {
    World world;
    world.set_gravity(Vec3::Zero());
    BodyId last = kGround;
    std::vector<AxisId> axes;
    for (int i = 0; i < 3; ++i) {
      const BodyId rod = world.add_body(
          {.mass = MassProperties::box({1, 0.05, 0.05}, 1), .pose = {Quat::Identity(), {i + 0.5, 0, 0}}});
      axes.push_back({world.add("", Hinge::at(world, last, rod, Vec3(i, 0, 0), Vec3::UnitZ())), 0});
      last = rod;
    }
    for (std::size_t i = 0; i < axes.size(); ++i)
      world.set_motor(axes[i], AxisMotor{.mode = Mode::kPosition,
                                         .target = i == 0 ? 1.0 : 0.0,
                                         .max_force = i == 0 ? 10.0 : kUnlimited});
    Simulator simulator(world, with(integrator));
    double furthest = 0, arrival = 0;
    while (world.time() < 4) {
      ASSERT_TRUE(simulator.step(2e-3).exact()) << simulator.report().message;
      furthest = std::max(furthest, world.axis_value(axes[0]));
      if (std::abs(world.axis_value(axes[0]) - 1) > 1e-6) arrival = world.time();
    }
    const double inertia = 27.0 / 3 + 3 * 0.05 * 0.05 / 12;  // one rod of 3 m and 3 kg about its end
    EXPECT_LE(furthest, 1 + (integrator == Integrator::kRattle ? 1e-8 : 1e-5));
    EXPECT_NEAR(arrival, 2 * std::sqrt(1 * inertia / 10), 0.04);
  }
}

TEST(AxisMotorThatBrakes, CatchesUpWithATargetThatMoves) {
  for (const char* name : {"position_motor", "trajectory_motor"}) {
    Scene scene = load_scene_file(testing::source_dir() + "/tests/adversary/" + name + ".json");
    const AxisId axis = scene.world.axis(scene.world.joint("rail"), "displacement");
    const bool moves = std::string(name) == "trajectory_motor";
    Simulator simulator(scene.world, scene.settings);
    double ahead = 0;
    for (int i = 0; i < 2000; ++i) {
      run(simulator, 1e-3, 1);
      const double target = moves ? scene.world.time() : 0.5;
      ahead = std::max(ahead, scene.world.axis_value(axis) - target);
      if (i > 600) {
        ASSERT_NEAR(scene.world.axis_value(axis), target, 1e-8) << name << i;
        ASSERT_NEAR(scene.world.axis_rate(axis), moves ? 1 : 0, 1e-8) << name << i;
      }
    }
    EXPECT_LE(ahead, 1e-8) << name;
  }
}

/// A command that a callback reads acts from the start of the step for which it was given.
TEST(ForceCallbackCommand, ActsInTheStepThatItIsSetFor) {
  for (const Integrator integrator : {Integrator::kRattle, Integrator::kMoreauJean, Integrator::kForceEuler})
    for (const bool by_velocity : {false, true}) {
      World world;
      world.set_gravity(Vec3::Zero());
      const BodyId body = world.add_body({.mass = MassProperties::box({1, 1, 1}, 2)});
      double command = 0;
      world.add_force(ForceCallback(
          [&](const State&, std::span<Wrench> wrenches) { wrenches[1].force += Vec3(command, 0, 0); },
          by_velocity));
      Simulator simulator(world, with(integrator));
      const double h = 0.01;
      for (int i = 0; i < 5; ++i) ASSERT_TRUE(simulator.step(h).exact());
      command = 6;
      for (int i = 0; i < 3; ++i) {
        ASSERT_TRUE(simulator.step(h).exact());
        EXPECT_NEAR(world.twist(body).v.x(), (i + 1) * 6 / 2.0 * h, 1e-14) << i;
      }
      command = 0;
      ASSERT_TRUE(simulator.step(h).exact());
      EXPECT_NEAR(world.twist(body).v.x(), 3 * 6 / 2.0 * h, 1e-14);
    }
}

/// A load of 10 kg on 2 m of rope.
struct Hoist {
  World world;
  BodyId load;
  AxisId length;
  Hoist() {
    load =
        world.add_body({.name = "load", .mass = MassProperties::sphere(0.1, 10), .pose = {.p = {0, 0, -2}}});
    length = {world.add("rope", Rope(kGround, load, Vec3::Zero(), Vec3::Zero(), 2)), 0};
  }
  double height() const { return world.pose(load).p.z(); }
};

TEST(Winch, LiftsWithItsRateAndBooksItsPower) {
  for (const Integrator integrator : kBoth) {
    Hoist hoist;
    hoist.world.set_motor(hoist.length, AxisMotor::winch(-0.5));
    Simulator simulator(hoist.world, with(integrator));
    double work = 0, integration = 0, start = 0;
    for (int i = 0; i < 1000; ++i) {
      run(simulator, 2e-3, 1);
      // The first step, which jumps from rest to the rate, has m g h v/2 of integration.
      if (i == 2) start = hoist.height();
      if (i <= 2) continue;
      work += simulator.report().ledger.motors;
      integration += simulator.report().ledger.unexplained();
      EXPECT_NEAR(hoist.world.twist(hoist.load).v.z(), 0.5, 1e-8);
      EXPECT_NEAR(simulator.axis_report(hoist.length).force.motor, -10 * kG, 1e-6);
      EXPECT_NEAR(simulator.axis_report(hoist.length).power.motor, 10 * kG * 0.5, 1e-6);
    }
    EXPECT_NEAR(hoist.height(), -2 + 0.5 * 2, 2e-3);
    EXPECT_NEAR(work, 10 * kG * (hoist.height() - start), 1e-6);
    EXPECT_NEAR(integration, 0, 1e-6);
    EXPECT_NEAR(let_out(hoist.world, hoist.length), 1, 2e-3);
  }
}

/// Thrown up it flies free; the rope is taken up at the rate of the winch alone, and taut again where the
/// flight comes back to its length.
TEST(Winch, LeavesASlackRopeSlack) {
  for (const Integrator integrator : kBoth) {
    Hoist hoist;
    hoist.world.set_twist(hoist.load, {Vec3::Zero(), Vec3(0, 0, 5)});
    hoist.world.set_motor(hoist.length, AxisMotor::winch(-0.5));
    Simulator simulator(hoist.world, with(integrator));
    run(simulator, 2e-3, 400);
    const double t = 0.8;  // before 2 (5 − 0.5)/g, at which it is taut again
    EXPECT_NEAR(hoist.world.twist(hoist.load).v.z(), 5 - kG * t, 1e-9);
    EXPECT_NEAR(let_out(hoist.world, hoist.length), 2 - 0.5 * t, 1e-9);
    EXPECT_EQ(simulator.axis_report(hoist.length).force.motor, 0);
    run(simulator, 2e-3, 200);
    EXPECT_NEAR(hoist.world.twist(hoist.load).v.z(), 0.5, 1e-8);
    EXPECT_NEAR(-hoist.height(), let_out(hoist.world, hoist.length),
                integrator == Integrator::kRattle ? 1e-9 : 1e-8);
  }
}

/// Too weak for the load it pays out, and hauls in again from there when the load is lighter.
TEST(Winch, SlipsWithItsForce) {
  Hoist hoist;
  hoist.world.set_motor(hoist.length, AxisMotor::winch(-0.5, 80));
  Simulator simulator(hoist.world);
  run(simulator, 2e-3, 100);
  const double fall = kG - 8, v = -fall * 0.2;
  EXPECT_TRUE(simulator.axis_report(hoist.length).saturated);
  EXPECT_NEAR(hoist.world.twist(hoist.load).v.z(), v, 1e-9);
  EXPECT_NEAR(let_out(hoist.world, hoist.length), 2 + 0.5 * fall * 0.04, 1e-9);
  hoist.world.set_motor(hoist.length, AxisMotor::winch(-0.5, 120));
  run(simulator, 2e-3, 1000);
  EXPECT_NEAR(hoist.world.twist(hoist.load).v.z(), 0.5, 1e-8);
}

/// What is let out is a part of the state; without the winch it is the limit of the rope.
TEST(Winch, LeavesItsLengthToTheRopeAndTheState) {
  Hoist hoist;
  hoist.world.set_motor(hoist.length, AxisMotor::winch(-0.5));
  {
    Simulator simulator(hoist.world);
    run(simulator, 2e-3, 500);
  }
  World copy = hoist.world;
  Simulator later(copy);
  run(later, 2e-3, 500);
  EXPECT_NEAR(copy.twist(hoist.load).v.z(), 0.5, 1e-8);
  copy.set_motor(hoist.length, std::nullopt);
  const double length = copy.axis_properties(hoist.length).limits->upper;
  EXPECT_NEAR(length, -copy.pose(hoist.load).p.z(), 1e-8);
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(later.step(2e-3).exact());
  EXPECT_NEAR(copy.pose(hoist.load).p.z(), -length, 1e-9);
}

TEST(Winch, IsForRopesAlone) {
  Slide s(Vec3::UnitX());
  EXPECT_THROW(s.world.set_motor(s.axis, AxisMotor::winch(-1)), std::invalid_argument);
  Hoist hoist;
  EXPECT_THROW(hoist.world.set_motor(hoist.length, AxisMotor{.damping = 3, .pulls_only = true}),
               std::invalid_argument);
  EXPECT_THROW((void)let_out(hoist.world, hoist.length), std::invalid_argument);
}

/// The heavier end falls until the lighter one has come up to its sheave; there the rope holds both.
TEST(RopeStop, HoldsAnEndAtItsGuidePoint) {
  Scene scene = load_scene_file(testing::source_dir() + "/tests/adversary/only_wire.json");
  Simulator simulator(scene.world, scene.settings);
  const JointId wire = scene.world.joint("wire");
  for (int i = 0; i < 1000; ++i) ASSERT_TRUE(simulator.step(2e-3).exact()) << simulator.report().message;
  const AxisId end = scene.world.axis(wire, "span_3");
  EXPECT_NEAR(scene.world.axis_value(end), 0.01, 1e-9);
  EXPECT_TRUE(simulator.axis_report(end).at_limit);
  EXPECT_NEAR(scene.world.axis_value(scene.world.axis(wire, "span_1")), 1.99, 1e-9);
  EXPECT_NEAR(simulator.axis_report(scene.world.axis(wire, "length")).force.limit, -2 * kG, 1e-6);
}

/// A pulley has no stop; the step that fails says which section is used up.
TEST(RopeStop, APulleyThatIsUsedUpIsNamed) {
  Scene scene = load_scene_file(testing::source_dir() + "/tests/adversary/only_pulley.json");
  Simulator simulator(scene.world, scene.settings);
  for (int i = 0; i < 1000 && simulator.step(2e-3).ok(); ++i) {
  }
  EXPECT_FALSE(simulator.report().ok());
  EXPECT_NE(simulator.report().message.find("section 3 of pulley pulley, from sheave to p_b, is used up"),
            std::string::npos)
      << simulator.report().message;
}

}  // namespace
}  // namespace taut::motors_test
