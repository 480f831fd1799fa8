#include <gtest/gtest.h>

#include <cmath>

#include "core/constraints/rows.h"
#include "core/joints/joints.h"
#include "core/world/diagnostics.h"
#include "solvers/simulator/simulator.h"
#include "tests/core/expect_invalid.h"
#include "tests/core/random_mass.h"
#include "tests/solvers/simulator/merging.h"

// Bodies merged at their fixed joints move as they do with the joints solved.
//
// A free rigid body and the same body in welded pieces are two discretisations of order 2 of one motion: they
// agree exactly only where no piece turns.  Of order 8 they agree to round-off times the length of the run.
namespace taut::merged_motion_test {
namespace {

using testing::expect_invalid;
using testing::merging;
using testing::Random;
using testing::random_mass;
using testing::solving;

/// Bodies that are joined to an earlier one each, by a weld or another joint; some groups have loops of
/// welds.
World random_tree(unsigned seed, bool grounded) {
  Random random(seed);
  World world;
  std::vector<BodyId> bodies;
  for (int i = 0; i < 9; ++i) {
    const Pose pose{random.rotation(), random.vector(1.5)};
    bodies.push_back(world.add_body({.mass = random_mass(random), .pose = pose, .twist = random.twist()}));
    const BodyId body = bodies.back();
    const Vec3 point = 0.5 * (random.vector() + pose.p);
    if (i == 0 && grounded) world.add("", Ball::at(world, kGround, body, point));
    if (i == 0) continue;
    const BodyId other = bodies[i % 3 == 0 ? i / 2 : i - 1];
    if (i % 3 != 0)
      world.add("", Fixed::at(world, i % 2 ? other : body, i % 2 ? body : other, point));
    else if (i % 2)
      world.add("", Hinge::at(world, other, body, point, random.unit()));
    else
      world.add("", Ball::at(world, body, other, point));
  }
  world.add("loop", Fixed::at(world, bodies[3], bodies[5], random.vector()));
  world.add_force(SpringDamper(bodies[1], bodies[7], random.vector(), random.vector(), 20, 0.5, 0.3));
  world.add_force(PointForce(bodies[4], random.vector(), random.vector(5), true));
  world.add_force(ForceCallback([](const State& s, std::span<Wrench> F) {
    for (std::size_t b = 1; b < F.size(); ++b) F[b].torque -= 0.05 * s.twists[b].w;
  }));
  return world;
}

/// Largest difference of poses and twists.
double difference(const World& a, const World& b) {
  double largest = 0;
  for (int i = 0; i < a.body_count(); ++i) {
    const Pose &X = a.pose(BodyId{i}), &Y = b.pose(BodyId{i});
    const Twist &V = a.twist(BodyId{i}), &U = b.twist(BodyId{i});
    for (double d :
         {(X.p - Y.p).norm(), log_so3(X.q * Y.q.conjugate()).norm(), (V.w - U.w).norm(), (V.v - U.v).norm()})
      largest = std::max(largest, d);
  }
  return largest;
}

void run(World& world, const Settings& settings, double h, int steps) {
  Simulator simulator(world, settings);
  for (int i = 0; i < steps; ++i) {
    const StepReport& report = simulator.step(h);
    ASSERT_TRUE(report.exact()) << report.message;
  }
}

TEST(MergedMotion, IsThatOfTheSolvedJoints) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const World start = random_tree(seed, seed % 2 == 0);
    World merged = start, solved = start;
    run(merged, merging(Integrator::kRattle8), 0.005, 40);
    run(solved, solving(Integrator::kRattle8), 0.005, 40);
    // Positions are closed to 1e-10 at each of 17 stages of 40 steps, in bodies that turn at order 1.
    EXPECT_LT(difference(merged, solved), 2e-8) << "seed " << seed;
    EXPECT_GT(difference(merged, start), 0.05);
  }
}

TEST(MergedMotion, DiffersByTheSquareOfTheStep) {
  double before = 0;
  for (int refinement = 0; refinement < 3; ++refinement) {
    const int steps = 50 << refinement;
    World merged = random_tree(3, true), solved = random_tree(3, true);
    run(merged, merging(), 0.2 / steps, steps);
    run(solved, solving(), 0.2 / steps, steps);
    const double now = difference(merged, solved);
    if (refinement > 0) {
      EXPECT_NEAR(before / now, 4, 0.4) << now;
    }
    before = now;
  }
}

