#include "solvers/simulator/simulator.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <set>
#include <thread>

#include "core/joints/joints.h"
#include "core/state/same_state.h"
#include "core/world/diagnostics.h"
#include "scenes/builders/scene.h"
#include "tests/solvers/simulator/joint_scenes.h"

namespace taut::simulator_test {
namespace {

/// Jacobi's cn(u)/dn(u) = sn(u + K) by the descending Landen transformation (Abramowitz and
/// Stegun 16.4, 17.6).
double jacobi_cd(double u, double k) {
  double a[20] = {1}, c[20] = {k}, b = std::sqrt(1 - k * k);
  int n = 0;
  while (c[n] > 1e-17 && n < 19) {
    a[n + 1] = 0.5 * (a[n] + b);
    c[n + 1] = 0.5 * (a[n] - b);
    b = std::sqrt(a[n] * b);
    ++n;
  }
  const double quarter = std::numbers::pi / (2 * a[n]);
  double phi = std::ldexp(a[n] * (u + quarter), n);
  for (int i = n; i > 0; --i) phi = 0.5 * (phi + std::asin(c[i] / a[i] * std::sin(phi)));
  return std::sin(phi);
}

/// A rod of 1 m on a hinge, released level: angle below the horizontal after t.
double level_pendulum_angle(double t) {
  const double inertia = 1.0 / 12 * (3 * 1e-4 + 1) + 0.25, omega = std::sqrt(9.81 * 0.5 / inertia);
  const double k = std::sin(std::numbers::pi / 4);
  return std::numbers::pi / 2 - 2 * std::asin(k * jacobi_cd(omega * t, k));
}

Settings tight() {
  Settings settings;
  settings.position_tolerance = 1e-14;
  settings.velocity_tolerance = 1e-12;
  settings.max_rotation = 10;
  settings.tension = TensionPolicy::kIgnore;
  return settings;
}

double pendulum_error(Settings settings, double dt) {
  Scene scene = build_scene("pendulum-hinge", {{"n", 1}});
  Simulator simulator(scene.world, settings);
  const int steps = static_cast<int>(std::lround(1.0 / dt));
  for (int i = 0; i < steps; ++i) EXPECT_TRUE(simulator.step(dt).exact()) << simulator.report().message;
  const Vec3 p = scene.world.pose(BodyId{1}).p;
  return std::abs(std::atan2(-p.z(), p.x()) - level_pendulum_angle(steps * dt));
}

struct OrderCase {
  const char* name;
  Integrator integrator;
  double order, dt;
};

class IntegratorOrder : public ::testing::TestWithParam<OrderCase> {};

/// Large-amplitude pendulum against elliptic functions; the half order of leeway is for steps that are not
/// yet asymptotic.
TEST_P(IntegratorOrder, IsTheNominalOne) {
  Settings settings = tight();
  settings.integrator = GetParam().integrator;
  settings.drift_cure = DriftCure::kNone;
  const double coarse = pendulum_error(settings, GetParam().dt),
               fine = pendulum_error(settings, GetParam().dt / 2);
  EXPECT_GT(std::log2(coarse / fine), GetParam().order - 0.5) << coarse << " -> " << fine;
  EXPECT_LT(fine, 1e-2);
}

INSTANTIATE_TEST_SUITE_P(All, IntegratorOrder,
                         ::testing::Values(OrderCase{"rattle", Integrator::kRattle, 2, 0.01},
                                           OrderCase{"rattle4", Integrator::kRattle4, 4, 0.02},
                                           OrderCase{"rattle6", Integrator::kRattle6, 6, 0.05},
                                           OrderCase{"rattle8", Integrator::kRattle8, 8, 0.1},
                                           OrderCase{"force_euler", Integrator::kForceEuler, 1, 0.005},
                                           OrderCase{"force_runge_kutta", Integrator::kForceRungeKutta, 4,
                                                     0.02}),
                         [](const auto& order_case) { return std::string(order_case.param.name); });

TEST(Rattle, KeepsTheEnergyOfADoublePendulumForAMillionSteps) {
  Scene scene = build_scene("pendulum-hinge", {{"n", 2}});
  Simulator simulator(scene.world, scene.settings);  // as anyone runs it
  const double initial = total_energy(scene.world, scene.world.state());
  double early = 0, late = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    ASSERT_TRUE(simulator.step(1e-3).exact());
    if (i % 10) continue;
    const double drift =
        std::abs(total_energy(scene.world, scene.world.state()) - initial) / scene.energy_scale;
    double& window = i < 200'000 ? early : late;
    if (i < 200'000 || i >= 800'000) window = std::max(window, drift);
  }
  // A secular drift would have grown five times; the envelope of a chaotic motion varies by less than half of
  // that.
  EXPECT_LT(late, 2 * early);
  EXPECT_LT(late, 2e-4);
}

TEST(Rattle, KeepsMomentumAndAngularMomentumOfAFreeChain) {
  World world;
  world.set_gravity(Vec3::Zero());
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<BodyId> rods;
  for (int i = 0; i < 6; ++i) {
    BodySpec rod{.name = {}, .mass = MassProperties(1 + i, Vec3(0.2, 0.3, 0.4))};
    rod.pose.p = Vec3(i, 0, 0);
    rod.twist.w = Vec3(normal(random), normal(random), normal(random));
    rods.push_back(world.add_body(rod));
    if (i > 0) world.add("", Ball::at(world, rods[i - 1], rods[i], Vec3(i - 0.5, 0, 0)));
  }
  Simulator simulator(world);
  ASSERT_TRUE(simulator.step(1e-3).exact());  // makes the velocities tangent
  const Vec3 P = linear_momentum(world, world.state()), L = angular_momentum(world, world.state());
  const double E = total_energy(world, world.state());
  for (int i = 0; i < 5000; ++i) ASSERT_TRUE(simulator.step(1e-3).exact());
  EXPECT_LT((linear_momentum(world, world.state()) - P).norm(), 1e-10);
  EXPECT_LT((angular_momentum(world, world.state()) - L).norm(),
            1e-8);  // joints 1e-10 m open times their forces
  EXPECT_LT(std::abs(total_energy(world, world.state()) - E), 1e-4 * E);
}

TEST(Rattle, WorkOfForcesAndJointsAddsUpToTheEnergy) {
  Scene scene = build_scene("pendulum-ball", {{"n", 2}});
  Simulator simulator(scene.world);
  double work = 0;
  for (int i = 0; i < 2000; ++i) work += simulator.step(1e-3).works.constraint;
  // Ideal joints do no work: what is left is the energy error of the integrator.
  EXPECT_LT(std::abs(work), 1e-3 * scene.energy_scale);
}

/// Three different moments, so that the free flow itself is off by the third power of the step, beside a
/// joint.
TEST(Rattle, TheLedgerClosesForBodiesWithThreeDifferentMoments) {
  World world;
  const MassProperties plate = MassProperties::box(Vec3(0.6, 0.3, 0.1), 2.0);
  const BodyId free = world.add_body({.name = "free", .mass = plate});
  const BodyId hung = world.add_body({.name = "hung", .mass = plate, .pose = {.p = Vec3(2, 0, 0)}});
  world.add("pivot", Ball::at(world, kGround, hung, Vec3(1.7, 0.1, 0)));
  world.set_twist(free, {Vec3(3, -2, 4), Vec3(1, 0, 0)});
  Simulator simulator(world);
  double flow = 0;
  for (int i = 0; i < 300; ++i) {
    const StepReport& r = simulator.step(0.004);
    ASSERT_TRUE(r.exact()) << r.message;
    ASSERT_NEAR(r.ledger.start + r.ledger.total(), r.energy(), 1e-13 * (10 + std::abs(r.energy()))) << i;
    flow = std::max(flow, std::abs(r.ledger.integration));
  }
  EXPECT_GT(flow, 1e-9);  // there was something to book
}

/// The mode of the caller's numbers comes back, also after a step that throws.
TEST(Determinism, AStepLeavesDenormalNumbersAsTheyWere) {
  const auto half_of_the_smallest = [] {
    volatile double smallest = std::numeric_limits<double>::min();
    return smallest / 2;
  };
  World world;
  (void)world.add_body({.mass = MassProperties(1, Vec3(1, 1, 1))});
  Simulator simulator(world);
  ASSERT_TRUE(simulator.step(1e-3).exact());
  EXPECT_GT(half_of_the_smallest(), 0);
  EXPECT_THROW(simulator.step(-1), std::invalid_argument);
  EXPECT_GT(half_of_the_smallest(), 0);
}

/// Static loads shared by redundant joints: the least-norm multipliers, against a dense pseudo-inverse.
TEST(Redundancy, ReactionsAreThoseOfLeastNorm) {
  World world;
  BodySpec door{.name = "door", .mass = MassProperties(10, Vec3(1, 1, 1))};
  door.pose.p = Vec3(0.4, 0, 0);
  const BodyId body = world.add_body(door);
  const JointId low = world.add("low", Hinge::at(world, kGround, body, Vec3(0, 0, -0.8), Vec3::UnitZ()));
  const JointId high = world.add("high", Hinge::at(world, kGround, body, Vec3(0, 0, 0.8), Vec3::UnitZ()));
  Simulator simulator(world);
  const Reaction a = simulator.reaction(low), b = simulator.reaction(high);
  EXPECT_NEAR((a.force + b.force - Vec3(0, 0, 98.1)).norm(), 0, 1e-6);
  EXPECT_NEAR(a.force.z(), 49.05, 1e-6);  // equal shares: least norm
  const RankReport rank = simulator.analyze_rank();
  EXPECT_EQ(rank.rows, 10);
  EXPECT_EQ(rank.rank, 5);
  EXPECT_EQ(rank.freedoms, 1);
  ASSERT_EQ(rank.redundant.size(), 5u);
  for (const RedundantRow& row : rank.redundant) EXPECT_FALSE(row.held_by.empty());
  for (int i = 0; i < 500; ++i) {
    const StepReport& report = simulator.step(1e-3);
    ASSERT_TRUE(report.exact()) << report.message;
    EXPECT_EQ(report.rank_deficiency, 5);
  }
}

/// A bar on two hinges, which becomes determinate as one of them goes.
TEST(Redundancy, StepsReportWhoseReactionsAreNotUnique) {
  World world;
  const BodyId door = world.add_body({.mass = MassProperties(10, Vec3(1, 1, 1)), .pose = {.p = {0.4, 0, 0}}});
  const JointId low = world.add("low", Hinge::at(world, kGround, door, Vec3(0, 0, -0.8), Vec3::UnitZ()));
  const JointId high = world.add("high", Hinge::at(world, kGround, door, Vec3(0, 0, 0.8), Vec3::UnitZ()));
  Settings settings;
  EXPECT_FALSE(Simulator(world, settings).step(1e-3).rank);
  settings.report_rank = true;
  Simulator simulator(world, settings);
  const StepReport& report = simulator.step(1e-3);
  ASSERT_TRUE(report.rank);
  EXPECT_EQ(report.rank->not_unique, (std::vector{low, high}));
  ASSERT_EQ(report.rank->redundant.size(), 5u);
  for (const RedundantRow& row : report.rank->redundant) {
    EXPECT_EQ(row.joint, high);
    EXPECT_EQ(row.held_by, std::vector{low});
  }
  world.detach(high);
  (void)simulator.step(1e-3);
  ASSERT_TRUE(report.rank);
  EXPECT_TRUE(report.rank->not_unique.empty() && report.rank->redundant.empty());
}

/// Along a straight row between two hinges of the ground all of them hold what one of them holds too often.
TEST(Redundancy, NamesAllJointsThatHoldARow) {
  World world;
  std::vector<JointId> joints;
  BodyId last = kGround;
  const auto hinge = [&](BodyId b, double x) {
    joints.push_back(world.add("", Hinge::at(world, last, b, Vec3(x, 0, 0), Vec3::UnitY())));
    last = b;
  };
  for (int i = 0; i < 9; ++i)
    hinge(
        world.add_body({.mass = MassProperties::rod(0.1, 0.01, 0.1), .pose = {.p = {0.1 * i + 0.05, 0, 0}}}),
        0.1 * i);
  hinge(kGround, 0.9);
  const RankReport rank = Simulator(world).analyze_rank();
  bool along = false;
  for (const RedundantRow& row : rank.redundant) {
    EXPECT_EQ(std::count(row.held_by.begin(), row.held_by.end(), row.joint), 0);
    along = along || (row.name == "translation along world x" && row.held_by.size() == joints.size() - 1);
  }
  EXPECT_TRUE(along);
}

TEST(Redundancy, ATautRowCarriesItsAxialLoad) {
  World world;
  world.set_gravity(Vec3(9.81, 0, 0));
  BodyId last = kGround;
  for (int i = 0; i < 10; ++i) {
    BodySpec rod{.name = {}, .mass = MassProperties::rod(0.1, 0.01, 0.1)};
    rod.pose.p = Vec3(0.1 * i + 0.05, 0, 0);
    const BodyId body = world.add_body(rod);
    world.add("", Ball::at(world, last, body, Vec3(0.1 * i, 0, 0)));
    last = body;
  }
  world.add("end", Ball::at(world, last, kGround, Vec3(1, 0, 0)));
  Simulator simulator(world);
  for (int i = 0; i < 1000; ++i) {
    const StepReport& report = simulator.step(1e-3);
    ASSERT_TRUE(report.exact()) << report.message;
    ASSERT_LE(report.gap.metres, 1e-9);
    ASSERT_LT(report.kinetic_energy, 1e-12);
  }
}

TEST(Contradiction, IsReportedByNameAndLeavesTheWorldAlone) {
  World world;
  BodySpec ball{.name = "ball", .mass = MassProperties::sphere(0.1, 1)};
  ball.pose.p = Vec3(1, 0, 0);
  const BodyId body = world.add_body(ball);
  BodySpec other{.name = "other", .mass = MassProperties::sphere(0.1, 1)};
  other.pose.p = Vec3(1, 1, 0);
  const BodyId bystander = world.add_body(other);
  world.add("short", Distance(kGround, body, Vec3::Zero(), Vec3::Zero(), 0.9));
  world.add("long", Distance(kGround, body, Vec3::Zero(), Vec3::Zero(), 1.1));
  world.add("innocent", Distance(body, bystander, Vec3::Zero(), Vec3::Zero(), 1.0));
  Simulator simulator(world);
  const StepReport& report = simulator.step(1e-3);
  EXPECT_EQ(report.status, Status::kContradiction);
  ASSERT_EQ(report.contradiction.joints.size(), 2u) << report.message;
  EXPECT_NE(report.message.find("short"), std::string::npos) << report.message;
  EXPECT_NE(report.message.find("long"), std::string::npos) << report.message;
  EXPECT_NEAR(report.contradiction.residual, 0.1, 0.05);
  EXPECT_EQ(world.pose(body).p, ball.pose.p);
  EXPECT_EQ(world.time(), 0);
}

/// No joint is blamed for it, whatever the integrator has made of it by then.
TEST(Status, AForceThatIsNotFiniteIsAStatus) {
  for (const Integrator integrator :
       {Integrator::kRattle, Integrator::kForceEuler, Integrator::kForceRungeKutta}) {
    Scene scene = build_scene("pendulum-ball", {{"n", 2}});
    scene.world.add_force(ForceCallback(
        [](const State& state, std::span<Wrench> wrenches) {
          if (state.time >= 1e-3) wrenches[1].force.x() = std::nan("");
        },
        false));
    Settings settings;
    settings.integrator = integrator;
    Simulator simulator(scene.world, settings);
    StepReport last;
    for (int i = 0; i < 4 && last.exact(); ++i) last = simulator.step(1e-3);
    EXPECT_EQ(last.status, Status::kNotFinite);
    EXPECT_EQ(last.message, "what force law 0 gives is not finite");
    ASSERT_EQ(last.culprits.size(), 1u);
    EXPECT_EQ(last.culprits[0].kind, Culprit::Kind::kForce);
  }
}

TEST(Status, AStepGoesOnAfterAForceThatWasNotFinite) {
  Scene scene = build_scene("pendulum-ball", {{"n", 2}});
  bool poison = false;
  scene.world.add_force(ForceCallback(
      [&](const State&, std::span<Wrench> wrenches) {
        if (poison) wrenches[1].force.x() = std::nan("");
      },
      false));
  Simulator simulator(scene.world);
  ASSERT_TRUE(simulator.step(1e-3).exact());
  const State before = scene.world.state();
  poison = true;
  EXPECT_EQ(simulator.step(1e-3).status, Status::kNotFinite);
  EXPECT_EQ(scene.world.pose(BodyId{1}).p, before.poses[1].p);
  poison = false;
  EXPECT_TRUE(simulator.step(1e-3).exact()) << simulator.report().message;
}

TEST(Tension, ImplicitStiffnessIsStableAtALargeStepAndReportsItsPrice) {
  Scene scene = build_scene("chain-heavy", {{"n", 10}});
  Settings settings;
  settings.tension = TensionPolicy::kImplicit;
  Simulator simulator(scene.world, settings);
  const double initial = total_energy(scene.world, scene.world.state());
  double taken = 0, highest = 0, tension = 0;
  for (int i = 0; i < 480; ++i) {
    const StepReport& report = simulator.step(1.0 / 240);
    ASSERT_TRUE(report.exact()) << "step " << i << ": " << report.message;
    ASSERT_LE(report.gap.metres, 1e-9);
    taken += report.works.stiffness;
    highest = std::max(highest, (report.energy() - initial) / scene.energy_scale);
    tension = std::max(tension, report.tension_number);
  }
  EXPECT_GT(tension, 2);  // where explicit constraint directions are unstable
  EXPECT_LT(taken, 0);    // it dissipates, and says how much
  EXPECT_LT(highest, 0.05);
}

TEST(Determinism, TwoRunsEndInTheSameBits) {
  for (const auto& [name, parameters] : kJointScenes) {
    State states[2];
    for (State& state : states) {
      Scene scene = build_scene(name, parameters);
      Simulator simulator(scene.world, scene.settings);
      for (int i = 0; i < 100; ++i) ASSERT_TRUE(simulator.step(1.0 / 240).exact()) << name;
      state = scene.world.state();
    }
    for (std::size_t b = 0; b < states[0].poses.size(); ++b) {
      EXPECT_EQ(std::memcmp(&states[0].poses[b], &states[1].poses[b], sizeof(Pose)), 0) << name;
      EXPECT_EQ(std::memcmp(&states[0].twists[b], &states[1].twists[b], sizeof(Twist)), 0) << name;
    }
  }
}

struct CureCase {
  const char* name;
  DriftCure cure;
  double largest_gap;
};

class Cure : public ::testing::TestWithParam<CureCase> {};

/// Two seconds of a double pendulum with the force-level scheme at 1 ms: what each cure is worth.
TEST_P(Cure, HoldsTheJointsAsWellAsItCan) {
  Scene scene = build_scene("pendulum-ball", {{"n", 2}});
  Settings settings;
  settings.integrator = Integrator::kForceEuler;
  settings.drift_cure = GetParam().cure;
  Simulator simulator(scene.world, settings);
  double gap = 0;
  for (int i = 0; i < 2000; ++i) {
    ASSERT_TRUE(simulator.step(1e-3).exact()) << simulator.report().message;
    gap = std::max(gap, simulator.report().gap.metres);
  }
  EXPECT_LT(gap, GetParam().largest_gap);
  EXPECT_GT(gap, 1e-9);  // none of them reaches what RATTLE promises
  RecordProperty("gap", std::to_string(gap));
}

INSTANTIATE_TEST_SUITE_P(All, Cure,
                         ::testing::Values(CureCase{"none", DriftCure::kNone, 0.2},
                                           CureCase{"baumgarte", DriftCure::kBaumgarte, 2e-4},
                                           CureCase{"velocity_impulse", DriftCure::kVelocityImpulse, 2e-4},
                                           CureCase{"position_push", DriftCure::kPositionPush, 2e-4},
                                           CureCase{"penalty", DriftCure::kPenalty, 2e-2}),
                         [](const auto& cure) { return std::string(cure.param.name); });

TEST(Settings, BadOnesAreRefusedByName) {
  World world;
  Settings settings;
  settings.position_tolerance = -1;
  EXPECT_THROW(Simulator(world, settings), std::invalid_argument);
  Simulator simulator(world);
  EXPECT_THROW((void)simulator.step(0), std::invalid_argument);
  EXPECT_THROW((void)simulator.step(std::nan("")), std::invalid_argument);
}

/// Every factor gives the same motion.
TEST(Factors, AgreeOnABridge) {
  Vec3 reference = Vec3::Zero();
  for (FactorChoice choice : {FactorChoice::kAuto, FactorChoice::kCholmod, FactorChoice::kSimplicial,
                              FactorChoice::kSupernodal, FactorChoice::kDense}) {
    Scene scene = build_scene("net-corners", {{"n", 8}});
    Settings settings;
    settings.factor = choice;
    Simulator simulator(scene.world, settings);
    for (int i = 0; i < 100; ++i) ASSERT_TRUE(simulator.step(1e-3).exact());
    const Vec3 p = scene.world.pose(BodyId{20}).p;
    if (choice == FactorChoice::kAuto) reference = p;
    EXPECT_LT((p - reference).norm(), 1e-9);
  }
}

/// One island of joints that is large enough to be shared.
TEST(Threads, GiveTheSameBitsOnANet) {
  std::optional<State> first;
  for (const int threads : {1, 2, 4}) {
    Scene scene = build_scene("net-corners", {{"n", 72}});
    Settings settings;
    settings.threads = threads;
    Simulator simulator(scene.world, settings);
    for (int i = 0; i < 5; ++i) ASSERT_TRUE(simulator.step(1e-3).exact());
    EXPECT_EQ(simulator.report().missing_threads, 0);
    if (!first) first = scene.world.state();
    EXPECT_TRUE(same(scene.world.state(), *first)) << threads;
  }
}

/// What users write need not be safe for several threads, and may know which one asks.
TEST(Threads, LeaveMotionsToTheCallersThread) {
  World world;
  std::set<std::thread::id> asking;
  const Motion motion = [&](double t) {
    asking.insert(std::this_thread::get_id());
    return MotionPoint{0.1 * t, 0.1};
  };
  for (int i = 0; i < 9000; ++i) {
    const BodyId body = world.add_body({.mass = MassProperties::box({0.2, 0.2, 0.1}, 1)});
    const JointId slider = world.add("", Slider::at(world, kGround, body, Vec3::Zero(), Vec3::UnitX()));
    if (i % 10 == 0) world.add("", Driver(world, {slider, 0}, motion));
  }
  Settings settings;
  settings.threads = 4;
  Simulator simulator(world, settings);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(simulator.step(1e-3).exact());
  EXPECT_EQ(asking, std::set{std::this_thread::get_id()});
}

}  // namespace
}  // namespace taut::simulator_test
