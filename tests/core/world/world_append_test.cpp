#include <gtest/gtest.h>

#include "core/constraints/rows.h"
#include "core/joints/joints.h"
#include "core/world/world.h"
#include "tests/core/expect_invalid.h"
#include "tests/core/random_state.h"

/// World::append(): rows, forces, shapes and properties of a part are those of the world that it came from.
namespace taut::world_append_test {
namespace {

using testing::expect_invalid;
using testing::Random;

/// Something of every kind that holds ids: joints of several bodies, couplings of axes, drivers, forces.
World part() {
  Random random(5);
  World world;
  const auto body = [&](const char* name) {
    BodySpec spec{.name = name, .mass = MassProperties(2, Vec3(1, 2, 2.5))};
    spec.pose = random.pose();
    spec.twist = random.twist();
    return world.add_body(spec);
  };
  const BodyId a = body("a"), b = body("b"), c = body("c");
  BodySpec wall{.name = "wall"};
  wall.fixed = true;
  wall.pose = random.pose();
  const BodyId w = world.add_body(wall);

  const JointId hinge = world.add("hinge", Hinge::at(world, kGround, a, random.vector(), random.unit()));
  const JointId slider = world.add("slider", Slider::at(world, a, b, random.vector(), random.unit()));
  const JointId ball = world.add(
      "ball", Ball::at(world, b, c, random.vector()).with_axes(random.rotation(), random.rotation()));
  const AxisId angle = world.axis(hinge, "angle"), way = world.axis(slider, "displacement");
  world.add("rack", RackAndPinion(world, angle, way, 0.3));
  world.add("driver", Driver(world, way, harmonic_motion(0.1, 0.5, 3)));
  world.add("pose", PoseDriver(w, c,
                               pose_motion({linear_motion(1, 2), {}, {}},
                                           {{Vec3::UnitX(), harmonic_motion(0, 1, 2)}})));
  world.add("pulley", Pulley::at(world, a, random.vector(), kGround, Vec3(0, 0, 5), Vec3(1, 0, 5), c,
                                 random.vector(), 1.5));
  world.add("rope", Rope({{a, random.vector()}, {w, random.vector()}, {b, random.vector()}}, 2.5, 0.3));
  world.add("free", Fixed::at(world, w, b, Vec3::Zero()));
  world.detach(world.joint("free"));

  world.set_axis_turns(angle, 20);
  world.set_limits(angle, AxisLimits{-1, 25, 0.5});
  world.set_spring(angle, AxisSpring{.stiffness = 3, .damping = 0.1, .rest = 19});
  world.set_motor(way, AxisMotor{.mode = AxisMotor::Mode::kTrajectory, .trajectory = linear_motion(0, 1)});
  world.set_friction(world.axis(ball, "turn_y"), AxisFriction{2, 1, 0.5, 0.25});
  world.set_limits(world.axis(ball, "swing"), AxisLimits{.upper = 1.5});
  world.set_compliance(slider, JointCompliance{1e-3, 0, 5, 0});
  world.set_break(ball, BreakLimits{100, 200});

  world.add_force(PointForce(a, Vec3(1, 0, 0), Vec3(1, 2, 3)));
  world.add_force(PointForce(b, Vec3(0, 1, 0), Vec3(3, 2, 1), true));
  world.add_force(BodyTorque(c, Vec3(0, 4, 0)));
  world.add_force(SpringDamper(kGround, c, Vec3(0, 0, 1), Vec3(1, 0, 0), 20, 0.5, 0.7));
  world.add_force(ForceCallback(
      [=](const State& state, std::span<Wrench> on) {  // reads everything: places, rates, axes, time
        const int index = 0;
        on[b.index].force += Vec3(state.poses[b.index].p.x(), state.twists[c.index].w.y(), state.axes[index]);
        on[a.index].torque += state.poses[a.index].q * Vec3(state.time, 1, 0);
        on[kGround.index].force -= state.twists[b.index].v;
      },
      true, [=](const State& state) { return 3 * state.poses[b.index].p.z(); }));

  const ShapeId floor = world.add_shape(kGround, HalfSpace{}, {}, Material{.restitution = 0.5});
  const ShapeId ball_shape = world.add_shape(a, Sphere{0.5}, random.pose(), {}, {2, 5});
  world.add_shape(w, Box{Vec3(1, 2, 3)}, random.pose());
  world.set_contact_material(floor, ball_shape, Material{.static_friction = 0.9});
  world.set_collision(a, c, false);
  world.set_collision(kGround, a, true);
  world.set_time(0.75);
  return world;
}

/// The part's state as it is in a world that it was appended to with the pose X of its frame.
State moved(State target, const State& state, const Relocation& to, const Pose& X) {
  for (std::size_t b = 1; b < state.poses.size(); ++b) {
    const int index = to.body(static_cast<int>(b));
    target.poses[index] = {(X.q * state.poses[b].q).normalized(), X.point(state.poses[b].p)};
    target.twists[index] = {X.q * state.twists[b].w, X.q * state.twists[b].v};
  }
  std::copy(state.axes.begin(), state.axes.end(), target.axes.begin() + to.axes);
  target.time = state.time;
  return target;
}

struct Values {
  Eigen::VectorXd phi, rate, gamma;
  std::vector<Wrench> on;
};
Values values_of(const World& world, const State& state, const std::vector<double>& lambda) {
  const Rows rows(world);
  const auto span = [](Eigen::VectorXd& v) { return std::span<double>(v.data(), v.size()); };
  Values out;
  out.phi = out.rate = out.gamma = Eigen::VectorXd::Zero(rows.row_count());
  std::vector<double> J(rows.jacobian_size(), 99);
  rows.residual(state, span(out.phi));
  rows.jacobian(state, J);
  rows.apply(J, state.twists, span(out.rate));
  rows.add_rate(state, span(out.rate));
  rows.bias(state, state.twists, span(out.gamma));
  out.on.resize(world.body_count());
  rows.apply_transpose(J, lambda, out.on);
  return out;
}

/// Values of rows; those along world axes, three by three, turned by q.
template <typename Values>
void turn_world_rows(const Rows& rows, const Quat& q, Values& values) {
  for (int i = 0; i < rows.row_count(); ++i) {
    if (!rows.row_name(i).ends_with("world x")) continue;
    Eigen::Map<Vec3> triple(&values[i]);
    triple = q * Vec3(triple);
  }
}

/// A world that holds something already, the part appended to it, and both appended to another one.
struct Merged {
  explicit Merged(const World& own) {
    World middle = part();
    const Relocation first = middle.append(own, "one/", inner);
    world.add_body({.name = "stone"});
    to = world.append(middle, "two/", outer).after(first);
    world.set_gravity(X().q * own.gravity());
    world.set_time(own.time());
  }
  Pose X() const { return {(outer.q * inner.q).normalized(), outer.point(inner.p)}; }
  Pose inner{exp_so3(Vec3(0.3, -0.5, 1)), Vec3(1, 2, 3)}, outer{exp_so3(Vec3(-1, 0.2, 0.4)), Vec3(-2, 1, 4)};
  World world;
  Relocation to;
};

/// 1e-12: some round-offs of numbers up to 100.
constexpr double kRoundOff = 1e-12;

TEST(Append, RowsAreThoseOfThePart) {
  const World own = part();
  const Merged merged(own);
  Random random(8);
  const Rows rows(own), all(merged.world);
  const int first = all.joints()[merged.to(JointId{0}).index].first_row, count = rows.row_count();
  ASSERT_EQ(all.row_count(), 2 * count);  // that of the middle world comes first
  for (int trial = 0; trial < 5; ++trial) {
    State state = own.state();
    for (int b = 1; b < own.body_count(); ++b) {
      if (own.is_fixed(BodyId{b})) continue;
      state.poses[b] = testing::moved(state.poses[b], random.vector(0.1), random.vector(0.1));
      state.twists[b] = random.twist();
    }
    const std::vector<double> lambda = random.multipliers(count);
    std::vector<double> turned = lambda, lambda_all(all.row_count());
    turn_world_rows(rows, merged.X().q, turned);
    std::copy(turned.begin(), turned.end(), lambda_all.begin() + first);
    Values here = values_of(own, state, lambda);
    for (Eigen::VectorXd* each : {&here.phi, &here.rate, &here.gamma})
      turn_world_rows(rows, merged.X().q, *each);
    const Values there =
        values_of(merged.world, moved(merged.world.state(), state, merged.to, merged.X()), lambda_all);
    EXPECT_LT((there.phi.segment(first, count) - here.phi).norm(), kRoundOff * (1 + here.phi.norm()));
    EXPECT_LT((there.rate.segment(first, count) - here.rate).norm(), kRoundOff * (1 + here.rate.norm()));
    EXPECT_LT((there.gamma.segment(first, count) - here.gamma).norm(), kRoundOff * (1 + here.gamma.norm()));
    for (int b = 0; b < own.body_count(); ++b) {
      const Wrench& on = there.on[merged.to.body(b)];
      EXPECT_LT((on.force - merged.X().q * here.on[b].force).norm(), kRoundOff * 10) << b;
      EXPECT_LT((on.torque - merged.X().q * here.on[b].torque).norm(), kRoundOff * 10) << b;
    }
  }
}

TEST(Append, ForcesTurnWithThePart) {
  const World own = part();
  const Merged merged(own);
  std::vector<Wrench> here(own.body_count()), there(merged.world.body_count());
  own.forces(own.state(), here);
  merged.world.forces(merged.world.state(), there);
  for (int b = 0; b < own.body_count(); ++b) {
    const Wrench& on = there[merged.to.body(b)];
    EXPECT_LT((on.force - merged.X().q * here[b].force).norm(), kRoundOff * 10) << b;
    EXPECT_LT((on.torque - merged.X().q * here[b].torque).norm(), kRoundOff * 10) << b;
  }
  // Potential energies may differ by a constant.
  State later = own.state();
  for (Pose& pose : later.poses) pose = testing::moved(pose, Vec3(0.1, 0.2, 0.3), Vec3(0.3, -0.1, 0.2));
  later.poses[0] = {};
  const auto energy_there = [&](const State& state) {
    return merged.world.potential_energy(moved(merged.world.state(), state, merged.to, merged.X()));
  };
  EXPECT_NEAR(energy_there(later) - energy_there(own.state()),
              own.potential_energy(later) - own.potential_energy(own.state()), 1e-10);
}

TEST(Append, PropertiesAreCopied) {
  const World own = part();
  const Merged merged(own);
  const World& world = merged.world;
  const Relocation& to = merged.to;
  for (int j = 0; j < own.joint_count(); ++j) {
    const JointId id{j}, there = to(id);
    EXPECT_EQ(world.name(there), "two/one/" + own.name(id));
    EXPECT_EQ(world.joint(there).type(), own.joint(id).type());
    EXPECT_EQ(world.is_attached(there), own.is_attached(id));
    EXPECT_EQ(world.compliance(there).has_value(), own.compliance(id).has_value());
    EXPECT_EQ(world.joint(there).course().size(), own.joint(id).course().size());
    for (int k = 0; k < own.axis_count(id); ++k) {
      EXPECT_NEAR(world.axis_value({there, k}), own.axis_value({id, k}), kRoundOff * 10);
      EXPECT_NEAR(world.axis_rate({there, k}), own.axis_rate({id, k}), kRoundOff * 10);
    }
  }
  const AxisProperties& angle = world.axis_properties(to(own.axis(own.joint("hinge"), "angle")));
  EXPECT_EQ(angle.limits->upper, 25);
  EXPECT_EQ(angle.spring->rest, 19);
  EXPECT_EQ(world.axis_properties(to(own.axis(own.joint("ball"), "turn_y"))).friction->per_load, 0.25);
  EXPECT_EQ(world.compliance(to(own.joint("slider")))->translation_damping, 5);
  ASSERT_EQ(world.breakable().size(), 2U);
  EXPECT_EQ(world.breakable()[1].first, to(own.joint("ball")));
  EXPECT_EQ(world.breakable()[1].second.torque, 200);
  for (int s = 0; s < own.shape_count(); ++s)
    for (int r = 0; r < own.shape_count(); ++r) {
      EXPECT_EQ(world.contact_material(to(ShapeId{s}), to(ShapeId{r})),
                own.contact_material(ShapeId{s}, ShapeId{r}));
      EXPECT_EQ(world.may_collide(to(ShapeId{s}), to(ShapeId{r})), own.may_collide(ShapeId{s}, ShapeId{r}));
    }
  for (int a = 0; a < own.body_count(); ++a)
    for (int b = 0; b < own.body_count(); ++b)
      EXPECT_EQ(world.may_collide(to(BodyId{a}), to(BodyId{b})), own.may_collide(BodyId{a}, BodyId{b}));
  EXPECT_TRUE(world.is_fixed(to.ground));
}

TEST(Append, WithoutAPlacementTheGroundIsTheGround) {
  const World own = part();
  World world;
  const Relocation to = world.append(own);
  EXPECT_EQ(to.ground, kGround);
  EXPECT_EQ(world.body_count(), own.body_count());
  for (int b = 0; b < own.body_count(); ++b) EXPECT_EQ(world.pose(BodyId{b}).p, own.pose(BodyId{b}).p);
  world.append(world, "again/", Pose{Quat::Identity(), Vec3::UnitX()});
  EXPECT_EQ(world.body_count(), 2 * own.body_count());
  EXPECT_EQ(world.joint_count(), 2 * own.joint_count());
}

TEST(Append, RefusesTakenNamesAndBadPlacementsAndChangesNothing) {
  World world = part();
  const int bodies = world.body_count(), joints = world.joint_count();
  World stone, joint_taken;
  stone.add_body({.name = "c"});
  expect_invalid([&] { world.append(stone); }, {"body", "taken", "c"});
  joint_taken.add("rope", Ball(kGround, joint_taken.add_body({.name = "new"}), Vec3::Zero(), Vec3::Zero()));
  expect_invalid([&] { world.append(joint_taken); }, {"joint", "taken", "rope"});
  expect_invalid(
      [&] {
        world.append(stone, "", Pose{Quat::Identity(), Vec3::UnitX()});
      },
      {"taken", "ground"});
  expect_invalid(
      [&] {
        world.append(stone, "s/", Pose{Quat(2, 0, 0, 0), Vec3::Zero()});
      },
      {"orientation of s/ground", "2"});
  expect_invalid(
      [&] {
        world.append(stone, "s/", Pose{Quat::Identity(), Vec3(NAN, 0, 0)});
      },
      {"position of s/ground", "nan"});
  EXPECT_EQ(world.body_count(), bodies);
  EXPECT_EQ(world.joint_count(), joints);
}

/// Velocities and accelerations against differences of poses; 1e-6: h² = 1e-8 times third derivatives up
/// to 54.
TEST(PoseMotion, HasItsOwnDerivatives) {
  const PoseMotion motion = pose_motion({harmonic_motion(1, 2, 3), linear_motion(0, 4), {}},
                                        {{Vec3::UnitX(), harmonic_motion(0.2, 1, 2)},
                                         {Vec3(0, 0.6, 0.8), linear_motion(0.5, 1.5)},
                                         {Vec3::UnitZ(), harmonic_motion(0, 0.7, 1, 0.3)}},
                                        exp_so3(Vec3(0.1, 0.2, 0.3)));
  const double h = 1e-4;
  for (double t : {0.0, 0.3, 1.7}) {
    const PosePoint before = motion(t - h), at = motion(t), after = motion(t + h);
    EXPECT_LT((at.velocity.v - (after.pose.p - before.pose.p) / (2 * h)).norm(), 1e-6);
    EXPECT_LT((at.velocity.w - log_so3(after.pose.q * before.pose.q.conjugate()) / (2 * h)).norm(), 1e-6);
    EXPECT_LT((at.acceleration.v - (after.velocity.v - before.velocity.v) / (2 * h)).norm(), 1e-6);
    EXPECT_LT((at.acceleration.w - (after.velocity.w - before.velocity.w) / (2 * h)).norm(), 1e-6);
  }
  expect_invalid([] { pose_motion({}, {{Vec3(0, 0, 2), {}}}); }, {"pose motion axis", "2"});
}

}  // namespace
}  // namespace taut::world_append_test
