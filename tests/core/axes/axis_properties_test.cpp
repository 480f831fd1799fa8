#include <limits>

#include "core/axes/axis.h"
#include "core/constraints/rows.h"
#include "core/joints/joints.h"
#include "tests/core/constraints/row_checker.h"
#include "tests/core/expect_invalid.h"

namespace taut::axis_properties_test {
namespace {

using testing::expect_invalid;
using testing::kA;
using testing::kB;
using testing::pair_of_bodies;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct OneHinge {
  World world = pair_of_bodies();
  JointId joint = world.add("elbow", Hinge::at(world, kA, kB, Vec3(1, 0, 0), Vec3::UnitZ()));
  AxisId angle = world.axis(joint, "angle");
};

TEST(AxisProperties, ChangeTheTopologyOnlyWithTheFirstAndTheLast) {
  OneHinge s;
  int topology = s.world.topology_version(), values = s.world.axis_version();
  const auto expect = [&](bool new_topology) {
    EXPECT_EQ(s.world.topology_version() != topology, new_topology);
    EXPECT_NE(s.world.axis_version(), values);
    topology = s.world.topology_version(), values = s.world.axis_version();
  };
  EXPECT_FALSE(s.world.has_axis_properties(s.joint));
  s.world.set_limits(s.angle, AxisLimits{-1, 2, 0.5});
  expect(true);
  s.world.set_limits(s.angle, AxisLimits{-2, 2});
  expect(false);
  s.world.set_motor(s.angle, AxisMotor{.target = 3, .max_force = 10});
  expect(false);
  const int state = s.world.state_version();
  s.world.set_motor_target(s.angle, 4);
  expect(false);
  EXPECT_EQ(s.world.state_version(), state);
  s.world.set_limits(s.angle, std::nullopt);
  expect(false);
  EXPECT_TRUE(s.world.has_axis_properties(s.joint));
  EXPECT_EQ(s.world.axis_properties(s.angle).motor->target, 4);
  EXPECT_FALSE(s.world.axis_properties(s.angle).limits);
  s.world.set_motor(s.angle, std::nullopt);
  expect(true);
  EXPECT_EQ(Rows(s.world).row_count(), 5);
}

TEST(AxisProperties, AreSetTogetherOrNotAtAll) {
  OneHinge s;
  AxisProperties all;
  all.set(std::optional(AxisMotor{.target = 3}));
  all.set(std::optional(AxisSpring{.stiffness = 2, .rest = 1}));
  s.world.set_axis_properties(s.angle, all);
  EXPECT_EQ(s.world.axis_properties(s.angle).motor->target, 3);
  EXPECT_EQ(s.world.spring_energy_of(s.joint, s.world.state()), 1);
  EXPECT_TRUE(s.world.axis_properties(s.angle).keeps_going());
  all.set(std::optional(AxisFriction{-1.5, 0, 0}));
  all.set(std::optional<AxisMotor>());
  expect_invalid([&] { s.world.set_axis_properties(s.angle, all); },
                 {"static friction of elbow angle", "-1.5"});
  EXPECT_TRUE(s.world.axis_properties(s.angle).motor);
  EXPECT_FALSE(s.world.axis_properties(s.angle).friction);
}

TEST(AxisProperties, RefuseWrongAxes) {
  OneHinge s;
  const JointId ball = s.world.add("wrist", Ball::at(s.world, kA, kB, Vec3::Zero()));
  const JointId both =
      s.world.add("cross", Universal::at(s.world, kA, kB, Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()));
  expect_invalid([&] { (void)s.world.axis(s.joint, "turn"); }, {"axis of elbow", "only angle", "turn"});
  expect_invalid([&] { (void)s.world.axis(both, "angle"); }, {"axis of cross", "angle_1, angle_2"});
  expect_invalid([&] { (void)s.world.axis(ball, "angle"); }, {"axis of wrist", "no free axis", "angle"});
  expect_invalid([&] { (void)s.world.axis(JointId{8}, "angle"); }, {"joint id", "8"});
  expect_invalid([&] { s.world.set_limits({s.joint, 1}, AxisLimits{}); }, {"axis id", "1"});
  expect_invalid([&] { (void)s.world.axis_value({s.joint, -1}); }, {"axis id", "-1"});
  expect_invalid([&] { s.world.set_motor_target(s.angle, 1); }, {"motor target of elbow angle", "no motor"});
  s.world.set_motor(s.angle, AxisMotor{});
  expect_invalid([&] { s.world.set_motor_target(s.angle, kNan); }, {"motor target of elbow angle", "nan"});
  expect_invalid([&] { s.world.set_axis_turns(s.angle, kNan); }, {"elbow angle", "nan"});
  State state = s.world.state();
  state.axes.pop_back();
  expect_invalid([&] { s.world.set_state(state); }, {"state", "one value per axis", "5"});
  state = s.world.state();
  state.axes[0] = kNan;
  expect_invalid([&] { s.world.set_state(state); }, {"axis value angle", "nan"});
}

TEST(AxisProperties, RefuseWrongValuesAndChangeNothing) {
  OneHinge s;
  s.world.set_limits(s.angle, AxisLimits{-1, 1});
  const int versions = s.world.axis_version() + s.world.topology_version();
  const auto refuses = [&](auto&& property, std::initializer_list<const char*> parts) {
    expect_invalid([&] { s.world.set_property(s.angle, std::optional(property)); }, parts);
    EXPECT_EQ(s.world.axis_version() + s.world.topology_version(), versions);
    EXPECT_EQ(s.world.axis_properties(s.angle).limits->upper, 1);
  };
  refuses(AxisLimits{2, 1.5}, {"lower limit of elbow angle", "upper limit 1.5", "2"});
  refuses(AxisLimits{kNan, 1}, {"lower limit of elbow angle", "nan"});
  refuses(AxisLimits{kUnlimited, kUnlimited}, {"lower limit of elbow angle", "inf"});
  refuses(AxisLimits{0, kNan}, {"upper limit of elbow angle", "nan"});
  refuses(AxisLimits{0, 1, 1.25}, {"restitution of elbow angle", "1.25"});
  refuses(AxisLimits{0, 1, kNan}, {"restitution of elbow angle", "nan"});
  refuses(AxisMotor{.target = kUnlimited}, {"motor target of elbow angle", "inf"});
  refuses(AxisMotor{.max_force = -2.5}, {"motor max_force of elbow angle", "-2.5"});
  refuses(AxisMotor{.max_force = kNan}, {"motor max_force of elbow angle", "nan"});
  refuses(AxisMotor{.max_speed = 0}, {"motor max_speed of elbow angle", "0"});
  refuses(AxisMotor{.target = 1, .max_speed = 2},
          {"motor max_speed of elbow angle", "beside a velocity", "2"});
  refuses(AxisMotor{.force_of_speed = Curve({{-1.5, 2}})}, {"speed in the motor curve of elbow", "-1.5"});
  refuses(AxisMotor{.force_of_speed = Curve({{0, 2}, {1, -2.5}})}, {"force in the motor curve", "-2.5"});
  refuses(AxisFriction{-1.5, 0, 0}, {"static friction of elbow angle", "-1.5"});
  refuses(AxisFriction{1, -1.5, 0}, {"dynamic friction of elbow angle", "-1.5"});
  refuses(AxisFriction{1, 1.25, 0}, {"dynamic friction of elbow angle", "static friction 1.0", "1.25"});
  refuses(AxisFriction{1, 1, kNan}, {"viscous friction of elbow angle", "nan"});
  refuses(AxisSpring{.stiffness = -1.5}, {"spring stiffness of elbow angle", "-1.5"});
  refuses(AxisSpring{.damping = kNan}, {"spring damping of elbow angle", "nan"});
  refuses(AxisSpring{.rest = kNan}, {"spring rest of elbow angle", "nan"});
  refuses(AxisSpring{.stiffness = 2.5, .table = Curve({{0, 0}, {1, 1}})},
          {"spring stiffness of elbow angle", "beside a table", "2.5"});
  refuses(AxisSpring{.damping = 1.5, .damping_table = Curve({{0, 0}, {1, 1}})},
          {"spring damping of elbow angle", "beside a damping table", "1.5"});
  refuses(AxisSpring{.damping_table = Curve({{0, 0.5}, {1, 1}})},
          {"damping table of elbow angle", "no force at rest", "0.5"});
  refuses(AxisSpring{.damping_table = Curve({{-1, -2}, {0, 0}, {1, 3}, {2, 2.5}})},
          {"damping table of elbow angle", "must not fall", "2.5"});
}

TEST(HingeReferences, MustBeUnitVectorsAcrossTheAxis) {
  const Vec3 z = Vec3::UnitZ(), x = Vec3::UnitX(), o = Vec3::Zero();
  expect_invalid([&] { Hinge(kA, kB, o, z, z, o, z, x); }, {"hinge reference on A", "perpendicular"});
  expect_invalid([&] { Hinge(kA, kB, o, z, x, o, z, Vec3(0, 1.25, 0)); }, {"reference on B", "1.25"});
}

// Curves.

TEST(Curves, AreLinearBetweenTheirPoints) {
  const Curve curve({{-1, 2}, {1, 4}, {2, 1}});
  EXPECT_EQ(curve.held(-1), 2);
  EXPECT_EQ(curve.held(0), 3);
  EXPECT_EQ(curve.held(1.5), 2.5);
  EXPECT_EQ(curve.held(-7), 2);
  EXPECT_EQ(curve.held(7), 1);
  EXPECT_EQ(curve.extended(-2), 1);
  EXPECT_EQ(curve.extended(3), -2);
  EXPECT_EQ(curve.slope(0), 1);
  EXPECT_EQ(curve.slope(1), -3);
  EXPECT_EQ(curve.slope(9), -3);
  const Curve constant({{3, 5}});
  EXPECT_EQ(constant.held(-1), 5);
  EXPECT_EQ(constant.extended(8), 5);
  EXPECT_EQ(constant.slope(0), 0);
}

TEST(Curves, RefuseWrongPoints) {
  expect_invalid([] { Curve({}); }, {"curve", "must have a point"});
  expect_invalid([] { Curve({{0, 1}, {0, 2}}); }, {"curve point 2", "right of", "0"});
  expect_invalid([] { Curve({{0, 1}, {1, 2}, {0.5, 2}}); }, {"curve point 3", "0.5"});
  expect_invalid([] { Curve({{0, kNan}}); }, {"curve point 1", "nan"});
  expect_invalid([] { Curve({{kUnlimited, 1}}); }, {"curve point 1", "inf"});
}

TEST(Curves, MeanIsThatOfTheIntegral) {
  const Curve curve({{-1, -4}, {0.5, 1}, {1, 5}});
  // Against sums of 1e5 midpoints, and differences of the mean.
  for (const auto& [from, to] : {std::pair(-2.0, 3.0), {3.0, -2.0}, {0.0, 0.3}, {0.9, 0.4}, {1.5, 2.0}}) {
    double sum = 0;
    const int n = 100000;
    for (int i = 0; i < n; ++i) sum += curve.extended(from + (i + 0.5) / n * (to - from)) / n;
    EXPECT_NEAR(curve.mean(from, to).value, sum, 1e-8) << from << ' ' << to;
    EXPECT_NEAR(curve.integral(from, to), sum * (to - from), 1e-7) << from << ' ' << to;
    const double h = 1e-5, ahead = curve.mean(from, to + h).value, back = curve.mean(from, to - h).value;
    EXPECT_NEAR(curve.mean(from, to).slope, (ahead - back) / (2 * h), 1e-7) << from << ' ' << to;
  }
  EXPECT_EQ(curve.mean(0.25, 0.25).value, curve.extended(0.25));
  EXPECT_EQ(Curve({{3, 7}}).mean(0, 1).value, 7);
}

TEST(Springs, EnergyIsTheIntegralOfTheForce) {
  EXPECT_NEAR(spring_energy({.stiffness = 3, .rest = 0.5}, 2.5), 6, 1e-15 * 10);
  const AxisSpring table{.rest = 0.25, .table = Curve({{-1, -4}, {0.5, 1}, {1, 5}})};
  // dU/dθ against the table by central differences, exact away from its points.
  for (double theta : {-2.0, -0.4, 0.1, 0.3, 1.0, 4.0}) {
    const double h = 1e-5;
    const double slope = (spring_energy(table, theta + h) - spring_energy(table, theta - h)) / (2 * h);
    EXPECT_NEAR(slope, table.table->extended(theta - 0.25), 1e-9) << theta;
  }
  EXPECT_EQ(spring_energy(table, 0.25), 0);
}

}  // namespace
}  // namespace taut::axis_properties_test
