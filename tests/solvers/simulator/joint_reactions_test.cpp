#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <numbers>
#include <ostream>

#include "core/joints/joints.h"
#include "solvers/simulator/simulator.h"
#include "tests/core/random_state.h"
#include "tests/solvers/simulator/minimal_motion.h"

// Reactions of every joint type against minimal coordinates that know neither rows nor multipliers: body A
// moves freely, B as the joint allows.  (tests/solvers/simulator/minimal_motion.h)
namespace taut::joint_reactions_test {
namespace {

using testing::carried_along;
using testing::MinimalMotion;
using testing::Random;
using testing::shifted;
using testing::SixNumbers;
using testing::turned;

constexpr double kPi = std::numbers::pi;

/// Poses of B against a resting A over the joint's own coordinates x, all 0 where the joint is made.
struct Allowed {
  std::shared_ptr<const Joint> joint;
  int freedoms;
  std::function<Pose(const Eigen::VectorXd& x)> pose_B;
};
struct ReactionCase {
  const char* type;
  std::function<Allowed(const World&, BodyId a, BodyId b, Random&)> make;
  friend void PrintTo(const ReactionCase& c, std::ostream* out) { *out << c.type; }
};

template <typename AnyJoint>
std::shared_ptr<const Joint> shared(const AnyJoint& joint) {
  return std::make_shared<const AnyJoint>(joint);
}

/// What most types need: where B starts, a point, an axis and two directions across it.
struct Start {
  Pose B;
  Vec3 p, axis, u, v;
  Start(const World& world, BodyId b, Random& random)
      : B(world.pose(b)), p(random.vector(2)), axis(random.unit()) {
    complete_frame(axis, u, v);
  }
};

const ReactionCase kCases[] = {
    {"ball",
     [](const World& w, BodyId a, BodyId b, Random& r) -> Allowed {
       const Start s(w, b, r);
       return {shared(Ball::at(w, a, b, s.p)), 3, [=](const auto& x) { return turned(s.B, x, s.p); }};
     }},
    {"hinge",
     [](const World& w, BodyId a, BodyId b, Random& r) -> Allowed {
       const Start s(w, b, r);
       return {shared(Hinge::at(w, a, b, s.p, s.axis)), 1,
               [=](const auto& x) { return turned(s.B, x[0] * s.axis, s.p); }};
     }},
    {"slider",
     [](const World& w, BodyId a, BodyId b, Random& r) -> Allowed {
       const Start s(w, b, r);
       return {shared(Slider::at(w, a, b, s.p, s.axis)), 1,
               [=](const auto& x) { return shifted(s.B, x[0] * s.axis); }};
     }},
    {"universal",
     [](const World& w, BodyId a, BodyId b, Random& r) -> Allowed {
       const Start s(w, b, r);
       return {shared(Universal::at(w, a, b, s.p, s.axis, s.u)), 2,
               [=](const auto& x) { return turned(turned(s.B, x[1] * s.u, s.p), x[0] * s.axis, s.p); }};
     }},
    {"fixed",
     [](const World& w, BodyId a, BodyId b, Random& r) -> Allowed {
       const Start s(w, b, r);
       return {shared(Fixed::at(w, a, b, s.p)), 0, [=](const auto&) { return s.B; }};
     }},
    {"distance",
     [](const World& w, BodyId a, BodyId b, Random& r) -> Allowed {
       const Start s(w, b, r);
       const Vec3 q = s.p + r.uniform(1, 3) * s.axis;
       return {shared(Distance::between(w, a, b, s.p, q)), 5, [=](const auto& x) {
                 return turned(turned(s.B, x.head(3), q), x[3] * s.u + x[4] * s.v, s.p);
               }};
     }},
    {"taut_rope",
     [](const World& w, BodyId a, BodyId b, Random& r) -> Allowed {
       const Start s(w, b, r);
       const Vec3 q = s.p + r.uniform(1, 3) * s.axis;
       return {shared(Rope::between(w, a, b, s.p, q)), 5, [=](const auto& x) {
                 return turned(turned(s.B, x.head(3), q), x[3] * s.u + x[4] * s.v, s.p);
               }};
     }},
    {"cylindrical",
     [](const World& w, BodyId a, BodyId b, Random& r) -> Allowed {
       const Start s(w, b, r);
       return {shared(Cylindrical::at(w, a, b, s.p, s.axis)), 2,
               [=](const auto& x) { return shifted(turned(s.B, x[0] * s.axis, s.p), x[1] * s.axis); }};
     }},
    {"planar",
     [](const World& w, BodyId a, BodyId b, Random& r) -> Allowed {
       const Start s(w, b, r);
       return {shared(Planar::at(w, a, b, s.p, s.axis, s.u)), 3, [=](const auto& x) {
                 return shifted(turned(s.B, x[0] * s.axis, s.p), x[1] * s.u + x[2] * s.v);
               }};
     }},
    {"screw",
     [](const World& w, BodyId a, BodyId b, Random& r) -> Allowed {
       const Start s(w, b, r);
       return {shared(Screw::at(w, a, b, s.p, s.axis, -0.7)), 1, [=](const auto& x) {
                 return shifted(turned(s.B, x[0] * s.axis, s.p), -0.7 / (2 * kPi) * x[0] * s.axis);
               }};
     }},
    {"point_on_line",
     [](const World& w, BodyId a, BodyId b, Random& r) -> Allowed {
       const Start s(w, b, r);
       return {shared(PointOnLine::at(w, a, b, s.p, s.axis)), 4,
               [=](const auto& x) { return shifted(turned(s.B, x.head(3), s.p), x[3] * s.axis); }};
     }},
    {"point_on_curve",
     [](const World& w, BodyId a, BodyId b, Random& r) -> Allowed {
       std::vector<Vec3> points;
       std::vector<double> parameters;
       for (int i = 0; i < 8; ++i) {
         parameters.push_back(i);
         points.push_back(Vec3(2 * std::cos(i), 2 * std::sin(i), 0.5 * i) + r.vector(0.1));
       }
       const CubicSpline<3> curve(parameters, points);
       const Pose A = w.pose(a), B = w.pose(b);
       const double at = r.uniform(2.2, 2.8);  // within one piece, whose third derivative is constant
       const Vec3 from = A.point(curve.at(at).value);
       return {shared(PointOnCurve(a, b, curve, B.local(from))), 4, [=](const auto& x) {
                 return shifted(turned(B, x.head(3), from), A.point(curve.at(at + x[3]).value) - from);
               }};
     }},
    {"hinge2",
     [](const World& w, BodyId a, BodyId b, Random& r) -> Allowed {
       const Start s(w, b, r);
       return {shared(Hinge2::at(w, a, b, s.p, s.axis, s.u)), 3, [=](const auto& x) {
                 const Pose spun = turned(s.B, x[2] * s.u, s.p);
                 return shifted(turned(spun, x[1] * s.axis, s.p), x[0] * s.axis);
               }};
     }},
    {"six_dof",  // y and two rotations are free
     [](const World& w, BodyId a, BodyId b, Random& r) -> Allowed {
       const Start s(w, b, r);
       const Quat F = r.rotation();
       const SixDof::Locks locks{{true, false, true}, {false, true, false}};
       return {shared(SixDof::at(w, a, b, s.p, F, locks)), 3, [=](const auto& x) {
                 const Pose about_x = turned(s.B, x[1] * (F * Vec3::UnitX()), s.p);
                 return shifted(turned(about_x, x[0] * (F * Vec3::UnitZ()), s.p), x[2] * (F * Vec3::UnitY()));
               }};
     }},
};

/// A and B in random motion under weight and two springs, and B's joint to A.
struct Pair : MinimalMotion {
  Random random;
  BodyId a, b;
  JointId joint;

