#include <numbers>

#include "core/constraints/rows.h"
#include "core/joints/joints.h"
#include "tests/core/expect_invalid.h"
#include "tests/core/world_rows_checker.h"

// Joints of several bodies and joints that follow the time.
namespace taut::coupling_test {
namespace {

using testing::expect_invalid;
using testing::Random;
using testing::WorldRowsChecker;

constexpr double kPi = std::numbers::pi;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// A frame that floats, with two wheels on hinges and a rack on a slider, in random poses; the wheels are
/// somewhat off their hinges, so that nothing depends on closed joints.
struct Machine {
  Random random;
  World world;
  BodyId frame, first, second, rack;
  AxisId first_angle, second_angle, travel;

  explicit Machine(unsigned seed) : random(seed) {
    frame = world.add_body({.name = "frame", .pose = random.pose()});
    first = world.add_body({.name = "first", .pose = random.pose()});
    second = world.add_body({.name = "second", .pose = random.pose()});
    rack = world.add_body({.name = "rack", .pose = random.pose()});
    first_angle = {world.add("h1", Hinge::at(world, frame, first, random.vector(), random.unit())), 0};
    second_angle = {world.add("h2", Hinge::at(world, frame, second, random.vector(), random.unit())), 0};
    travel = {world.add("rail", Slider::at(world, frame, rack, random.vector(), random.unit())), 0};
  }
  void disturb() {
    for (BodyId body : {frame, first, second, rack})
      world.set_pose(body, testing::moved(world.pose(body), 0.3 * random.unit(), 0.2 * random.unit()));
  }
  double residual(JointId joint) const {
    const Rows rows(world);
    std::vector<double> phi(rows.row_count());
    rows.residual(world.state(), phi);
    return phi[rows.joints()[joint.index].first_row];
  }
};

TEST(Couplings, AreConsistentRows) {
  for (unsigned seed = 200; seed < 210; ++seed) {
    Machine m(seed);
    m.world.add("gear", Gear(m.world, m.first_angle, m.second_angle, -2.5));
    m.world.add("rp", RackAndPinion(m.world, m.second_angle, m.travel, 0.3));
    m.world.add(
        "d",
        Differential(
            m.world, m.first_angle, m.second_angle,
            {m.world.add("h3", Hinge::at(m.world, kGround, m.rack, m.random.vector(), m.random.unit())), 0}));
    m.world.add("drive", Driver(m.world, m.first_angle, harmonic_motion(0.3, 2, 3, 0.5)));
    m.disturb();
    m.world.set_time(0.7);
    // Open hinges leave a couple, and the open slider has an orientation row: see RowChecks.  Both are
    // checked on closed joints below.
    WorldRowsChecker(m.world).check(m.random, {.stiffness = false, .third_law = false});
  }
}

TEST(Couplings, TieTheirAxesAsTheySay) {
  Machine m(1);
  const JointId gear = m.world.add("gear", Gear(m.world, m.first_angle, m.second_angle, -2.5));
  const JointId rp = m.world.add("rp", RackAndPinion(m.world, m.second_angle, m.travel, 0.3));
  EXPECT_NEAR(m.residual(gear), 0, 1e-14);
  EXPECT_NEAR(m.residual(rp), 0, 1e-14);
  // Turns are counted: three turns of one wheel are no turn of the other.
  m.world.set_axis_turns(m.first_angle, 6 * kPi);
  EXPECT_NEAR(m.residual(gear), 2.5 * 6 * kPi, 1e-12);
  m.world.set_axis_turns(m.second_angle, -4 * kPi);
  EXPECT_NEAR(m.residual(gear), 2.5 * 6 * kPi - 4 * kPi, 1e-12);
  EXPECT_NEAR(m.residual(rp), 0.3 * 4 * kPi, 1e-12);
}

TEST(Couplings, KeepTheTurnsOfTheirAxes) {
  World world;
  const BodyId wheel = world.add_body({}), other = world.add_body({});
  const AxisId a{world.add("a", Hinge::at(world, kGround, wheel, Vec3::Zero(), Vec3::UnitZ())), 0};
  const AxisId b{world.add("b", Hinge::at(world, kGround, other, Vec3::Zero(), Vec3::UnitZ())), 0};
  world.add("gear", Gear(world, a, b, 0.25));
  const Rows rows(world);
  State state = world.state();
  for (int i = 1; i <= 20; ++i) {
    state.poses[wheel.index].q = exp_so3(Vec3(0, 0, i));
    rows.update_axes(state, state.axes);
  }
  EXPECT_NEAR(state.axes[world.axis_index(a)], 20, 1e-13);
  EXPECT_NEAR(state.axes[world.axis_index(b)], 0, 1e-13);
}

TEST(Couplings, ObeyTheThirdLawTogetherWithTheirAxles) {
  Machine m(5);
  m.world.add("gear", Gear(m.world, m.first_angle, m.second_angle, -2.5));
  m.world.add("rp", RackAndPinion(m.world, m.second_angle, m.travel, 0.3));
  m.world.add("drive", Driver(m.world, m.travel, linear_motion(0, 1)));
  WorldRowsChecker(m.world).check(m.random);
}

TEST(Couplings, NameTheirBodies) {
  Machine m(2);
  const Gear gear(m.world, m.first_angle, m.second_angle, 2);
  ASSERT_EQ(gear.bodies().size(), 3u);
  EXPECT_EQ(gear.b(), m.second);
  const Driver driver(m.world, m.travel, linear_motion(0, 1));
  EXPECT_EQ(driver.a(), m.frame);
  EXPECT_EQ(driver.b(), m.rack);
}

TEST(Wires, AreConsistentRows) {
  for (unsigned seed = 220; seed < 230; ++seed) {
    Machine m(seed);
    World world;
    for (BodyId body : {m.frame, m.first, m.second, m.rack}) world.add_body({.pose = m.world.pose(body)});
    Random& random = m.random;
    world.add("p1", Pulley::at(world, BodyId{1}, random.vector(3), kGround, random.vector(3),
                               random.vector(3), BodyId{2}, random.vector(3), 2.5));
    world.add("p2", Pulley::at(world, BodyId{3}, random.vector(3), BodyId{4}, random.vector(3),
                               random.vector(3), BodyId{2}, random.vector(3)));
    world.add("rope", Rope({{BodyId{1}, random.vector()},
                            {kGround, random.vector(4)},
                            {BodyId{2}, random.vector()},
                            {BodyId{2}, random.vector()},
                            {BodyId{3}, random.vector()}},
                           50));
    const Rows rows(world);
    ASSERT_EQ(rows.row_count(), 2 + 1 + 3);  // … and the stop of each section between two bodies
    ASSERT_EQ(rows.axis_rows().size(), 4u);  // the rope has its limits from the start
    EXPECT_TRUE(world.validate(1e-13).empty());
    WorldRowsChecker(world).check(random);
    // The length of the rope is that of its path.
    const AxisId length{{2}, 0};
    EXPECT_EQ(world.axis_properties(length).limits->upper, 50);
    EXPECT_GT(world.axis_value(length), 0);
  }
}

TEST(Wires, RopeLengthIsThatOfItsPath) {
  World world;
  const BodyId body = world.add_body({.pose = {Quat::Identity(), Vec3(3, 0, 0)}});
  const JointId rope =
      world.add("rope", Rope({{body, Vec3::Zero()}, {kGround, Vec3(3, 4, 0)}, {kGround, Vec3(0, 4, 0)}}, 20));
  EXPECT_NEAR(world.axis_value(world.axis(rope, "length")), 4 + 3, 1e-14);
  world.set_twist(body, {Vec3::Zero(), Vec3(0, 2, 0)});
  EXPECT_NEAR(world.axis_rate(world.axis(rope, "length")), -2, 1e-14);
}

// The points that pictures show, in the order of the way.
TEST(Wires, CoursesRunFromEndToEnd) {
  Machine m(3);
  const Vec3 p = m.random.vector(), c1 = m.random.vector(), c2 = m.random.vector(), q = m.random.vector();
  const WirePoint over{m.frame, m.random.vector()};
  const JointId joints[] = {
      m.world.add("rod", Distance::between(m.world, m.first, m.second, p, q)),
      m.world.add(
          "rope",
          Rope({{m.first, m.world.pose(m.first).local(p)}, over, {m.second, m.world.pose(m.second).local(q)}},
               100)),
      m.world.add("wire", Pulley::at(m.world, m.first, p, m.frame, c1, c2, m.second, q))};
  const std::vector<Vec3> expected[] = {
      {p, q}, {p, m.world.pose(m.frame).point(over.p_BP), q}, {p, c1, c2, q}};
  for (int i = 0; i < 3; ++i) {
    const std::vector<WirePoint> course = m.world.joint(joints[i]).course();
    ASSERT_EQ(course.size(), expected[i].size()) << i;
    for (std::size_t k = 0; k < course.size(); ++k)
      EXPECT_LT((m.world.pose(course[k].body).point(course[k].p_BP) - expected[i][k]).norm(), 1e-14);
  }
  EXPECT_TRUE(m.world.joint(m.first_angle.joint).course().empty());
}

TEST(Drivers, PoseDriverIsConsistent) {
  for (unsigned seed = 240; seed < 250; ++seed) {
    Random random(seed);
    World world;
    const BodyId a = world.add_body({.pose = random.pose()}), b = world.add_body({.pose = random.pose()});
    // A steady turn about a skew axis, and a translation with an acceleration.
    const Vec3 axis = random.unit(), p0 = random.vector(), v = random.vector(), acc = random.vector();
    const Quat q0 = random.rotation();
    const double amplitude = 0.8;
    world.add("drive", PoseDriver(a, b, [=](double t) {
                const double angle = amplitude * std::sin(t), rate = amplitude * std::cos(t);
                PosePoint x;
                x.pose = {exp_so3(angle * axis) * q0, p0 + t * v + 0.5 * t * t * acc};
                x.velocity = {rate * axis, v + t * acc};
                x.acceleration = {-amplitude * std::sin(t) * axis, acc};
                return x;
              }));
    world.set_time(random.uniform(0, 2));
    WorldRowsChecker(world).check(random, {.stiffness = false});
  }
}

TEST(Motions, AreConsistentWithTheirDerivatives) {
  const Curve speed({{0, 1}, {1, 3}, {2.5, -1}});
  const Motion motions[] = {linear_motion(1, -2, 0.5), harmonic_motion(1, 2, 3, 0.4),
                            spline_motion({0, 1, 1.5, 3}, {0, 2, -1, 4}), speed_motion(speed, 0.5)};
  for (const Motion& motion : motions)
    for (double t : {-0.7, 0.3, 0.9, 1.2, 2.1, 2.9, 4.0}) {
      const double h = 1e-5;
      EXPECT_NEAR(motion(t).rate, (motion(t + h).value - motion(t - h).value) / (2 * h), 1e-8) << t;
      EXPECT_NEAR(motion(t).acceleration, (motion(t + h).rate - motion(t - h).rate) / (2 * h), 1e-8) << t;
    }
  EXPECT_NEAR(speed_motion(speed, 0.5)(1).value, 2.5, 1e-15);
  EXPECT_NEAR(spline_motion({0, 1, 1.5, 3}, {0, 2, -1, 4})(1.5).value, -1, 1e-15);
}

TEST(Splines, ClosedOnesGoRoundSmoothly) {
  const CubicSpline<2> ring({0, 1, 2, 4}, {{1, 0}, {0, 1}, {-1, 0}, {1, 0}}, true);
  EXPECT_LT((ring.at(0.3).value - ring.at(4.3).value).norm(), 1e-14);
  const double h = 1e-9;
  EXPECT_LT((ring.at(4 - h).first - ring.at(h).first).norm(), 1e-7);
  EXPECT_LT((ring.at(4 - h).second - ring.at(h).second).norm(), 1e-7);
}

TEST(CouplingInput, IsChecked) {
  Machine m(9);
  World& w = m.world;
  const AxisId none{{99}, 0}, wrong{m.first_angle.joint, 3};
  expect_invalid([&] { Gear(w, none, m.second_angle, 1); }, {"joint id", "99"});
  expect_invalid([&] { Gear(w, wrong, m.second_angle, 1); }, {"axis id", "3"});
  expect_invalid([&] { Gear(w, m.first_angle, m.second_angle, 0); }, {"gear factor of h1 angle", "0"});
  expect_invalid([&] { Gear(w, m.first_angle, m.second_angle, kNan); }, {"gear factor of h1 angle", "nan"});
  expect_invalid([&] { Gear(w, m.first_angle, m.first_angle, 2); }, {"gear", "itself", "h1 angle"});
  expect_invalid([&] { RackAndPinion(w, m.travel, m.travel, 1); }, {"pinion", "angle", "rail displacement"});
  expect_invalid([&] { RackAndPinion(w, m.first_angle, m.second_angle, 1); }, {"rack", "h2 angle"});
  expect_invalid([&] { Differential(w, m.first_angle, m.second_angle, m.travel); },
                 {"differential", "angles", "rail displacement"});
  expect_invalid([&] { Differential(w, m.first_angle, m.second_angle, m.second_angle); },
                 {"differential", "twice", "h2 angle"});
  expect_invalid([&] { Driver(w, m.travel, Motion()); }, {"driver of rail displacement", "motion"});
  expect_invalid([&] { PoseDriver(m.first, m.second, PoseMotion()); }, {"pose driver", "motion"});
  expect_invalid([&] { linear_motion(0, kNan); }, {"motion rate", "nan"});
  expect_invalid([&] { harmonic_motion(0, 1, kNan); }, {"motion omega", "nan"});
  expect_invalid([&] { spline_motion({0, 0}, {1, 2}); }, {"spline parameter 2", "exceed"});
  expect_invalid([&] { spline_motion({0}, {1}); }, {"spline", "more points", "1"});
  expect_invalid([&] { spline_motion({0, 1}, {1, kNan}); }, {"spline point 2", "nan"});
  // A coupling of another world's axes.
  World other;
  const BodyId x = other.add_body({}), y = other.add_body({});
  const auto gear = std::make_shared<Gear>(w, m.first_angle, m.second_angle, 2);
  expect_invalid([&] { other.add_joint("g", gear); }, {"joint g", "3"});
  (void)x, (void)y;
}

TEST(WireInput, IsChecked) {
  const Vec3 o = Vec3::Zero(), x = Vec3::UnitX();
  const BodyId a{1}, b{2}, c{3};
  expect_invalid([&] { Rope(a, b, o, x, -1.5); }, {"rope length", "positive", "-1.5"});
  expect_invalid([&] { Rope(a, b, o, Vec3(kNan, 0, 0), 1); }, {"rope point 2", "nan"});
  expect_invalid([&] { Rope(a, b, o, x, 1, 1.5); }, {"restitution of rope length", "1.5"});
  expect_invalid([&] { Rope({{a, o}}, 1); }, {"rope", "two points", "1"});
  expect_invalid([&] { Rope({{a, o}, {a, x}}, 1); }, {"rope", "two bodies"});
  expect_invalid([&] { Pulley({a, o}, {c, o}, {c, x}, {b, o}, 0); }, {"pulley length", "0"});
  expect_invalid([&] { Pulley({a, o}, {c, o}, {c, x}, {b, o}, 1, -1); }, {"pulley ratio", "-1"});
  expect_invalid([&] { Pulley({a, o}, {c, o}, {b, x}, {b, o}, 1); }, {"pulley", "sheaves", "one body"});
  expect_invalid([&] { Pulley({a, o}, {a, o}, {a, x}, {b, o}, 1); }, {"pulley", "third body", "1"});
}

}  // namespace
}  // namespace taut::coupling_test