TEST(MergedMotion, IsExactWhereNothingTurns) {
  Random random(5);
  World merged;
  std::vector<BodyId> bodies;
  for (int i = 0; i < 5; ++i) {
    bodies.push_back(merged.add_body(
        {.mass = random_mass(random), .pose = random.pose(), .twist = {Vec3::Zero(), Vec3(1, 2, 3)}}));
    if (i > 0) merged.add("", Fixed::at(merged, bodies[i - 1], bodies[i], random.vector()));
  }
  World solved = merged;
  run(merged, merging(), 0.01, 100);
  run(solved, solving(), 0.01, 100);
  EXPECT_LT(difference(merged, solved), 1e-10);  // of the weld's tolerance: the solved one has some
  EXPECT_LT((merged.pose(bodies[4]).p - solved.pose(bodies[4]).p).norm(), 1e-10);
  EXPECT_NEAR(merged.twist(bodies[2]).v.z(), 3 - 9.81, 1e-12);
}

TEST(MergedMotion, IsTheSameBitsTwice) {
  World first = random_tree(8, true), second = random_tree(8, true);
  run(first, merging(), 0.01, 50);
  run(second, merging(), 0.01, 50);
  for (int b = 0; b < first.body_count(); ++b) {
    EXPECT_EQ(first.pose(BodyId{b}).p, second.pose(BodyId{b}).p);
    EXPECT_EQ(first.pose(BodyId{b}).q.coeffs(), second.pose(BodyId{b}).q.coeffs());
    EXPECT_EQ(first.twist(BodyId{b}).w, second.twist(BodyId{b}).w);
  }
}

TEST(MergedMotion, HoldsAllJointsAndBooksItsEnergy) {
  World world = random_tree(4, true);
  Simulator simulator(world, merging());
  double start = 0;
  for (int i = 0; i < 200; ++i) {
    const double before = total_energy(world, world.state());
    const StepReport& report = simulator.step(0.002);
    ASSERT_TRUE(report.exact()) << report.message;
    // The books are those of the world as the user sees it.
    const double after = total_energy(world, world.state()), scale = 1 + std::abs(after);
    EXPECT_NEAR(report.ledger.start, before, 1e-10 * scale);
    EXPECT_NEAR(report.energy(), after, 1e-10 * scale);
    EXPECT_NEAR(report.ledger.total(), after - before, 1e-12 * scale);
    EXPECT_LT((report.linear_momentum - linear_momentum(world, world.state())).norm(), 1e-10);
    EXPECT_LT((report.angular_momentum - angular_momentum(world, world.state())).norm(), 1e-10);
    if (i == 0) {  // random twists of the members are made to fit, which costs energy
      EXPECT_LT(report.ledger.stabilisation, -0.1);
      start = after;
    }
    EXPECT_LT(std::abs(report.ledger.integration), 1e-3 * scale);
  }
  EXPECT_NE(start, 0);
  const Rows rows(world);
  std::vector<double> phi(rows.row_count());
  rows.residual(world.state(), phi);
  const Gap gap = max_gap(rows, phi);
  EXPECT_LT(std::max(gap.metres, gap.radians), 1e-9);
  EXPECT_TRUE(world.validate(1e-9).empty());
}

/// A post that is welded to the ground in two pieces carries a pendulum of two welded pieces.
struct Crane {
  World world;
  BodyId foot, head, rod, bob;
  JointId foot_weld, head_weld, bob_weld;
  AxisId angle;

