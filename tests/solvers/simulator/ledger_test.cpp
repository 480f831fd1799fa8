#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "core/joints/joints.h"
#include "solvers/simulator/simulator.h"

// The energy ledger with all of its terms at once.
namespace taut::ledger_test {
namespace {

/// One machine for each term, side by side in one world.
struct Works {
  World world;
  JointId weak;
  BodyId thrown, free;

  BodyId block(double x, double z = 0, double mass = 2) {
    return world.add_body({.mass = MassProperties::box(Vec3(0.3, 0.1, 0.1), mass), .pose = {.p = {x, 0, z}}});
  }
  AxisId hinge(BodyId body, double x) {
    return {world.add("", Hinge::at(world, kGround, body, Vec3(x, 0, 0), Vec3::UnitY())), 0};
  }

  Works() {
    const AxisId driven = hinge(block(0.15), 0), led = hinge(block(2.15), 2);
    world.set_motor(driven, AxisMotor{.target = 20, .max_force = 8});
    world.set_friction(driven, AxisFriction{1, 0.6, 0.05});
    world.set_spring(driven, AxisSpring{.stiffness = 3, .damping = 0.1});
    world.add("", Driver(world, led, harmonic_motion(0, 0.5, 4)));

    const BodyId falling = block(4);
    const AxisId drop{world.add("", Slider::at(world, kGround, falling, Vec3(4, 0, 0), Vec3::UnitZ())), 0};
    world.set_limits(drop, AxisLimits{.lower = -0.2, .restitution = 0.5});

    const BodyId soft = block(6);
    world.set_compliance(world.add("", Fixed::at(world, kGround, soft, Vec3(6, 0, 0.1))),
                         JointCompliance{1e-4, 1e-3, 20, 0.5});

    // It breaks under a pull that grows, with a wound spring in it.
    const BodyId torn = block(8.15);
    const AxisId wound = hinge(torn, 8);
    weak = wound.joint;
    world.set_spring(wound, AxisSpring{.stiffness = 5, .rest = 0.5});
    world.set_break(weak, BreakLimits{.force = 60});
    world.add_force(ForceCallback(
        [torn](const State& s, std::span<Wrench> w) { w[torn.index].force.x() += 200 * s.time; }, false));

    // A chain that swings at a step so large that its tension is taken implicitly.
    BodyId last = kGround;
    for (int i = 0; i < 4; ++i) {
      const BodyId link = world.add_body(
          {.mass = MassProperties::box(Vec3(0.1, 0.02, 0.02), 0.05), .pose = {.p = {10.05 + 0.1 * i, 0, 0}}});
      world.add("", Ball::at(world, last, link, Vec3(10 + 0.1 * i, 0, 0)));
      last = link;
    }
    const BodyId bob = block(10.55, 0, 5);
    world.add("", Ball::at(world, last, bob, Vec3(10.4, 0, 0)));

    thrown = block(12);
    free = block(12.3);
    world.set_twist(thrown, {Vec3(1, 2, 3), Vec3(0.5, 0, 2)});
    world.set_twist(free, {Vec3(-1, 0, 2), Vec3(-0.5, 0.4, 2)});
  }
};

TEST(Ledger, ClosesToRoundOffWithAllOfItsTerms) {
  Works works;
  Simulator simulator(works.world, {.tension = TensionPolicy::kImplicit});
  const std::map<std::string, double EnergyLedger::*> terms{{"kinetic", &EnergyLedger::kinetic},
                                                            {"potential", &EnergyLedger::potential},
                                                            {"springs", &EnergyLedger::springs},
                                                            {"motors", &EnergyLedger::motors},
                                                            {"drivers", &EnergyLedger::drivers},
                                                            {"friction", &EnergyLedger::friction},
                                                            {"limits", &EnergyLedger::limits},
                                                            {"damping", &EnergyLedger::damping},
                                                            {"forces", &EnergyLedger::forces},
                                                            {"breaking", &EnergyLedger::breaking},
                                                            {"stabilisation", &EnergyLedger::stabilisation},
                                                            {"stiffness", &EnergyLedger::stiffness},
                                                            {"integration", &EnergyLedger::integration}};
  std::map<std::string, double> largest;
  EnergyLedger sum;
  double first = 0;
  for (int i = 0; i < 250; ++i) {
    if (i == 20) works.world.add("catch", Ball::at(works.world, works.thrown, works.free, Vec3(12.15, 0, 0)));
    const StepReport& r = simulator.step(4e-3);
    ASSERT_TRUE(r.exact()) << i << ": " << r.message;
    if (i == 0) first = r.ledger.start;
    sum += r.ledger;
    // Some hundred terms of up to 1000 J.
    ASSERT_NEAR(r.ledger.start + r.ledger.total(), r.energy(), 1e-11) << i;
    ASSERT_NEAR(r.ledger.change(), r.ledger.total(), 1e-11) << i;
    for (const auto& [name, term] : terms) largest[name] = std::max(largest[name], std::abs(r.ledger.*term));
  }
  EXPECT_NEAR(first + sum.total(), simulator.report().energy(), 1e-10);
  for (const auto& [name, term] : terms) EXPECT_GT(largest[name], 1e-6) << name;
  EXPECT_LT(sum.friction, 0);
  EXPECT_LT(sum.limits, 0);
  EXPECT_LT(sum.damping, 0);
  EXPECT_LT(sum.breaking, 0);
  EXPECT_FALSE(works.world.is_attached(works.weak));
}

/// ½ k x² of a spring of an axis, of a spring between bodies, of a soft limit and of a soft joint, while
/// weight is the potential energy.
TEST(Ledger, HasTheEnergyOfSpringsByItself) {
  World world;
  const auto hang = [&](double x) {
    const BodyId block =
        world.add_body({.mass = MassProperties::box(Vec3(0.1, 0.1, 0.1), 2), .pose = {.p = {x, 0, 0}}});
    return std::pair(
        block, AxisId{world.add("", Slider::at(world, kGround, block, Vec3(x, 0, 0), Vec3::UnitZ())), 0});
  };
  const auto [sprung, axis] = hang(0);
  world.set_spring(axis, AxisSpring{.stiffness = 30, .rest = 0.1});
  const auto [pulled, free] = hang(1);
  world.add_force(SpringDamper(kGround, pulled, Vec3(1, 0, 1), Vec3::Zero(), 50, 0.8, 0.5));
  const auto [limited, bounded] = hang(2);
  world.set_limits(bounded, AxisLimits{.lower = 0, .compliance = 1e-2});
  const BodyId held = world.add_body({.mass = {2, Vec3(1, 1, 1)}, .pose = {.p = {3, 0, 0}}});
  world.set_compliance(world.add("", Ball::at(world, kGround, held, Vec3(3, 0, 0))), JointCompliance{1e-2});
  Simulator simulator(world);
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(simulator.step(2e-3).exact());
    const StepReport& r = simulator.report();
    const auto z = [&](BodyId body) { return world.pose(body).p.z(); };
    const double x[] = {z(sprung) - 0.1, 1 - z(pulled) - 0.8, std::min(0.0, z(limited)), z(held)};
    const double springs = 15 * x[0] * x[0] + 25 * x[1] * x[1] + 50 * (x[2] * x[2] + x[3] * x[3]);
    ASSERT_NEAR(r.spring_energy, springs, 1e-9 * (1 + springs)) << i;
    ASSERT_NEAR(r.potential_energy, 2 * 9.81 * (z(sprung) + z(pulled) + z(limited) + z(held)), 1e-9) << i;
    ASSERT_NEAR(r.ledger.change(), r.ledger.total(), 1e-12) << i;
    ASSERT_LE(r.ledger.damping, 0) << i;
    // All is linear but where the limit is touched.
    ASSERT_LE(std::abs(r.ledger.integration), 1e-3) << i;
    ASSERT_EQ(r.ledger.forces, 0) << i;
  }
}

/// A driver that starts with a rate, while the body rests: making it move is stabilisation, whoever asked for
/// the start.
TEST(Ledger, KnowsOfAStartThatAQuestionHasMade) {
  for (const int question : {0, 1, 2}) {
    World world;
    const BodyId wheel = world.add_body({.mass = {1, Vec3(0.5, 0.5, 0.5)}});
    const AxisId angle{world.add("", Hinge::at(world, kGround, wheel, Vec3::Zero(), Vec3::UnitY())), 0};
    const JointId drive = world.add("", Driver(world, angle, linear_motion(0, 2)));
    Simulator simulator(world);
    if (question == 1) (void)simulator.solver_description();
    if (question == 2) (void)simulator.reaction(drive);
    ASSERT_TRUE(simulator.step(1e-3).exact());
    const StepReport& r = simulator.report();
    EXPECT_NEAR(r.ledger.stabilisation, 0.5 * 0.5 * 4, 1e-12) << question;
    EXPECT_NEAR(r.ledger.start + r.ledger.total(), r.energy(), 1e-13) << question;
    ASSERT_TRUE(simulator.step(1e-3).exact());
    EXPECT_EQ(simulator.report().ledger.stabilisation, 0) << question;
  }
}

}  // namespace
}  // namespace taut::ledger_test
