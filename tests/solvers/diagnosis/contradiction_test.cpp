#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "core/joints/joints.h"
#include "solvers/simulator/simulator.h"

/// Sets of joints, limits, motors and contacts that exclude each other, known by how they were made.
namespace taut::contradiction_test {
namespace {

using Names = std::set<std::string>;
using Kind = Contradiction::Bound::Kind;

constexpr double kDt = 2e-3;

BodyId add_rod(World& world, const std::string& name, const Vec3& from, const Vec3& to, double mass = 1) {
  const Vec3 along = to - from;
  BodySpec rod{.name = name, .mass = MassProperties::box(Vec3(along.norm(), 0.05, 0.05), mass)};
  rod.pose.p = 0.5 * (from + to);
  rod.pose.q = Quat::FromTwoVectors(Vec3::UnitX(), along);
  return world.add_body(rod);
}

BodyId add_ball(World& world, const std::string& name, const Vec3& p, double mass = 1) {
  BodySpec ball{.name = name, .mass = MassProperties::sphere(0.1, mass)};
  ball.pose.p = p;
  return world.add_body(ball);
}

/// A pendulum that has nothing to do with it, on that body.
void add_bystander(World& world, BodyId on, const Vec3& at) {
  const std::string name = "bystander " + std::to_string(world.body_count());
  const BodyId rod = add_rod(world, name, at, at + Vec3(0.1, 0.3, 0));
  const JointId joint = world.add(name, Hinge::at(world, on, rod, at, Vec3::UnitZ()));
  world.set_limits(world.axis(joint, "angle"), AxisLimits{-1, 1});
}

/// The report of the step that fails, or of the last one.
StepReport run(World& world, int steps = 400, const Settings& settings = {}) {
  Simulator simulator(world, settings);
  for (int i = 0; i < steps; ++i)
    if (!simulator.step(kDt).ok()) break;
  return simulator.report();
}

/// A copy of the world in which one bound is not there.
World without(const World& world, const Contradiction::Bound& bound) {
  World copy = world;
  const AxisProperties& p = world.axis_properties(bound.axis);
  if (bound.kind == Kind::kMotor) {
    copy.set_motor(bound.axis, {});
    return copy;
  }
  AxisLimits limits = *p.limits;
  (bound.kind == Kind::kLowerLimit ? limits.lower : limits.upper) =
      bound.kind == Kind::kLowerLimit ? -kUnlimited : kUnlimited;
  copy.set_limits(bound.axis, limits);
  return copy;
}

/// All copies that lack one member.
std::vector<World> reduced_worlds(const World& world, const Contradiction& found) {
  std::vector<World> worlds;
  for (JointId joint : found.joints) {
    worlds.push_back(world);
    worlds.back().detach(joint);
  }
  for (const auto& bound : found.bounds) worlds.push_back(without(world, bound));
  for (const auto& touch : found.contacts) {
    worlds.push_back(world);
    worlds.back().set_collision(touch.a, touch.b, false);
  }
  return worlds;
}

/// The step that failed succeeds in each world that lacks one member.
void expect_irreducible(const World& world, const Contradiction& found, const Settings& settings = {}) {
  const std::vector<std::string> names = names_of(found, world);
  std::size_t member = 0;
  for (World& reduced : reduced_worlds(world, found)) {
    Simulator simulator(reduced, settings);
    const StepReport& report = simulator.step(kDt);
    EXPECT_TRUE(report.ok()) << "without " << names[member] << ": " << report.message;
    ++member;
  }
}

void expect_set(const World& world, const StepReport& report, const Names& expected) {
  EXPECT_EQ(report.status, Status::kContradiction) << report.message;
  const std::vector<std::string> names = names_of(report.contradiction, world);
  EXPECT_EQ(Names(names.begin(), names.end()), expected) << report.message;
  EXPECT_EQ(names.size(), expected.size());
  const bool all_shown = expected.size() <= 8;
  for (const std::string& name : all_shown ? expected : Names{})
    EXPECT_NE(report.message.find(name), std::string::npos) << report.message;
  EXPECT_GT(report.contradiction.residual, 1e-8);
}

/// A wheel on a hinge, with a bystander.
struct Wheel {
  World world;
  BodyId wheel;
  JointId elbow;
  AxisId angle;
  Wheel() {
    wheel = add_rod(world, "wheel", Vec3(0, 0, 0), Vec3(1, 0, 0));
    elbow = world.add("elbow", Hinge::at(world, kGround, wheel, Vec3::Zero(), Vec3::UnitZ()));
    angle = world.axis(elbow, "angle");
    add_bystander(world, wheel, Vec3(1, 0, 0));
    world.set_gravity(Vec3::Zero());
  }
};

TEST(Contradictions, TwoDriversThatDisagree) {
  Wheel w;
  w.world.add("crank", Driver(w.world, w.angle, linear_motion(0, 1)));
  w.world.add("other", Driver(w.world, w.angle, linear_motion(0, 1.5)));
  w.world.set_limits(w.angle, AxisLimits{-3, 3});
  const StepReport report = run(w.world);
  expect_set(w.world, report, {"driver crank", "driver other"});
  expect_irreducible(w.world, report.contradiction);
  EXPECT_EQ(w.world.time(), 0);
  // Both move the same wheel: each takes a half of what they are apart after a step.
  EXPECT_NEAR(report.contradiction.residual, 0.25 * kDt, 1e-6);
}

TEST(Contradictions, ADriverAgainstALimit) {
  Wheel w;
  w.world.set_limits(w.angle, AxisLimits{-1, 0.3});
  w.world.add("crank", Driver(w.world, w.angle, linear_motion(0, 1)));
  const StepReport report = run(w.world);
  expect_set(w.world, report, {"driver crank", "upper limit of hinge elbow angle"});
  expect_irreducible(w.world, report.contradiction);
  EXPECT_NEAR(w.world.time(), 0.3, 2 * kDt);
  ASSERT_EQ(report.contradiction.bounds.size(), 1u);
  EXPECT_EQ(report.contradiction.bounds[0].axis, w.angle);
  EXPECT_EQ(report.contradiction.bounds[0].kind, Kind::kUpperLimit);
}

/// Two hinges about one axis whose limits leave no angle to both.
TEST(Contradictions, LimitsThatCrossFromTheStart) {
  Wheel w;
  const JointId twin = w.world.add("twin", Hinge::at(w.world, kGround, w.wheel, Vec3::Zero(), Vec3::UnitZ()));
  w.world.set_limits(w.angle, AxisLimits{0.1, 1});
  w.world.set_limits(w.world.axis(twin, "angle"), AxisLimits{-1, -0.1});
  Simulator simulator(w.world);
  const Contradiction before = simulator.contradiction();
  const StepReport report = run(w.world);
  expect_set(w.world, report, {"lower limit of hinge elbow angle", "upper limit of hinge twin angle"});
  EXPECT_EQ(before.bounds, report.contradiction.bounds);
  EXPECT_TRUE(before.joints.empty());
  EXPECT_NEAR(before.residual, 0.1, 1e-6);
  expect_irreducible(w.world, report.contradiction);
}

/// ground - O - one - A - two - B - ground: three parallel hinges lock each other, and repeat rows.
struct Triangle {
  World world;
  AxisId at_O, at_A;
  Triangle() {
    const BodyId one = add_rod(world, "one", Vec3(0, 0, 0), Vec3(1, 1, 0));
    const BodyId two = add_rod(world, "two", Vec3(1, 1, 0), Vec3(2, 0, 0));
    const JointId O = world.add("O", Hinge::at(world, kGround, one, Vec3(0, 0, 0), Vec3::UnitZ()));
    const JointId A = world.add("A", Hinge::at(world, one, two, Vec3(1, 1, 0), Vec3::UnitZ()));
    world.add("B", Hinge::at(world, kGround, two, Vec3(2, 0, 0), Vec3::UnitZ()));
    at_O = world.axis(O, "angle"), at_A = world.axis(A, "angle");
    add_bystander(world, two, Vec3(2, 0, 0));
  }
};

TEST(Contradictions, AMotorDrivesALockedLoop) {
  Triangle t;
  t.world.set_motor(t.at_O, AxisMotor{.target = 0.5});
  const StepReport report = run(t.world);
  expect_set(t.world, report, {"hinge O", "hinge A", "hinge B", "motor of hinge O angle"});
  expect_irreducible(t.world, report.contradiction);
  // A motor that gives way stalls.
  t.world.set_motor(t.at_O, AxisMotor{.target = 0.5, .max_force = 10});
  EXPECT_TRUE(run(t.world, 10).exact());
}

TEST(Contradictions, LimitsThatALockedLoopCrosses) {
  Triangle t;
  t.world.set_limits(t.at_A, AxisLimits{0.2, 1});
  Simulator simulator(t.world);
  const std::vector<std::string> names = names_of(simulator.contradiction(), t.world);
  const Names expected{"hinge O", "hinge A", "hinge B", "lower limit of hinge A angle"};
  EXPECT_EQ(Names(names.begin(), names.end()), expected);
  EXPECT_EQ(t.world.time(), 0);
  const StepReport report = run(t.world);
  expect_set(t.world, report, expected);
  expect_irreducible(t.world, report.contradiction);
}

TEST(Contradictions, ARopeAtFullLengthAgainstADriver) {
  World world;
  const BodyId block = add_ball(world, "block", Vec3(1, 0, 0));
  const JointId slide = world.add("slide", Slider::at(world, kGround, block, Vec3(1, 0, 0), Vec3::UnitX()));
  world.add("winch", Driver(world, world.axis(slide, "displacement"), linear_motion(0, 1)));
  world.add("rope", Rope(kGround, block, Vec3(0, 0, 0), Vec3::Zero(), 1.2));
  world.add("slack", Rope(kGround, block, Vec3(0, 1, 0), Vec3::Zero(), 3));
  const StepReport report = run(world);
  expect_set(world, report, {"driver winch", "upper limit of rope rope length"});
  expect_irreducible(world, report.contradiction);
  EXPECT_NEAR(world.time(), 0.2, 2 * kDt);
}

/// Ground 2 m, crank 1 m, coupler and rocker 1.2 m: the crank turns up to where both are in line.
TEST(Contradictions, AFourBarDrivenBeyondItsDeadPoint) {
  World world;
  world.set_gravity(Vec3::Zero());
  const Vec3 O(0, 0, 0), A(0.5, std::sqrt(0.75), 0), D(2, 0, 0);
  const Vec3 middle = 0.5 * (A + D), across = Vec3::UnitZ().cross(D - A).normalized();
  const Vec3 B = middle + std::sqrt(1.44 - 0.25 * (D - A).squaredNorm()) * across;
  const BodyId crank = add_rod(world, "crank", O, A), coupler = add_rod(world, "coupler", A, B),
               rocker = add_rod(world, "rocker", B, D);
  const JointId o = world.add("O", Hinge::at(world, kGround, crank, O, Vec3::UnitZ()));
  world.add("A", Hinge::at(world, crank, coupler, A, Vec3::UnitZ()));
  world.add("B", Hinge::at(world, coupler, rocker, B, Vec3::UnitZ()));
  world.add("D", Hinge::at(world, kGround, rocker, D, Vec3::UnitZ()));
  add_bystander(world, rocker, D);
  world.add("drive", Driver(world, world.axis(o, "angle"), linear_motion(0, 1)));
  const StepReport report = run(world, 2000);
  expect_set(world, report, {"hinge O", "hinge A", "hinge B", "hinge D", "driver drive"});
  // |A − D| = 2.4 at a crank angle of acos((1 + 4 − 5.76)/4); it began at 60°.
  const double dead = std::acos(-0.76 / 4) - M_PI / 3;
  EXPECT_NEAR(world.time(), dead, 5 * kDt);
  EXPECT_LT(world.time(), dead);
}

/// A press pushes a box into the ground.
TEST(Contradictions, AContactBetweenADriverAndTheGround) {
  World world;
  world.set_gravity(Vec3::Zero());
  world.add_shape(kGround, HalfSpace{});
  BodySpec spec{.name = "box", .mass = MassProperties::box(Vec3(0.4, 0.4, 0.2), 1)};
  spec.pose.p = Vec3(0, 0, 0.15);
  const BodyId box = world.add_body(spec);
  world.add_shape(box, Box{Vec3(0.4, 0.4, 0.2)});
  const JointId slide = world.add("slide", Slider::at(world, kGround, box, spec.pose.p, -Vec3::UnitZ()));
  world.set_collision(kGround, box, true);
  world.add("press", Driver(world, world.axis(slide, "displacement"), linear_motion(0, 0.5)));
  const BodyId neighbour = add_ball(world, "neighbour", Vec3(1, 0, 0.1));
  world.add_shape(neighbour, Sphere{0.1});
  const StepReport report = run(world);
  expect_set(world, report, {"driver press", "contact of ground and box"});
  expect_irreducible(world, report.contradiction);
  EXPECT_NEAR(world.time(), 0.1, 2 * kDt);
}

/// Boxes one upon the other under a press that is driven into them, beside a box that is not.
TEST(Contradictions, AStackInAPress) {
  World world;
  world.set_gravity(Vec3::Zero());
  world.add_shape(kGround, HalfSpace{});
  Names expected{"driver press", "contact of ground and box 0", "contact of box 2 and plate"};
  const Vec3 size(0.4, 0.4, 0.2);
  for (int i = 0; i < 4; ++i) {
    BodySpec spec{.name = i < 3 ? "box " + std::to_string(i) : "plate", .mass = MassProperties::box(size, 1)};
    spec.pose.p = Vec3(0.01 * i, 0, 0.1 + 0.201 * i);
    world.add_shape(world.add_body(spec), Box{size});
    if (i > 0 && i < 3)
      expected.insert("contact of box " + std::to_string(i - 1) + " and box " + std::to_string(i));
  }
  BodySpec aside{.name = "aside", .mass = MassProperties::box(size, 1)};
  aside.pose.p = Vec3(1, 0, 0.1);
  world.add_shape(world.add_body(aside), Box{size});
  const BodyId plate = world.body("plate");
  const JointId slide =
      world.add("slide", Slider::at(world, kGround, plate, world.pose(plate).p, -Vec3::UnitZ()));
  world.add("press", Driver(world, world.axis(slide, "displacement"), linear_motion(0, 0.1)));
  const StepReport report = run(world);
  expect_set(world, report, expected);
  expect_irreducible(world, report.contradiction);
}

/// Rods in a row from the ground to a sled that a driver pulls out of their reach, at an angle to its way.
TEST(Contradictions, RowsOfRodsThatAreTooShort) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> part(0, 1);
  for (int trial = 0; trial < 12; ++trial) {
    World world;
    world.set_gravity(Vec3::Zero());
    const int rods = 2 + trial % 5;
    Names expected{"slider sled", "driver pull", "ball last"};
    Vec3 end = Vec3::Zero();
    BodyId before = kGround;
    for (int i = 0; i < rods; ++i) {
      const std::string name = "rod " + std::to_string(i);
      const Vec3 sag(0, 0, i == 0 ? -0.02 : i == rods - 1 ? 0.02 : 0.01 * (part(random) - 0.5));
      const Vec3 next = end + (0.2 + part(random)) * Vec3(1, 1, 0).normalized() + sag;
      const BodyId rod = add_rod(world, name, end, next, std::pow(10, 2 * part(random) - 1));
      world.add(name, Ball::at(world, before, rod, end));
      expected.insert("ball " + name);
      if (part(random) < 0.5) add_bystander(world, rod, next);
      end = next, before = rod;
    }
    const BodyId sled = add_ball(world, "sled", end);
    world.add("last", Ball::at(world, before, sled, end));
    const JointId slide = world.add("sled", Slider::at(world, kGround, sled, end, Vec3::UnitX()));
    world.add("pull", Driver(world, world.axis(slide, "displacement"), linear_motion(0, 0.2)));
    add_bystander(world, sled, end);
    SCOPED_TRACE(trial);
    const StepReport report = run(world, 200);
    expect_set(world, report, expected);
    expect_irreducible(world, report.contradiction);
  }
}

/// Bodies along one line with bounds on the ways between them, upper: x_to − x_from ≤ most.
struct Differences {
  struct Edge {
    int from, to;
    double most;
    std::string name;
  };
  int bodies;
  std::vector<Edge> edges;