  Crane() {
    foot = world.add_body({.name = "foot",
                           .mass = MassProperties::box({0.2, 0.2, 1}, 3),
                           .pose = {Quat::Identity(), {0, 0, 0.5}}});
    head = world.add_body({.name = "head",
                           .mass = MassProperties::box({1, 0.2, 0.2}, 2),
                           .pose = {Quat::Identity(), {0.5, 0, 1.1}}});
    rod = world.add_body({.name = "rod",
                          .mass = MassProperties::box({0.1, 0.1, 0.8}, 1),
                          .pose = {Quat::Identity(), {1, 0, 0.7}}});
    bob = world.add_body(
        {.name = "bob", .mass = MassProperties::sphere(0.1, 4), .pose = {Quat::Identity(), {1, 0, 0.3}}});
    foot_weld = world.add("foot weld", Fixed::at(world, kGround, foot, Vec3::Zero()));
    head_weld = world.add("head weld", Fixed::at(world, foot, head, Vec3(0, 0, 1)));
    angle = {world.add("hinge", Hinge::at(world, head, rod, Vec3(1, 0, 1.1), Vec3::UnitY())), 0};
    bob_weld = world.add("bob weld", Fixed::at(world, bob, rod, Vec3(1, 0, 0.3)));
  }
};

TEST(MergedMotion, GroupsOnTheGroundStandStill) {
  Crane crane, solved;
  for (Crane* c : {&crane, &solved}) c->world.set_twist(c->rod, {Vec3(0, 2, 0), Vec3(-0.8, 0, 0)});
  const double potential = crane.world.potential_energy(crane.world.state());
  Simulator simulator(crane.world, merging(Integrator::kRattle8));
  const StepReport& first = simulator.step(0.005);
  EXPECT_NEAR(first.ledger.start, potential + kinetic_energy(solved.world, solved.world.state()), 1e-10);
  for (int i = 1; i < 40; ++i) ASSERT_TRUE(simulator.step(0.005).exact());
  run(solved.world, solving(Integrator::kRattle8), 0.005, 40);
  EXPECT_EQ(simulator.merged_joints(), (std::vector{crane.foot_weld, crane.head_weld, crane.bob_weld}));
  EXPECT_LT(difference(crane.world, solved.world), 2e-8);
  EXPECT_EQ(crane.world.twist(crane.head).v, Vec3(Vec3::Zero()));
  EXPECT_LT((crane.world.pose(crane.head).p - Vec3(0.5, 0, 1.1)).norm(), 1e-14);
  EXPECT_EQ(simulator.report().gap.metres < 1e-10, true);
}

TEST(MergedMotion, MotorsOnMembersDriveThem) {
  Crane merged, solved;
  for (Crane* c : {&merged, &solved})
    c->world.set_motor(c->angle, AxisMotor{.target = 1.5, .max_force = 500});
  Simulator by_motion(merged.world, merging()), by_joints(solved.world, solving());
  for (int i = 0; i < 200; ++i) {
    ASSERT_TRUE(by_motion.step(0.001).exact());
    ASSERT_TRUE(by_joints.step(0.001).exact());
  }
  EXPECT_NEAR(merged.world.axis_value(merged.angle), solved.world.axis_value(solved.angle), 1e-6);
  EXPECT_NEAR(merged.world.axis_rate(merged.angle), 1.5, 1e-9);
  const AxisReport a = by_motion.axis_report(merged.angle), b = by_joints.axis_report(solved.angle);
  EXPECT_NEAR(a.force.motor, b.force.motor, 1e-4 * std::abs(b.force.motor));  // of order h²
  // At constant speed the motor holds the weight: rod 1 kg at 0.4 m, bob 4 kg at 0.8 m.
  const double theta = merged.world.axis_value(merged.angle),
               torque = (1 * 0.4 + 4 * 0.8) * 9.81 * std::sin(theta);
  EXPECT_NEAR(a.force.motor, torque, 5e-3 * torque);  // the mean over a step, at its end
  EXPECT_GT(by_motion.report().works.axes.motor, 0);
}

TEST(MergedMotion, DriversOnMembersDriveThem) {
  Crane crane;
  crane.world.add("drive", Driver(crane.world, crane.angle, harmonic_motion(0, 0.3, 4)));
  run(crane.world, merging(), 0.002, 150);
  EXPECT_NEAR(crane.world.axis_value(crane.angle), 0.3 * std::sin(4 * 0.3), 1e-9);
}

