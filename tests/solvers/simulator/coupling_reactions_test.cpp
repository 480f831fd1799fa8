#include <gtest/gtest.h>

#include <cmath>

#include "core/joints/joints.h"
#include "solvers/simulator/simulator.h"
#include "tests/solvers/simulator/minimal_motion.h"

// Reactions of transmissions and drivers of poses against minimal coordinates.
// (tests/solvers/simulator/minimal_motion.h) A transmission acts on its bodies beside the joints whose axes
// it couples; those give nothing along their free axes, so that what is missing there is its own.
namespace taut::coupling_reactions_test {
namespace {

using testing::carried_along;
using testing::MinimalMotion;
using testing::Random;
using testing::shifted;
using testing::SixNumbers;
using testing::turned;

/// 1e-7 of the forces: differences of fourth order with steps of 4e-3 and their round-off.
constexpr double kExact = 1e-7;

/// A carrier that moves freely, with parts on it, all in random motion under weight and springs.
struct Train : MinimalMotion {
  Random random;
  BodyId carrier;
  struct Part {
    BodyId body;
    Pose start;
    Vec3 p, axis;  // of its hinge or slider
    JointId joint;
    AxisId id() const { return {joint, 0}; }
  };

  explicit Train(unsigned seed) : random(seed), carrier(add()) {}
  BodyId add() {
    const Vec3 inertia(random.uniform(0.3, 0.4), 0.3, random.uniform(0.25, 0.35));
    const BodyId body = add_body({.mass = {random.uniform(1, 3), inertia}, .pose = random.pose()});
    world.add_force(SpringDamper(kGround, body, random.vector(2), random.vector(0.2), 40, 0, 0));
    return body;
  }
  Part turning() {
    const BodyId body = add();
    const Vec3 p = random.vector(), axis = random.unit();
    return {body, world.pose(body), p, axis, world.add("", Hinge::at(world, carrier, body, p, axis))};
  }
  Part sliding() {
    const BodyId body = add();
    const Vec3 p = random.vector(), axis = random.unit();
    return {body, world.pose(body), p, axis, world.add("", Slider::at(world, carrier, body, p, axis))};
  }
  /// What the joints give along the free axis of a turning part.
  double torque_on(const Part& part) const {
    const SixNumbers wrench = missing_wrench(part.body);
    const Vec3 force = wrench.tail(3), arm = world.pose(part.body).p - part.p;
    return part.axis.dot(wrench.head(3) + arm.cross(force));
  }
};

/// Reaction of a joint and what the joints of its body B give together, about its centre.
void expect_wrench(const Wrench& have, const SixNumbers& want) {
  const double size = 1 + want.norm();
  EXPECT_LT((have.torque - want.head(3)).norm(), kExact * size);
  EXPECT_LT((have.force - want.tail(3)).norm(), kExact * size);
}
Wrench about_centre(const World& world, Simulator& simulator, JointId joint, BodyId body) {
  const Reaction r = simulator.reaction(joint);
  const Vec3 arm = world.pose(body).q * world.joint(joint).reaction_point_B();
  return {r.torque + arm.cross(r.force), r.force};
}

TEST(CouplingReaction, OfRackAndPinionIsTheForceOnTheRackAndItsTorqueOnThePinion) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    Train t(seed);
    const Train::Part pinion = t.turning(), rack = t.sliding();
    const double radius = t.random.uniform(0.2, 0.6);
    const JointId mesh = t.world.add("mesh", RackAndPinion(t.world, pinion.id(), rack.id(), radius));
    const Vec3 centre = t.world.pose(t.carrier).p;
    t.start_moving(7, t.random, [=, start = t.world.state()](const auto& x, double, BodyId body) {
      if (body == pinion.body)
        return carried_along(turned(pinion.start, x[6] * pinion.axis, pinion.p), centre, x);
      if (body == rack.body) return carried_along(shifted(rack.start, radius * x[6] * rack.axis), centre, x);
      return carried_along(start.poses[body.index], centre, x);
    });
    Simulator simulator(t.world);
    const SixNumbers on_rack = t.missing_wrench(rack.body);
    const Wrench own = about_centre(t.world, simulator, mesh, rack.body);
    expect_wrench(own + about_centre(t.world, simulator, rack.joint, rack.body), on_rack);
    // λ along the rack, through the point of the slider; −radius λ about the pinion.
    const double lambda = rack.axis.dot(on_rack.tail(3)), size = 1 + on_rack.norm();
    EXPECT_LT((own.force - lambda * rack.axis).norm(), kExact * size);
    const Vec3 arm = rack.p - rack.start.p;
    EXPECT_LT((own.torque - arm.cross(lambda * rack.axis)).norm(), kExact * size);
    EXPECT_NEAR(t.torque_on(pinion), -radius * lambda, kExact * size);
    EXPECT_GT(std::abs(lambda), 1e-3);
  }
}