  /// Whether some x meets them all: no cycle of negative length [Bellman-Ford].
  bool hold(const std::set<std::string>& names) const {
    std::vector<double> x(bodies, 0.0);
    for (int round = 0; round <= bodies; ++round) {
      bool changed = false;
      for (const Edge& edge : edges) {
        if (!names.contains(edge.name) || x[edge.to] <= x[edge.from] + edge.most + 1e-12) continue;
        x[edge.to] = x[edge.from] + edge.most;
        changed = true;
      }
      if (!changed) return true;
    }
    return false;
  }
};

/// Sliders with limits and drivers between random pairs of bodies on a line, against shortest paths.
TEST(Contradictions, OfRandomWaysAreNegativeCycles) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> part(0, 1);
  int contradictions = 0, large = 0;
  for (int trial = 0; trial < 80; ++trial) {
    SCOPED_TRACE(trial);
    World world;
    Differences ways{.bodies = 4 + trial % 4, .edges = {}};
    std::vector<BodyId> ids{kGround};
    for (int i = 1; i < ways.bodies; ++i)
      ids.push_back(add_ball(world, "", Vec3::Zero(), std::pow(10, 2 * part(random) - 1)));
    for (int k = 0; k < ways.bodies + 1; ++k) {
      const int a = static_cast<int>(random() % ways.bodies), b = static_cast<int>(random() % ways.bodies);
      if (a == b) continue;
      const std::string name = "way " + std::to_string(k);
      const JointId joint = world.add(
          name, Slider(ids[a], ids[b], Vec3::Zero(), Vec3::UnitX(), Vec3::Zero(), Quat::Identity()));
      const AxisId axis = world.axis(joint, "displacement");
      const std::string label = " limit of slider " + name + " displacement";
      if (part(random) < 0.2) {
        const double value = 0.4 * part(random) - 0.2;
        world.add("drive " + name, Driver(world, axis, linear_motion(value, 0)));
        ways.edges.push_back({a, b, value, "driver drive " + name});
        ways.edges.push_back({b, a, -value, "driver drive " + name});
      } else {
        const double lower = 0.5 * part(random) - 0.4, upper = lower + 0.3 * part(random);
        world.set_limits(axis, AxisLimits{lower, upper});
        ways.edges.push_back({a, b, upper, "upper" + label});
        ways.edges.push_back({b, a, -lower, "lower" + label});
      }
    }
    Names all;
    for (const auto& edge : ways.edges) all.insert(edge.name);
    Simulator simulator(world);
    const Contradiction found = simulator.contradiction();
    ASSERT_EQ(found.empty(), ways.hold(all));
    if (found.empty()) continue;
    ++contradictions;
    const std::vector<std::string> listed = names_of(found, world);
    const Names names(listed.begin(), listed.end());
    large += names.size() >= 3;
    EXPECT_FALSE(ways.hold(names));
    for (const std::string& name : names) {
      Names rest = names;
      rest.erase(name);
      EXPECT_TRUE(ways.hold(rest)) << "without " << name;
    }
  }
  EXPECT_GT(contradictions, 15);
  EXPECT_LT(contradictions, 70);
  EXPECT_GT(large, 5);
}

}  // namespace
}  // namespace taut::contradiction_test