TEST(MergedMotion, FollowsWhatIsChangedBetweenSteps) {
  Crane merged, solved;
  Simulator by_motion(merged.world, merging(Integrator::kRattle)), by_joints(solved.world, solving());
  const auto both = [&](auto&& change) {
    change(merged);
    change(solved);
  };
  const auto go = [&](int steps, std::size_t merged_joints) {
    for (int i = 0; i < steps; ++i) {
      ASSERT_TRUE(by_motion.step(2e-4).exact());
      ASSERT_TRUE(by_joints.step(2e-4).exact());
    }
    EXPECT_EQ(by_motion.merged_joints().size(), merged_joints);
    // Of order h² with accelerations of order 100 per second.
    EXPECT_LT(difference(merged.world, solved.world), 2e-5);
  };
  both([](Crane& c) { c.world.set_twist(c.rod, {Vec3(0, 3, 0), Vec3(-1.2, 0, 0)}); });
  go(100, 3);
  both([](Crane& c) { c.world.detach(c.bob_weld); });  // the bob flies off
  go(100, 2);
  both([](Crane& c) { c.world.detach(c.head_weld); });
  go(100, 1);
  both([](Crane& c) {
    c.bob_weld = c.world.add("new weld", Fixed::at(c.world, c.bob, c.head, c.world.pose(c.bob).p));
  });
  go(100, 2);
  both([](Crane& c) { c.world.set_friction(c.angle, AxisFriction{.viscous = 0.5}); });
  go(50, 2);
  both([](Crane& c) { c.world.set_friction(c.angle, AxisFriction{.viscous = 3}); });
  go(50, 2);
  both([](Crane& c) { c.world.set_gravity({1, 2, 3}); });
  go(50, 2);
  both([](Crane& c) { c.world.add_force(PointForce(c.bob, Vec3(0, 0, 0.1), Vec3(5, 20, 0))); });
  go(50, 2);
  both([](Crane& c) {
    c.world.set_compliance(c.bob_weld, JointCompliance{.translation = 1e-4, .translation_damping = 10});
  });
  go(50, 1);
  both([](Crane& c) { c.world.set_compliance(c.bob_weld, {}); });
  go(50, 2);
}

TEST(MergedMotion, WeldsThatCanBreakAreSolvedAndBreak) {
  Crane crane;
  Simulator simulator(crane.world, merging());
  ASSERT_TRUE(simulator.step(0.001).exact());
  EXPECT_EQ(simulator.merged_joints().size(), 3u);
  // The head weld bears rod, bob and head: 7 kg.
  crane.world.set_break(crane.head_weld, BreakLimits{.force = 80});
  ASSERT_TRUE(simulator.step(0.001).exact());
  EXPECT_TRUE(simulator.report().breaks.empty());
  EXPECT_EQ(simulator.merged_joints().size(), 2u);
  EXPECT_NEAR(simulator.mean_reaction(crane.head_weld).force.z(), 7 * 9.81, 1e-6);
  crane.world.set_break(crane.head_weld, BreakLimits{.force = 60});
  ASSERT_TRUE(simulator.step(0.001).exact());
  ASSERT_EQ(simulator.report().breaks.size(), 1u);
  EXPECT_EQ(simulator.report().breaks[0].joint, crane.head_weld);
  EXPECT_FALSE(crane.world.is_attached(crane.head_weld));
  ASSERT_TRUE(simulator.step(0.001).exact());
  EXPECT_LT(crane.world.twist(crane.head).v.z(), -0.005);  // it falls
  EXPECT_EQ(crane.world.twist(crane.foot).v.z(), 0);
}