  Pair(const ReactionCase& type, unsigned seed) : random(seed) {
    a = add_body({.mass = {1.5, Vec3(0.2, 0.3, 0.35)}, .pose = random.pose()});
    b = add_body({.mass = {2.5, Vec3(0.5, 0.3, 0.4)}, .pose = random.pose()});
    for (BodyId body : {a, b})
      world.add_force(SpringDamper(kGround, body, random.vector(2), random.vector(0.2), 40, 0, 0));
    const Allowed allowed = type.make(world, a, b, random);
    joint = world.add_joint("joint", allowed.joint);
    start_moving(6 + allowed.freedoms, random,
                 [=, A = world.pose(a), on_a = a](const Eigen::VectorXd& x, double, BodyId body) {
                   const Pose start = body == on_a ? A : allowed.pose_B(x.tail(x.size() - 6));
                   return carried_along(start, A.p, x);
                 });
  }
};

class JointReaction : public ::testing::TestWithParam<ReactionCase> {};

/// Points that pull, for joints along a line: from that of B to that of A.
Vec3 pull(const World& world, const Joint& joint) {
  const std::vector<WirePoint> ends = joint.course();
  const auto at = [&](const WirePoint& p) { return world.pose(p.body).point(p.p_BP); };
  return at(ends.front()) - at(ends.back());
}

TEST_P(JointReaction, IsWhatNewtonAndEulerMiss) {
  int checked = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Pair pair(GetParam(), seed);
    const SixNumbers expected = pair.missing_wrench(pair.b);
    const Joint& joint = pair.world.joint(pair.joint);
    const Vec3 arm = pair.world.pose(pair.b).q * joint.reaction_point_B();
    const Vec3 force = expected.tail(3), torque = expected.head(3) - arm.cross(force);
    const double size = 1 + force.norm() + torque.norm();
    const bool can_push = joint.type() != "rope";
    if (!can_push && force.dot(pull(pair.world, joint)) < 0) continue;
    ++checked;
    Simulator simulator(pair.world);
    if (can_push) {  // a limit acts from the first step on
      // 1e-7: differences of fourth order with steps of 4e-3 and their round-off.
      const Reaction present = simulator.reaction(pair.joint);
      EXPECT_LT((present.force - force).norm(), 1e-7 * size) << seed;
      EXPECT_LT((present.torque - torque).norm(), 1e-7 * size) << seed;
    }
    // The mean over a short step is the present one but for its change in that time.
    ASSERT_TRUE(simulator.step(1e-5).exact()) << simulator.report().message;
    const Reaction mean = simulator.mean_reaction(pair.joint);
    EXPECT_LT((mean.force - force).norm() + (mean.torque - torque).norm(), 1e-3 * size) << seed;
  }
  EXPECT_GE(checked, 3);
}

INSTANTIATE_TEST_SUITE_P(All, JointReaction, ::testing::ValuesIn(kCases),
                         [](const auto& c) { return std::string(c.param.type); });

}  // namespace
}  // namespace taut::joint_reactions_test
