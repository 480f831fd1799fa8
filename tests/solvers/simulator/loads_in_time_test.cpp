#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/joints/joints.h"
#include "core/state/motion.h"
#include "core/world/diagnostics.h"
#include "solvers/simulator/simulator.h"

// Loads that vary in time, against closed forms.
namespace taut::loads_in_time_test {
namespace {

constexpr double kPi = std::numbers::pi;

/// Each function's rate and acceleration are the derivatives of its value, where it has them.
TEST(FunctionsOfTime, HaveTheirDerivatives) {
  const Curve table({{0, 1}, {0.5, 3}, {2, -1}});
  const std::pair<const char*, Motion> functions[] = {
      {"harmonics", harmonics_motion(0.5, {{2, 3, 0.1}, {-0.5, 7, 1}})},
      {"harmonic", harmonic_motion(0.5, 2, 3, 0.1)},
      {"table", table_motion(table)},
      {"periodic", table_motion(table, true)},
      {"ramp", ramp_motion(1, 4, 0.3, 1.1)},
      {"smooth ramp", ramp_motion(1, 4, 0.3, 1.1, true)},
      {"gust", gust_motion(3, 0.2, 1.4)},
  };
  for (const auto& [name, f] : functions)
    for (const double t : {-0.71, 0.11, 0.41, 0.77, 1.33, 1.83, 2.63, 5.21}) {
      const double h = 1e-5;
      const MotionPoint at = f(t), before = f(t - h), after = f(t + h);
      EXPECT_NEAR(at.rate, (after.value - before.value) / (2 * h), 1e-7) << name << ' ' << t;
      EXPECT_NEAR(at.acceleration, (after.rate - before.rate) / (2 * h), 1e-6) << name << ' ' << t;
    }
}

TEST(FunctionsOfTime, AreWhatTheySay) {
  const Motion periodic = table_motion(Curve({{1, 0}, {2, 4}, {4, 0}}), true);
  for (const double turns : {-300.0, -3.0, 0.0, 6.0, 3e6}) {
    EXPECT_NEAR(periodic(1.25 + turns).value, 1, 1e-8) << turns;
    EXPECT_NEAR(periodic(3 + turns).value, 2, 1e-8) << turns;
  }
  const Motion saw = table_motion(Curve({{0, 0}, {1, 1}}), true);
  EXPECT_EQ(saw(7).value, 0);  // at the jump that of the first point
  EXPECT_NEAR(saw(6.999).value, 0.999, 1e-12);
  const Motion held = table_motion(Curve({{1, 5}, {2, 7}}));
  EXPECT_EQ(held(-3).value, 5);
  EXPECT_EQ(held(9).value, 7);
  EXPECT_EQ(held(9).rate, 0);
  EXPECT_EQ(ramp_motion(1, 3, 2, 4)(4).value, 2);
  EXPECT_NEAR(ramp_motion(1, 3, 2, 4, true)(4).value, 2, 1e-15);
  EXPECT_EQ(ramp_motion(1, 3, 2, 4, true)(1).value, 1);
  EXPECT_EQ(ramp_motion(1, 3, 2, 4, true)(7).value, 3);
  EXPECT_NEAR(gust_motion(3, 1, 2)(2).value, 3, 1e-15);
  EXPECT_EQ(gust_motion(3, 1, 2)(3).value, 0);
  EXPECT_EQ(gust_motion(3, 1, 2)(0.5).value, 0);
  EXPECT_THROW((void)ramp_motion(0, 1, 0, 0), std::invalid_argument);
  EXPECT_THROW((void)gust_motion(1, 0, -1), std::invalid_argument);
  EXPECT_THROW((void)gust_motion(std::nan(""), 0, 1), std::invalid_argument);
  EXPECT_THROW((void)table_motion(Curve({{1, 5}}), true), std::invalid_argument);
  EXPECT_THROW((void)harmonics_motion(0, {{1, INFINITY, 0}}), std::invalid_argument);
}

/// m ẍ + k x = F sin ωt from rest: x = F/(m (ω₀² − ω²)) (sin ωt − ω/ω₀ sin ω₀t), by a point force, a field of
/// acceleration, and a shaken frame as the opposite field; the error is of order 2.
TEST(LoadsInTime, DriveAnOscillatorWithOrder2) {
  const double m = 2, k = 50, F = 3, omega = 3.3, natural = std::sqrt(k / m), end = 2;
  const double exact = F / (m * (natural * natural - omega * omega)) *
                       (std::sin(omega * end) - omega / natural * std::sin(natural * end));
  for (const bool field : {false, true}) {
    const auto error = [&](double h) {
      World world;
      world.set_gravity(Vec3::Zero());
      const BodyId cart = world.add_body({.mass = MassProperties(m, Vec3(1, 1, 1))});
      const JointId rail = world.add("rail", Slider::at(world, kGround, cart, Vec3::Zero(), Vec3::UnitX()));
      world.set_spring(world.axis(rail, "displacement"), AxisSpring{.stiffness = k});
      const Motion factor = harmonics_motion(0, {{0.25, omega, 0}, {0.75, omega, 0}});
      if (field)
        world.add_force(AccelerationField({{cart, m}}, Vec3(F / m, 0, 0), factor));
      else
        world.add_force(PointForce(cart, Vec3::Zero(), Vec3(F, 0, 0), false, factor));
      Simulator simulator(world);
      const RunReport run = simulator.run_until(end, h);
      EXPECT_TRUE(run.exact()) << run.last.message;
      return world.pose(cart).p.x() - exact;
    };
    const double coarse = error(0.02), fine = error(0.01);
    EXPECT_NEAR(coarse / fine, 4, 0.15);
    EXPECT_LT(std::abs(fine), 2e-3 * std::abs(exact));
  }
}

/// Impulse ½ peak · duration; the trapezoidal rule is exact for a gust of whole steps.
TEST(LoadsInTime, AGustHasItsImpulse) {
  World world;
  world.set_gravity(Vec3::Zero());
  const BodyId body = world.add_body({.mass = MassProperties(2, Vec3(0.5, 0.5, 0.5))});
  world.add_force(PointForce(body, Vec3::Zero(), Vec3(4, 0, 0), false, gust_motion(3, 0.2, 0.5)));
  world.add_force(BodyTorque(body, Vec3(0, 0, 4), false, gust_motion(3, 0.2, 0.5)));
  Simulator simulator(world);
  double forces = 0;
  for (int i = 0; i < 100; ++i) {
    const StepReport& report = simulator.step(0.01);
    ASSERT_TRUE(report.exact());
    forces += report.ledger.forces;  // they have no potential
    EXPECT_NEAR(report.ledger.integration, 0, 1e-12);
  }
  EXPECT_NEAR(world.twist(body).v.x(), 0.5 * 12 * 0.5 / 2, 1e-13);
  EXPECT_NEAR(world.twist(body).w.z(), 0.5 * 12 * 0.5 / 0.5, 1e-13);
  EXPECT_NEAR(forces, kinetic_energy(world, world.state()), 1e-12);
}

/// Without a factor a field is gravity by another name: the same motion, the same energy.
TEST(LoadsInTime, AConstantFieldIsConservative) {
  World field, gravity;
  for (World* world : {&field, &gravity}) {
    world->set_gravity(Vec3::Zero());
    const BodyId bob =
        world->add_body({.mass = MassProperties(2, Vec3(0.1, 0.2, 0.3)), .pose = {.p = Vec3(1, 0, 0)}});
    world->add("pin", Ball::at(*world, kGround, bob, Vec3::Zero()));
  }
  gravity.set_gravity(Vec3(1, 2, -9));
  field.add_force(AccelerationField({{BodyId{1}, 2}}, Vec3(1, 2, -9)));
  EXPECT_EQ(field.potential_energy(field.state()), gravity.potential_energy(gravity.state()));
  EXPECT_FALSE(field.has_dissipative_forces());
  Simulator one(field), other(gravity);
  ASSERT_TRUE(one.run_until(1, 0.01).exact());
  ASSERT_TRUE(other.run_until(1, 0.01).exact());
  EXPECT_NEAR((field.pose(BodyId{1}).p - gravity.pose(BodyId{1}).p).norm(), 0, 1e-12);
}

/// A world that is appended, turned by 90°, takes its loads along.
TEST(LoadsInTime, GoWithAWorldThatIsAppended) {
  World part;
  part.set_gravity(Vec3::Zero());
  const BodyId bob = part.add_body({.name = "bob", .mass = MassProperties(2, Vec3(0.1, 0.2, 0.3))});
  part.add_force(AccelerationField({{bob, 2}}, Vec3(1, 0, 0), ramp_motion(0, 1, 0, 1)));
  part.add_force(PointForce(bob, Vec3::Zero(), Vec3(2, 0, 0), false, ramp_motion(0, 1, 0, 1)));
  part.add_force(BodyTorque(bob, Vec3(0, 0.2, 0), false, ramp_motion(0, 1, 0, 1)));
  World whole;
  whole.set_gravity(Vec3::Zero());
  whole.append(part, "p/", {exp_so3(Vec3(0, 0, kPi / 2)), Vec3(5, 0, 0)});
  State state = whole.state();
  state.time = 0.5;
  std::vector<Wrench> wrenches(whole.body_count());
  whole.forces(state, wrenches);
  const Wrench& on_bob = wrenches[whole.body("p/bob").index];
  EXPECT_NEAR((on_bob.force - Vec3(0, 2, 0)).norm(), 0, 1e-14);
  EXPECT_NEAR((on_bob.torque - Vec3(-0.1, 0, 0)).norm(), 0, 1e-14);
}

TEST(LoadsInTime, BadOnesAreRefused) {
  EXPECT_THROW(AccelerationField({{BodyId{1}, -1}}, Vec3::Zero()), std::invalid_argument);
  EXPECT_THROW(AccelerationField({}, Vec3(0, NAN, 0)), std::invalid_argument);
  World world;
  EXPECT_THROW(world.add_force(AccelerationField({{BodyId{7}, 1}}, Vec3::Zero())), std::invalid_argument);
  const BodyId body = world.add_body({.mass = MassProperties(1, Vec3(1, 1, 1))});
  world.add_force(PointForce(body, Vec3::Zero(), Vec3(1, 0, 0), false, [](double t) {
    return MotionPoint{t > 0.5 ? NAN : 1.0, 0, 0};
  }));
  Simulator simulator(world);
  const RunReport run = simulator.run_until(1, 0.1);
  EXPECT_EQ(run.last.status, Status::kNotFinite);
}

}  // namespace
}  // namespace taut::loads_in_time_test