TEST(MergedMotion, ContactsAreThoseOfTheMembers) {
  World world;
  world.set_gravity({0, 0, -10});
  const Material material{.static_friction = 0.5, .dynamic_friction = 0.4};
  world.add_shape(kGround, HalfSpace{}, {}, material);
  const Vec3 size(1, 1, 1);
  const BodyId low =
      world.add_body({.mass = MassProperties::box(size, 2), .pose = {Quat::Identity(), {0, 0, 0.5}}});
  const BodyId high =
      world.add_body({.mass = MassProperties::box(size, 3), .pose = {Quat::Identity(), {0, 0, 1.5}}});
  world.add_shape(low, Box{size}, {}, material);
  world.add_shape(high, Box{size}, {}, material);
  const JointId weld = world.add("weld", Fixed::at(world, low, high, Vec3(0, 0, 1)));
  Simulator simulator(world, merging());
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(simulator.step(0.005).exact()) << simulator.report().message;
  EXPECT_EQ(simulator.report().contacts, 4);
  Vec3 force = Vec3::Zero();
  for (const ContactReport& report : simulator.contacts()) {
    EXPECT_EQ(report.contact.A, kGround);
    EXPECT_EQ(report.contact.B, low);
    EXPECT_NEAR(report.contact.p_BQ.z(), -0.5, 1e-8);
    EXPECT_NEAR(std::abs(report.contact.p_BQ.x()), 0.5, 1e-8);
    force += report.force;
  }
  EXPECT_LT((force - Vec3(0, 0, 50)).norm(), 1e-6);
  EXPECT_NEAR(world.pose(high).p.z(), 1.5, 1e-9);
  for (const Reaction& reaction : {simulator.reaction(weld), simulator.mean_reaction(weld)}) {
    EXPECT_LT((reaction.force - Vec3(0, 0, 30)).norm(), 1e-5);
    EXPECT_LT(reaction.torque.norm(), 1e-5);
  }
}

TEST(MergedMotion, CollisionRulesAreThoseOfTheMembers) {
  for (const bool forbidden : {false, true}) {
    World world;
    world.set_gravity({0, 0, -10});
    const BodyId table = world.add_body({.pose = {Quat::Identity(), {0, 0, -0.5}}, .fixed = true});
    const BodyId left =
        world.add_body({.mass = MassProperties::box({1, 1, 1}, 1), .pose = {Quat::Identity(), {0, 0, 0.5}}});
    const BodyId right =
        world.add_body({.mass = MassProperties::box({1, 1, 1}, 3), .pose = {Quat::Identity(), {1, 0, 0.5}}});
    world.add("weld", Fixed::at(world, left, right, Vec3(0.5, 0, 0.5)));
    world.add_shape(table, Box{{10, 10, 1}});
    world.add_shape(left, Box{{1, 1, 1}});
    world.add_shape(right, Box{{1, 1, 1}});
    Simulator simulator(world, merging());
    ASSERT_TRUE(simulator.step(0.005).exact());
    EXPECT_EQ(simulator.contacts().size(), 8u);
    if (forbidden) world.set_collision(right, table, false);  // while it runs
    for (int i = 0; i < 20; ++i) ASSERT_TRUE(simulator.step(0.005).exact());
    // Held at its left half only it tips over to the right.
    if (forbidden) {
      EXPECT_LT(world.pose(right).p.z(), 0.495);
    } else {
      EXPECT_NEAR(world.pose(right).p.z(), 0.5, 1e-9);
    }
  }
}

TEST(MergedMotion, WeldsThatContradictAreNamed) {
  Crane crane;
  crane.world.add("askew", Fixed(crane.foot, crane.head, Vec3(0.5, 0, 0.65), Vec3::Zero(), Quat::Identity()));
  Simulator simulator(crane.world, merging());
  EXPECT_EQ(simulator.step(0.01).status, Status::kContradiction);
  EXPECT_NE(simulator.report().message.find("askew"), std::string::npos) << simulator.report().message;
}

TEST(MergedMotion, OtherIntegratorsAndSolversMergeToo) {
  World start = random_tree(3, true);
  ASSERT_TRUE(Simulator(start, merging()).assemble().exact());  // twists that fit
  World merged = start, solved = start;
  run(merged, merging(Integrator::kForceRungeKutta), 0.0005, 200);
  run(solved, solving(Integrator::kForceRungeKutta), 0.0005, 200);
  EXPECT_LT(difference(merged, solved), 1e-4);  // what the joints drift, which feedback limits
  World reference = start;
  run(reference, merging(Integrator::kRattle8), 0.005, 20);
  World iterative = start;
  Settings settings = merging();
  settings.solver = Solver::kGaussSeidel;
  settings.iterations = 500;
  run(iterative, settings, 0.0005, 200);
  EXPECT_LT(difference(iterative, reference), 1e-3);
}

}  // namespace
}  // namespace taut::merged_motion_test
