#include "core/merging/merged_world.h"

#include <algorithm>

#include "core/constraints/rows.h"
#include "core/joints/joints.h"
#include "core/world/diagnostics.h"
#include "tests/core/expect_invalid.h"
#include "tests/core/random_mass.h"
#include "tests/core/world_rows_checker.h"

// Bodies that fixed joints hold together as one body.
namespace taut::merged_world_test {
namespace {

using testing::expect_invalid;
using testing::Random;
using testing::random_mass;
using testing::WorldRowsChecker;

constexpr double kTolerance = 1e-10;
/// Sums of some ten products of numbers of order one, in another order.
constexpr double kRoundOff = 1e-12;

/// Three welded pairs a1–a2, b1–b2, c1–c2 in random poses, and a post that is welded to the ground.
struct Pairs {
  Random random;
  World world;
  BodyId a1, a2, b1, b2, c1, c2, post;

  explicit Pairs(unsigned seed) : random(seed) {
    for (BodyId* body : {&a1, &a2, &b1, &b2, &c1, &c2, &post})
      *body = world.add_body({.mass = random_mass(random), .pose = random.pose(), .twist = random.twist()});
    weld(a1, a2), weld(b2, b1), weld(c1, c2), weld(kGround, post);
  }
  JointId weld(BodyId a, BodyId b) { return world.add("", Fixed::at(world, a, b, random.vector())); }
};

/// Rows of every joint that is not merged away, in the source and in the merged world, at corresponding
/// states: residual, rate, and acceleration for given accelerations.
void expect_same_rows(const World& source, MergedWorld& merged, Random& random) {
  const Rows full(source), own(merged.world());
  State at = merged.world().state(), seen;
  std::vector<Twist> V_dot(at.poses.size()), seen_V_dot(at.poses.size());
  for (int b = 1; b < merged.world().body_count(); ++b) {
    if (merged.world().is_fixed(BodyId{b})) continue;
    at.poses[b] = testing::moved(at.poses[b], random.vector(0.3), random.vector(0.3));
    at.twists[b] = random.twist(), V_dot[b] = random.twist();
  }
  merged.expand(at, seen);
  for (std::size_t b = 0; b < seen_V_dot.size(); ++b) {
    const int c = merged.carriers().bodies[b].index;
    const Vec3 arm = seen.poses[b].p - at.poses[c].p, w = at.twists[c].w;
    seen_V_dot[b] = {V_dot[c].w, V_dot[c].at(arm) + w.cross(w.cross(arm))};
  }
  const auto values = [](const Rows& rows, const State& state, const std::vector<Twist>& acceleration) {
    std::vector<double> J(rows.jacobian_size());
    std::vector<std::vector<double>> out(4, std::vector<double>(rows.row_count()));
    rows.jacobian(state, J);
    rows.residual(state, out[0]);
    rows.apply(J, state.twists, out[1]);
    rows.add_rate(state, out[1]);
    rows.apply(J, acceleration, out[2]);
    rows.bias(state, state.twists, out[3]);
    for (int r = 0; r < rows.row_count(); ++r) out[2][r] += out[3][r];
    return out;
  };
  const auto expected = values(full, seen, seen_V_dot), got = values(own, at, V_dot);
  for (int j = 0; j < source.joint_count(); ++j) {
    const Rows::JointRows &theirs = full.joints()[j], &ours = own.joints()[j];
    if (ours.row_count == 0) continue;
    ASSERT_EQ(theirs.row_count, ours.row_count) << source.name(JointId{j});
    for (int k = 0; k < 3; ++k)
      for (int i = 0; i < ours.row_count; ++i)
        EXPECT_NEAR(got[k][ours.first_row + i], expected[k][theirs.first_row + i],
                    kRoundOff * (1 + std::abs(expected[k][theirs.first_row + i])) * 100)
            << source.joint(JointId{j}).type() << " row " << i << " derivative " << k;
  }
}

using AddJoint = void (*)(Pairs&);
struct JointBetweenMembers {
  const char* type;
  AddJoint add;
  friend void PrintTo(const JointBetweenMembers& c, std::ostream* out) { *out << c.type; }
};
PosePoint swaying(double t) {
  PosePoint at;
  at.pose = {exp_so3(Vec3(0.3 * t, 0, 0)), Vec3(0.2 * t, 0.1, 0)};
  at.velocity = {Vec3(0.3, 0, 0), Vec3(0.2, 0, 0)};
  return at;
}
const JointBetweenMembers kJoints[] = {
    {"ball",
     [](Pairs& p) {
       p.world.add("j", Ball::at(p.world, p.a2, p.b1, p.random.vector()).with_axes(p.world, p.random.unit()));
     }},
    {"hinge",
     [](Pairs& p) { p.world.add("j", Hinge::at(p.world, p.a2, p.b1, p.random.vector(), p.random.unit())); }},
    {"slider",
     [](Pairs& p) { p.world.add("j", Slider::at(p.world, p.a2, p.b1, p.random.vector(), p.random.unit())); }},
    {"universal",
     [](Pairs& p) {
       Vec3 u, v;
       complete_frame(p.random.unit(), u, v);
       p.world.add("j", Universal::at(p.world, p.b2, p.a1, p.random.vector(), u, v));
     }},
    {"distance",
     [](Pairs& p) {
       p.world.add("j", Distance::between(p.world, p.a2, p.b1, p.random.vector(), p.random.vector()));
     }},
    {"cylindrical",
     [](Pairs& p) {
       p.world.add("j", Cylindrical::at(p.world, p.a1, p.b1, p.random.vector(), p.random.unit()));
     }},
    {"screw",
     [](Pairs& p) {
       p.world.add("j", Screw::at(p.world, p.a1, p.b1, p.random.vector(), p.random.unit(), 0.2));
     }},
    {"planar",
     [](Pairs& p) {
       Vec3 u, v;
       complete_frame(p.random.unit(), u, v);
       p.world.add("j", Planar::at(p.world, p.a2, p.c1, p.random.vector(), u, v));
     }},
    {"point_on_line",
     [](Pairs& p) {
       p.world.add("j", PointOnLine::at(p.world, p.a2, p.b1, p.random.vector(), p.random.unit()));
     }},
    {"hinge2",
     [](Pairs& p) {
       Vec3 u, v;
       complete_frame(p.random.unit(), u, v);
       p.world.add("j", Hinge2::at(p.world, p.a2, p.b1, p.random.vector(), u, v));
     }},
    {"six_dof",
     [](Pairs& p) {
       p.world.add("j", SixDof::at(p.world, p.a2, p.b1, p.random.vector(), p.random.rotation(),
                                   {{true, false, true}, {true, false, false}}));
     }},
    {"point_on_curve",
     [](Pairs& p) {
       const Vec3 s = p.random.vector();
       p.world.add(
           "j", PointOnCurve::through(p.world, p.a2, p.b1,
                                      {s, s + Vec3(1, 0.2, 0), s + Vec3(2, 0, 0.3), s + Vec3(3, 0, 0)}, s));
     }},
    {"pulley",
     [](Pairs& p) {
       p.world.add("j", Pulley::at(p.world, p.a2, p.random.vector(), p.b1, p.random.vector(3),
                                   p.random.vector(3), p.c2, p.random.vector(), 1.5));
     }},
    {"rope",  // twice over the same group, with a section inside it
     [](Pairs& p) {
       p.world.add("j", Rope({{p.a1, p.random.vector()},
                              {p.b1, p.random.vector()},
                              {p.b2, p.random.vector()},
                              {p.a2, p.random.vector()},
                              {kGround, p.random.vector()}},
                             20));
     }},
    {"gear",  // its two wheels sit on members of one group
     [](Pairs& p) {
       const JointId h1 =
           p.world.add("h1", Hinge::at(p.world, p.a1, p.b1, p.random.vector(), p.random.unit()));
       const JointId h2 =
           p.world.add("h2", Hinge::at(p.world, p.a2, p.c2, p.random.vector(), p.random.unit()));
       p.world.add("j", Gear(p.world, {h1, 0}, {h2, 0}, -1.7));
     }},
    {"winch",  // a coupling of a rope's length
     [](Pairs& p) {
       const JointId h = p.world.add("h", Hinge::at(p.world, p.a1, p.c1, p.random.vector(), p.random.unit()));
       const JointId rope = p.world.add(
           "r", Rope({{p.a2, p.random.vector()}, {p.b1, p.random.vector()}, {p.b2, p.random.vector()}}, 20));
       p.world.add("j", RackAndPinion(p.world, {h, 0}, {rope, 0}, 0.3));
     }},
    {"driver",
     [](Pairs& p) {
       const JointId h = p.world.add("h", Hinge::at(p.world, p.a2, p.b1, p.random.vector(), p.random.unit()));
       p.world.add("j", Driver(p.world, {h, 0}, harmonic_motion(0, 0.5, 2)));
     }},
    {"pose_driver", [](Pairs& p) { p.world.add("j", PoseDriver(p.a2, p.b1, swaying)); }},
    {"soft ball",
     [](Pairs& p) {
       const JointId j = p.world.add("j", Ball::at(p.world, p.a2, p.b1, p.random.vector()));
       p.world.set_compliance(j, JointCompliance{1e-3, 0, 2, 0});
     }},
    {"hinge on the ground",
     [](Pairs& p) {
       p.world.add("j", Hinge::at(p.world, p.post, p.b1, p.random.vector(), p.random.unit()));
     }},
};

class MergedRows : public ::testing::TestWithParam<JointBetweenMembers> {};

TEST_P(MergedRows, AreThoseOfTheMembers) {
  for (unsigned seed = 1; seed < 6; ++seed) {
    Pairs p(seed);
    GetParam().add(p);
    for (int j = 0; j < p.world.joint_count(); ++j)
      for (int k = 0; k < p.world.axis_count(JointId{j}); ++k)
        p.world.set_friction({JointId{j}, k}, AxisFriction{.viscous = 1});  // gives every axis its row
    p.world.set_time(0.4);
    MergedWorld merged(p.world, kTolerance);
    ASSERT_EQ(merged.groups().size(), 4u);
    expect_same_rows(p.world, merged, p.random);
    // The axes as the world keeps them.
    World at = p.world;
    State seen;
    merged.expand(merged.world().state(), seen);
    at.set_state(seen);
    for (int j = 0; j < p.world.joint_count(); ++j)
      for (int k = 0; k < p.world.axis_count(JointId{j}); ++k) {
        const AxisId axis{JointId{j}, k};
        EXPECT_NEAR(merged.world().axis_rate(axis), at.axis_rate(axis), 100 * kRoundOff);
        EXPECT_NEAR(merged.world().axis_value(axis), at.axis_value(axis), 100 * kRoundOff);
      }
  }
}
INSTANTIATE_TEST_SUITE_P(AllTypes, MergedRows, ::testing::ValuesIn(kJoints), [](const auto& test_case) {
  std::string name = test_case.param.type;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
});

TEST(MergedRows, HaveTheJacobianBiasAndStiffnessOfTheirResidual) {
  Pairs p(7);
  p.world.add("ball", Ball::at(p.world, p.a2, p.b1, p.random.vector()));
  p.world.add("distance", Distance::between(p.world, p.b2, p.c1, p.random.vector(), p.random.vector()));
  p.world.add("pulley", Pulley::at(p.world, p.a1, p.random.vector(), kGround, Vec3(0, 0, 5), Vec3(1, 0, 5),
                                   p.c2, p.random.vector(), 1.5));
  const MergedWorld merged(p.world, kTolerance);
  WorldRowsChecker(merged.world()).check(p.random);
}

TEST(MergedWorld, OfFourCubesIsABar) {
  World world;
  std::vector<BodyId> cubes;
  const Quat q = Quat(Eigen::AngleAxisd(0.5, Vec3(1, 2, 2) / 3));
  for (int i = 0; i < 4; ++i) {  // each turned by a quarter more about the bar
    const Quat own = q * Quat(Eigen::AngleAxisd(i * std::acos(0.0), Vec3::UnitX()));
    cubes.push_back(world.add_body(
        {.mass = MassProperties::box(Vec3(1, 1, 1), 2), .pose = {own, Vec3(1, 2, 3) + q * Vec3(i, 0, 0)}}));
    if (i > 0) world.add("", Fixed::at(world, cubes[i], cubes[i - 1], Vec3(0.3, 0.2, 0.1)));
  }
  const MergedWorld merged(world, kTolerance);
  ASSERT_EQ(merged.groups().size(), 1u);
  EXPECT_EQ(merged.groups()[0].carrier, cubes[0]);
  const MassProperties& bar = merged.world().mass_properties(cubes[0]);
  const MassProperties expected = MassProperties::box({4, 1, 1}, 8);
  EXPECT_NEAR(bar.mass(), 8, kRoundOff);
  EXPECT_LT((bar.inertia_B() - expected.inertia_B()).norm(), 10 * kRoundOff);
  EXPECT_LT((merged.world().pose(cubes[0]).p - (Vec3(1, 2, 3) + q * Vec3(1.5, 0, 0))).norm(), kRoundOff);
  EXPECT_EQ(merged.world().moving_body_count(), 1);
}

TEST(MergedWorld, HasTheEnergyAndMomentumOfItsMembers) {
  for (unsigned seed = 20; seed < 30; ++seed) {
    Pairs p(seed);
    p.world.add_force(SpringDamper(p.a2, p.b1, p.random.vector(), p.random.vector(), 50, 0.3, 2));
    p.world.add_force(PointForce(p.c2, p.random.vector(), p.random.vector(3)));
    p.world.add_force(ForceCallback(
        [a = p.a1.index](const State& s, std::span<Wrench> F) { F[a].force -= 0.3 * s.twists[a].v; }));
    MergedWorld merged(p.world, kTolerance);
    State seen;
    merged.expand(merged.world().state(), seen);
    const World& own = merged.world();
    EXPECT_NEAR(kinetic_energy(own, own.state()), kinetic_energy(p.world, seen), 100 * kRoundOff);
    EXPECT_NEAR(own.potential_energy(own.state()), p.world.potential_energy(seen), 1000 * kRoundOff);
    EXPECT_LT((linear_momentum(own, own.state()) - linear_momentum(p.world, seen)).norm(), 100 * kRoundOff);
    EXPECT_LT((angular_momentum(own, own.state()) - angular_momentum(p.world, seen)).norm(), 100 * kRoundOff);
    // Power of the forces along any motion of the groups is the same.
    std::vector<Wrench> on_own(own.body_count()), on_source(own.body_count());
    own.forces(own.state(), on_own);
    p.world.forces(seen, on_source);
    double power = 0, expected = 0;
    for (int b = 0; b < own.body_count(); ++b) {
      power += dot(on_own[b], own.state().twists[b]);
      expected += dot(on_source[b], seen.twists[b]);
    }
    EXPECT_NEAR(power, expected, 1000 * kRoundOff);
  }
}

TEST(MergedWorld, KeepsTheMomentumOfTwistsThatDoNotFit) {
  Pairs p(31);  // random twists of each body
  const MergedWorld merged(p.world, kTolerance);
  World freed = p.world;  // what is welded to the ground gives its momentum away
  freed.set_twist(p.post, {});
  EXPECT_LT((linear_momentum(merged.world(), merged.world().state()) - linear_momentum(freed, freed.state()))
                .norm(),
            100 * kRoundOff);
  EXPECT_LT(
      (angular_momentum(merged.world(), merged.world().state()) - angular_momentum(freed, freed.state()))
          .norm(),
      100 * kRoundOff);
}

TEST(MergedWorld, TakesTheNearestPoseWhereWeldsAreOpen) {
  Pairs p(32);
  for (BodyId body : {p.a1, p.a2})
    p.world.set_pose(body, testing::moved(p.world.pose(body), p.random.vector(0.05), p.random.vector(0.05)));
  const MergedWorld merged(p.world, kTolerance);
  // Σ m |move|² + θ·I θ of the members of group 0.
  const auto cost = [&](const Pose& X_WC) {
    double sum = 0;
    for (BodyId body : {p.a1, p.a2}) {
      const Pose to = X_WC * merged.carriers().frames[body.index];
      const Pose& from = p.world.pose(body);
      const Vec3 theta = from.q.conjugate() * log_so3(to.q * from.q.conjugate());
      const MassProperties& mass = p.world.mass_properties(body);
      sum += mass.mass() * (to.p - from.p).squaredNorm() + theta.dot(mass.inertia_B() * theta);
    }
    return sum;
  };
  const Pose best = merged.world().pose(p.a1);
  for (int trial = 0; trial < 50; ++trial) {
    const double step = trial % 2 ? 1e-2 : 1e-3;
    EXPECT_GT(cost(testing::moved(best, step * p.random.unit(), step * p.random.unit())), cost(best));
  }
}

/// Joints that are merged away.
int merged_count(const World& world) {
  int count = 0;
  for (const MergedGroup& group : merged_groups(world, kTolerance))
    count += static_cast<int>(group.members.size() + group.loops.size()) - !group.fixed;
  return count;
}

TEST(MergedGroups, LeaveOutWhatMayGiveWay) {
  Pairs p(40);
  EXPECT_EQ(merged_count(p.world), 4);
  World world = p.world;
  world.set_break(JointId{0}, BreakLimits{.force = 100});
  EXPECT_EQ(merged_count(world), 3);
  world.set_break(JointId{0}, {});
  EXPECT_EQ(merged_count(world), 4);
  world.set_compliance(JointId{1}, JointCompliance{.translation = 1e-4});
  EXPECT_EQ(merged_count(world), 3);
  world.detach(JointId{2});
  EXPECT_EQ(merged_count(world), 2);
  world.attach(JointId{2});
  EXPECT_EQ(merged_count(world), 3);
}

TEST(MergedGroups, LeaveOutGroupsWithOtherJointsInside) {
  Pairs p(41);
  World world = p.world;
  world.add("beside", Hinge::at(world, p.a1, p.a2, Vec3::Zero(), Vec3::UnitX()));
  EXPECT_EQ(merged_count(world), 3);
  world = p.world;
  world.add("held", Ball::at(world, kGround, p.post, Vec3::Zero()));
  EXPECT_EQ(merged_count(world), 3);
  world = p.world;  // two groups at the ground, and what joins them has nothing to do
  world.add("foot", Fixed::at(world, p.a1, kGround, Vec3::Zero()));
  EXPECT_EQ(merged_count(world), 5);
  world.add("between", Ball::at(world, p.a2, p.post, Vec3::Zero()));
  EXPECT_EQ(merged_count(world), 2);
  world = p.world;
  const JointId rope = world.add("rope", Rope({{p.a1}, {p.b1}, {p.a2}}, 20));
  EXPECT_EQ(merged_count(world), 4);
  world.set_break(rope, BreakLimits{.force = 10});
  EXPECT_EQ(merged_count(world), 3);
}

TEST(MergedGroups, LeaveOutWeldsThatDoNotFit) {
  Pairs p(42);
  World world = p.world;
  world.add("again", Fixed::at(world, p.a2, p.a1, Vec3::Zero()));
  EXPECT_EQ(merged_count(world), 5);
  const Pose X = Pose{world.pose(p.b1).q.conjugate(), Vec3::Zero()} * Pose{world.pose(p.b2).q, Vec3::Zero()};
  world.add("askew", Fixed(p.b1, p.b2, world.pose(p.b1).local(world.pose(p.b2).p) + Vec3(1e-6, 0, 0),
                           Vec3::Zero(), X.q));
  EXPECT_EQ(merged_count(world), 4);
  const BodyId wall = world.add_body({.pose = p.random.pose(), .fixed = true});
  world.add("second ground", Fixed::at(world, wall, p.post, Vec3::Zero()));
  EXPECT_EQ(merged_count(world), 3);
}

/// A part that cannot say how it looks from another body.
struct Unmovable : row_parts::PointInPlane {};
class UnmovableJoint final : public Joint {
 public:
  using Joint::Joint;
  std::string_view type() const override { return "unmovable"; }
  void append_rows(RowSink& rows) const override {
    rows.add(Unmovable{{Vec3::Zero(), Vec3::UnitX(), Vec3::Zero()}});
  }
  Vec3 reaction_point_B() const override { return Vec3::Zero(); }
};

TEST(MergedWorld, NamesPartsThatCannotBeMoved) {
  Pairs p(43);
  p.world.add("strange", UnmovableJoint(p.a1, p.b1));
  expect_invalid([&] { MergedWorld(p.world, kTolerance); }, {"joint strange", "carried()", "unmovable"});
}

}  // namespace
}  // namespace taut::merged_world_test
