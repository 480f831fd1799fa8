#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "core/joints/joints.h"
#include "core/world/diagnostics.h"
#include "solvers/simulator/simulator.h"
#include "tests/core/random_state.h"
#include "tests/solvers/integrators/measured_order.h"

// Every joint type in motion: closed over long runs, order of the integrator kept, and closed forms of the
// transmissions and drivers.
namespace taut::joint_types_test {
namespace {

using testing::order_of;
using testing::Random;

constexpr double kPi = std::numbers::pi;
const MassProperties kLump(1.5, Vec3(0.2, 0.3, 0.35));

/// Two or more bodies on weak springs to the ground, in random motion.
struct Tangle {
  Random random;
  World world;
  BodyId a, b, c;

  explicit Tangle(unsigned seed) : random(seed) {
    for (BodyId* body : {&a, &b, &c}) {
      const Twist twist = random.twist();
      *body = world.add_body({.mass = kLump, .pose = random.pose(), .twist = twist});
      world.add_force(SpringDamper(kGround, *body, random.vector(2), random.vector(0.2), 4, 0, 0));
    }
  }
  AxisId hinge(BodyId on, BodyId body) {
    return {world.add("", Hinge::at(world, on, body, random.vector(), random.unit())), 0};
  }
};

struct TypeCase {
  const char* type;
  std::function<void(Tangle&)> add;
  bool conservative = true;
  friend void PrintTo(const TypeCase& c, std::ostream* out) { *out << c.type; }
};

const TypeCase kTypes[] = {
    {"ball", [](Tangle& t) { t.world.add("", Ball::at(t.world, t.a, t.b, t.random.vector())); }},
    {"hinge",
     [](Tangle& t) { t.world.add("", Hinge::at(t.world, t.a, t.b, t.random.vector(), t.random.unit())); }},
    {"slider",
     [](Tangle& t) { t.world.add("", Slider::at(t.world, t.a, t.b, t.random.vector(), t.random.unit())); }},
    {"universal",
     [](Tangle& t) {
       Vec3 arm, unused;
       const Vec3 other = t.random.unit();
       complete_frame(other, arm, unused);
       t.world.add("", Universal::at(t.world, t.a, t.b, t.random.vector(), other, arm));
     }},
    {"fixed", [](Tangle& t) { t.world.add("", Fixed::at(t.world, t.a, t.b, t.random.vector())); }},
    {"distance",
     [](Tangle& t) {
       const Vec3 p = t.random.vector();
       t.world.add("", Distance::between(t.world, t.a, t.b, p, p + 2 * t.random.unit()));
     }},
    {"cylindrical",
     [](Tangle& t) {
       t.world.add("", Cylindrical::at(t.world, t.a, t.b, t.random.vector(), t.random.unit()));
     }},
    {"screw",
     [](Tangle& t) {
       t.world.add("", Screw::at(t.world, t.a, t.b, t.random.vector(), t.random.unit(), 0.7));
     }},
    {"planar",
     [](Tangle& t) {
       Vec3 u, v;
       const Vec3 n = t.random.unit();
       complete_frame(n, u, v);
       t.world.add("", Planar::at(t.world, t.a, t.b, t.random.vector(), n, u));
     }},
    {"point_on_line",
     [](Tangle& t) {
       t.world.add("", PointOnLine::at(t.world, t.a, t.b, t.random.vector(), t.random.unit()));
     }},
    {"hinge2",
     [](Tangle& t) {
       Vec3 spin, unused;
       const Vec3 steering = t.random.unit();
       complete_frame(steering, spin, unused);
       t.world.add("", Hinge2::at(t.world, t.a, t.b, t.random.vector(), steering, spin));
     }},
    {"six_dof",
     [](Tangle& t) {
       t.world.add("", SixDof::at(t.world, t.a, t.b, t.random.vector(), t.random.rotation(),
                                  {{true, false, true}, {false, true, false}}));
     }},
    {"point_on_curve",
     [](Tangle& t) {
       const Vec3 p = t.world.pose(t.a).p;
       std::vector<Vec3> ring;
       for (int i = 0; i <= 8; ++i)
         ring.push_back(
             p + Vec3(2 * std::cos(i * kPi / 4), 1.5 * std::sin(i * kPi / 4), 0.4 * std::cos(i * kPi / 2)));
       ring.back() = ring.front();
       t.world.add("", PointOnCurve::through(t.world, t.a, t.b, ring, ring[3], true));
     }},
    {"pulley",
     [](Tangle& t) {
       t.world.add("", Pulley::at(t.world, t.a, t.random.vector(), kGround, Vec3(0, 0, 6), Vec3(1, 0, 6), t.b,
                                  t.random.vector(), 1.5));
     }},
    {"pulley_on_a_body",
     [](Tangle& t) {
       t.world.add("", Pulley::at(t.world, t.a, t.random.vector(), t.c, t.random.vector(6),
                                  t.random.vector(6), t.b, t.random.vector()));
     }},
    {"gear",
     [](Tangle& t) {
       const AxisId first = t.hinge(t.a, t.b), second = t.hinge(t.a, t.c);
       t.world.add("", Gear(t.world, first, second, -1.75));
     }},
    {"rack_and_pinion",
     [](Tangle& t) {
       const AxisId pinion = t.hinge(t.a, t.b);
       const JointId rail =
           t.world.add("", Slider::at(t.world, t.a, t.c, t.random.vector(), t.random.unit()));
       t.world.add("", RackAndPinion(t.world, pinion, {rail, 0}, 0.4));
     }},
    {"differential",
     [](Tangle& t) {
       const AxisId input = t.hinge(kGround, t.a), left = t.hinge(kGround, t.b), right = t.hinge(t.a, t.c);
       t.world.add("", Differential(t.world, input, left, right));
     }},
    {"driver",
     [](Tangle& t) {
       const AxisId axis = t.hinge(t.a, t.b);
       t.world.add("", Driver(t.world, axis, harmonic_motion(0, 0.8, 3)));
     },
     false},
    {"pose_driver",
     [](Tangle& t) {
       const Pose start = t.world.pose(t.a);
       const Vec3 axis = t.random.unit();
       t.world.add("", PoseDriver(kGround, t.a, [=](double time) {
                     PosePoint x;
                     x.pose = {exp_so3(std::sin(time) * axis) * start.q,
                               start.p + Vec3(0.3 * std::sin(2 * time), 0, 0)};
                     x.velocity = {std::cos(time) * axis, Vec3(0.6 * std::cos(2 * time), 0, 0)};
                     x.acceleration = {-std::sin(time) * axis, Vec3(-1.2 * std::sin(2 * time), 0, 0)};
                     return x;
                   }));
       t.world.add("", Ball::at(t.world, t.a, t.b, t.random.vector()));
     },
     false},
};

class JointTypeInMotion : public ::testing::TestWithParam<TypeCase> {};

/// Ten seconds of random motion: gaps below 1e-9 at every step, and an energy that swings by less than 2 % of
/// about 100 J; with drivers it follows their work.  The worst is the pulley, whose wire turns fast when it
/// is short: 1.8, 0.43, 0.11 and 0.027 J at 5, 2.5, 1.25 and 0.625 ms, so second order and no drift.
TEST_P(JointTypeInMotion, StaysClosed) {
  Tangle t(17);
  GetParam().add(t);
  Simulator simulator(t.world, {});
  ASSERT_TRUE(simulator.step(1e-4).exact()) << simulator.report().message;  // makes the velocities fit
  const double start = simulator.report().energy();
  double work = 0, worst = 0;
  for (int i = 0; i < 2000; ++i) {
    const StepReport& report = simulator.step(5e-3);
    ASSERT_TRUE(report.exact()) << "step " << i << ": " << report.message;
    ASSERT_LE(std::max(report.gap.metres, report.gap.radians), 1e-9) << "step " << i;
    ASSERT_LE(report.velocity_residual, 1e-8) << "step " << i;
    work += report.works.constraint;
    worst = std::max(worst, std::abs(report.energy() - start - (GetParam().conservative ? 0 : work)));
  }
  EXPECT_LT(worst, 2);
  RecordProperty("energy_error_J", std::to_string(worst));
}

/// Half an order of leeway.
TEST_P(JointTypeInMotion, KeepsTheSecondOrder) {
  const double order = order_of([] {
    Tangle t(18);
    GetParam().add(t);
    return std::move(t.world);
  });
  EXPECT_GT(order, 1.5);
}

INSTANTIATE_TEST_SUITE_P(All, JointTypeInMotion, ::testing::ValuesIn(kTypes),
                         [](const auto& c) { return std::string(c.param.type); });

/// Wheels of 0.01 and 0.2 kg m² with radii 0.1 and 0.3 and 2 N·m on the first: α = 2 / (0.01 + 0.2/9).
TEST(Transmissions, GearPairMovesAsInTheClosedForm) {
  World world;
  world.set_gravity(Vec3::Zero());
  const BodyId first = world.add_body({.mass = {1, Vec3(0.01, 0.01, 0.01)}});
  const BodyId second =
      world.add_body({.mass = {1, Vec3(0.2, 0.2, 0.2)}, .pose = {Quat::Identity(), Vec3(0.4, 0, 0)}});
  const AxisId a{world.add("a", Hinge::at(world, kGround, first, Vec3::Zero(), Vec3::UnitZ())), 0};
  const AxisId b{world.add("b", Hinge::at(world, kGround, second, Vec3(0.4, 0, 0), Vec3::UnitZ())), 0};
  const JointId gear = world.add("gear", Gear(world, a, b, -1.0 / 3));
  world.add_force(BodyTorque(first, Vec3(0, 0, 2)));
  Simulator simulator(world, {});
  const double alpha = 2 / (0.01 + 0.2 / 9);
  // λ along the driven axis: the torque that turns the second wheel.
  EXPECT_NEAR(simulator.reaction(gear).torque.z(), -0.2 * alpha / 3, 1e-9);
  for (int i = 0; i < 2000; ++i) ASSERT_TRUE(simulator.step(1e-3).exact()) << simulator.report().message;
  EXPECT_NEAR(world.twist(first).w.z(), 2 * alpha, 1e-8);
  EXPECT_NEAR(world.twist(second).w.z(), -2 * alpha / 3, 1e-8);
  // 124 rad = 20 turns: the turns were counted.  Constant acceleration is integrated exactly up to round-off
  // and the tolerance of positions.
  EXPECT_NEAR(world.axis_value(a), 2 * alpha, 1e-7);
  EXPECT_NEAR(world.axis_value(b), -2 * alpha / 3, 1e-7);
}

/// The square of the ratio, by which the driving wheel's share of S grows, is beyond the largest number.
TEST(Transmissions, ARatioThatOverflowsIsNamed) {
  World world;
  const BodyId first = world.add_body({}), second = world.add_body({});
  const AxisId a{world.add("a", Hinge::at(world, kGround, first, Vec3::Zero(), Vec3::UnitZ())), 0};
  const AxisId b{world.add("b", Hinge::at(world, kGround, second, Vec3::Zero(), Vec3::UnitZ())), 0};
  world.add("large", Gear(world, a, b, 1e308));
  Simulator simulator(world);
  const StepReport& report = simulator.step(0.01);
  EXPECT_EQ(report.status, Status::kNotFinite);
  EXPECT_NE(report.message.find("gear large"), std::string::npos) << report.message;
}

/// The reference case `differential`: angular accelerations from a 3 × 3 system.
TEST(Transmissions, DifferentialMovesAsInTheClosedForm) {
  World world;
  world.set_gravity(Vec3::Zero());
  const double inertia[] = {0.3, 0.1, 0.2}, torque[] = {10, -2, -3}, w0[] = {5, 4, 6};
  const double expected[] = {9.411764705882351, 15.882352941176467, 2.941176470588236};
  BodyId body[3];
  AxisId axis[3];
  for (int i = 0; i < 3; ++i) {
    body[i] = world.add_body({.mass = MassProperties(1, Vec3(Vec3::Constant(inertia[i]))),
                              .twist = {Vec3(0, 0, w0[i]), Vec3::Zero()}});
    axis[i] = {world.add("", Hinge::at(world, kGround, body[i], Vec3::Zero(), Vec3::UnitZ())), 0};
    world.add_force(BodyTorque(body[i], Vec3(0, 0, torque[i])));
  }
  world.add("differential", Differential(world, axis[0], axis[1], axis[2]));
  Simulator simulator(world, {});
  for (int i = 0; i < 200; ++i) ASSERT_TRUE(simulator.step(1e-3).exact()) << simulator.report().message;
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(world.twist(body[i]).w.z(), w0[i] + 0.2 * expected[i], 1e-9);
    EXPECT_NEAR(world.axis_value(axis[i]), 0.2 * w0[i] + 0.02 * expected[i], 1e-8);
  }
}

/// Two masses over fixed sheaves: a = g (m₂ − m₁)/(m₁ + m₂), tension 2 g m₁ m₂/(m₁ + m₂).
TEST(Transmissions, AtwoodMachineMovesAsInTheClosedForm) {
  World world;
  const BodyId light =
      world.add_body({.mass = {1, Vec3(1, 1, 1)}, .pose = {Quat::Identity(), Vec3(0, 0, -3)}});
  const BodyId heavy =
      world.add_body({.mass = {2, Vec3(1, 1, 1)}, .pose = {Quat::Identity(), Vec3(1, 0, -2)}});
  const JointId wire = world.add("wire", Pulley::at(world, light, Vec3(0, 0, -3), kGround, Vec3(0, 0, 0),
                                                    Vec3(1, 0, 0), heavy, Vec3(1, 0, -2)));
  Simulator simulator(world, {});
  EXPECT_NEAR(simulator.reaction(wire).force.z(), 2 * 9.81 * 2 / 3, 1e-9);
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(simulator.step(1e-3).exact()) << simulator.report().message;
  EXPECT_NEAR(world.twist(light).v.z(), 9.81 / 3 * 0.5, 1e-8);
  EXPECT_NEAR(world.pose(heavy).p.z(), -2 - 9.81 / 3 / 2 * 0.25, 1e-8);
}

/// The same over two points of a rope: taut it is that wire, with slack both masses fall freely.
TEST(Transmissions, ARopeOverTwoPointsPullsAsTheAtwoodMachine) {
  for (const double slack : {0.0, 0.5}) {
    World world;
    const BodyId light =
        world.add_body({.mass = {1, Vec3(1, 1, 1)}, .pose = {Quat::Identity(), Vec3(0, 0, -3)}});
    const BodyId heavy =
        world.add_body({.mass = {2, Vec3(1, 1, 1)}, .pose = {Quat::Identity(), Vec3(1, 0, -2)}});
    const std::vector<WirePoint> way = {
        {light, Vec3::Zero()}, {kGround, Vec3::Zero()}, {kGround, Vec3(1, 0, 0)}, {heavy, Vec3::Zero()}};
    const JointId rope = world.add("rope", Rope(way, 6 + slack));
    Simulator simulator(world, {});
    for (int i = 0; i < 200; ++i) ASSERT_TRUE(simulator.step(1e-3).exact()) << simulator.report().message;
    const double a = slack == 0 ? -9.81 / 3 : 9.81;  // of the light one, downwards
    EXPECT_NEAR(world.twist(light).v.z(), -a * 0.2, 1e-8);
    EXPECT_NEAR(world.twist(heavy).v.z(), -9.81 * 0.2 / (slack == 0 ? 3 : 1), 1e-8);
    EXPECT_NEAR(simulator.reaction(rope).force.norm(), slack == 0 ? 2 * 9.81 * 2 / 3 : 0, 1e-7);
    EXPECT_NEAR(world.axis_value({rope, 0}), slack == 0 ? 6 : 6 + 9.81 * 0.04, 1e-9);
  }
}

/// A rod that is turned at a constant rate against gravity: the driver gives m g l cos θ.
TEST(Drivers, HoldTheirMotionAndReportTheirTorque) {
  World world;
  const BodyId rod =
      world.add_body({.mass = {2, Vec3(0.01, 0.2, 0.2)}, .pose = {Quat::Identity(), Vec3(0.5, 0, 0)}});
  const AxisId axis{world.add("hinge", Hinge::at(world, kGround, rod, Vec3::Zero(), -Vec3::UnitY())), 0};
  const double rate = 3;
  const JointId drive = world.add("drive", Driver(world, axis, linear_motion(0, rate)));
  Simulator simulator(world, {});
  double work = 0;
  for (int i = 0; i < 1000; ++i) {
    ASSERT_TRUE(simulator.step(5e-3).exact()) << simulator.report().message;
    work += simulator.report().works.constraint;
    const double theta = rate * world.time();
    ASSERT_NEAR(world.axis_value(axis), theta, 1e-9);
    ASSERT_NEAR(world.axis_rate(axis), rate, 1e-8);
    if (i % 100 == 0) {
      EXPECT_NEAR(-simulator.reaction(drive).torque.y(), 2 * 9.81 * 0.5 * std::cos(theta), 1e-7);
    }
  }
  // Started at rest: the first step gives ½ (I + m l²) ω²; then the work is that against gravity.  The
  // projection to the driver's rate at the start is not counted as work.
  EXPECT_NEAR(work, 2 * 9.81 * 0.5 * std::sin(15), 2e-2);
  EXPECT_GT(world.axis_value(axis), 4 * kPi);
}

TEST(Drivers, ThatAreNotFiniteEndInAStatus) {
  const auto run = [](Motion motion, Settings settings) {
    World world;
    const BodyId rod = world.add_body({.pose = {Quat::Identity(), Vec3(0.5, 0, 0)}});
    const AxisId axis{world.add("hinge", Hinge::at(world, kGround, rod, Vec3::Zero(), Vec3::UnitY())), 0};
    world.add("drive", Driver(world, axis, std::move(motion)));
    Simulator simulator(world, settings);
    StepReport last;
    for (int i = 0; i < 30 && last.exact(); ++i) last = simulator.step(0.01);
    return std::pair(last, world.time());
  };
  const double nan = std::nan("");
  const Motion later = [=](double t) { return t < 0.105 ? MotionPoint{} : MotionPoint{nan, 0, 0}; };
  const Motion at_once = [=](double) { return MotionPoint{nan, nan, nan}; };
  const Motion rate = [=](double t) { return MotionPoint{0, t < 0.105 ? 0 : nan, 0}; };
  for (const Motion& motion : {later, rate}) {
    const auto [report, time] = run(motion, {});
    EXPECT_EQ(report.status, Status::kNotFinite);
    EXPECT_NE(report.message.find("driver drive"), std::string::npos) << report.message;
    EXPECT_NEAR(time, 0.1, 1e-12);
  }
  EXPECT_EQ(run(at_once, {}).first.status, Status::kNotFinite);
}

TEST(Drivers, OfTheForceLevelKeepFollowing) {
  World world;
  const BodyId rod = world.add_body({.pose = {Quat::Identity(), Vec3(0.5, 0, 0)}});
  const AxisId axis{world.add("hinge", Hinge::at(world, kGround, rod, Vec3::Zero(), Vec3::UnitY())), 0};
  world.add("drive", Driver(world, axis, harmonic_motion(0, 0.5, 2)));
  world.set_twist(rod, {Vec3(0, 1, 0), Vec3(0, 1, 0).cross(Vec3(0.5, 0, 0))});
  Settings settings;
  settings.integrator = Integrator::kForceRungeKutta;
  settings.drift_cure = DriftCure::kNone;
  Simulator simulator(world, settings);
  for (int i = 0; i < 200; ++i) ASSERT_TRUE(simulator.step(0.01).exact());
  EXPECT_NEAR(world.axis_value(axis), 0.5 * std::sin(4), 1e-7);  // order 4: h⁴ = 1e-8
  EXPECT_NEAR(world.axis_rate(axis), std::cos(4), 1e-7);
}

/// Joints without any row: a rope whose limit was taken away, a generic joint with nothing locked.
TEST(JointsWithoutRows, DoNotDisturb) {
  Tangle t(3);
  const JointId rope = t.world.add("rope", Rope(t.a, t.b, Vec3::Zero(), Vec3::Zero(), 20));
  t.world.set_limits({rope, 0}, std::nullopt);
  t.world.add("free", SixDof::at(t.world, t.b, t.c, Vec3::Zero(), Quat::Identity(), {}));
  t.world.add("ball", Ball::at(t.world, t.a, t.c, Vec3::Zero()));
  for (FactorChoice factor : {FactorChoice::kMultifrontal, FactorChoice::kSimplicial}) {
    Settings settings;
    settings.factor = factor;
    Simulator simulator(t.world, settings);
    for (int i = 0; i < 50; ++i) ASSERT_TRUE(simulator.step(0.01).exact()) << simulator.report().message;
    EXPECT_LE(simulator.report().gap.metres, 1e-9);
    EXPECT_EQ(simulator.analyze_rank().rows, 3);
  }
}

}  // namespace
}  // namespace taut::joint_types_test