TEST(CouplingReaction, OfADifferentialIsTheSameTorqueOnBothShaftsAndTwiceThatOnTheCase) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    Train t(seed);
    const Train::Part input = t.turning(), left = t.turning(), right = t.turning();
    const JointId gears = t.world.add("gears", Differential(t.world, input.id(), left.id(), right.id()));
    const Vec3 centre = t.world.pose(t.carrier).p;
    t.start_moving(8, t.random, [=, start = t.world.state()](const auto& x, double, BodyId body) {
      const auto at = [&](const Train::Part& part, double angle) {
        return carried_along(turned(part.start, angle * part.axis, part.p), centre, x);
      };
      if (body == input.body) return at(input, 0.5 * (x[6] + x[7]));
      if (body == left.body) return at(left, x[6]);
      if (body == right.body) return at(right, x[7]);
      return carried_along(start.poses[body.index], centre, x);
    });
    Simulator simulator(t.world);
    const SixNumbers on_right = t.missing_wrench(right.body);
    const Wrench own = about_centre(t.world, simulator, gears, right.body);
    expect_wrench(own + about_centre(t.world, simulator, right.joint, right.body), on_right);
    const double lambda = t.torque_on(right), size = 1 + on_right.norm();
    EXPECT_LT(own.force.norm(), kExact * size);
    EXPECT_LT((own.torque - lambda * right.axis).norm(), kExact * size);
    EXPECT_NEAR(t.torque_on(left), lambda, kExact * size);
    EXPECT_NEAR(t.torque_on(input), -2 * lambda, kExact * size);
    EXPECT_GT(std::abs(lambda), 1e-3);
  }
}

/// B is led along and turned about axes of A, at rates and accelerations that are not 0 at the start.
TEST(CouplingReaction, OfAPoseDriverIsWhatNewtonAndEulerMiss) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    Train t(seed);
    const BodyId a = t.carrier, b = t.add();
    const Pose A = t.world.pose(a), B = t.world.pose(b);
    const Vec3 turn = t.random.vector(), way = t.random.vector(), p = A.local(B.p);
    const Quat q = A.q.conjugate() * B.q;
    // Angle and way over time: s = t + t², s' = 1 + 2t, s'' = 2.
    const JointId lead = t.world.add("lead", PoseDriver(a, b, [=](double time) {
                                       const double s = time + time * time, rate = 1 + 2 * time;
                                       PosePoint x;
                                       x.pose = {exp_so3(s * turn) * q, p + s * way};
                                       x.velocity = {rate * turn, rate * way};
                                       x.acceleration = {2 * turn, 2 * way};
                                       return x;
                                     }));
    t.start_moving(6, t.random, [=](const auto& x, double time, BodyId body) {
      const double s = time + time * time;
      const Pose led{A.q * (exp_so3(s * turn) * q), A.point(p + s * way)};
      return carried_along(body == a ? A : led, A.p, x);
    });
    Simulator simulator(t.world);
    const SixNumbers expected = t.missing_wrench(b);
    expect_wrench(about_centre(t.world, simulator, lead, b), expected);
    // The mean over a short step is the present one but for its change in that time.
    ASSERT_TRUE(simulator.step(1e-5).exact()) << simulator.report().message;
    const Reaction mean = simulator.mean_reaction(lead);
    EXPECT_LT((mean.force - expected.tail(3)).norm() + (mean.torque - expected.head(3)).norm(),
              1e-3 * (1 + expected.norm()));
  }
}

}  // namespace
}  // namespace taut::coupling_reactions_test
