#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <numbers>
#include <ostream>

#include "core/joints.h"
#include "solvers/simulator.h"
#include "tests/core/random_state.h"

// Reactions of every joint type against minimal coordinates that know neither rows nor multipliers: body A
// moves freely, B as the joint allows.  With twists V = P ẋ,
//
//   Pᵀ (M V̇ + bias − f) = 0,   V̇ = P ẍ + c,
//
// where P and c are differences of the poses over x; the reaction is what Newton and Euler miss on B.
namespace taut {
namespace {

using testing::Random;

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

Pose turned(const Pose& pose, const Vec3& turn, const Vec3& p_W) {
  const Quat R = exp_so3(turn);
  return {R * pose.q, p_W + R * (pose.p - p_W)};
}
Pose shifted(const Pose& pose, const Vec3& d) { return {pose.q, pose.p + d}; }

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

/// Twist and acceleration of a pose over time, at 0, by differences of fourth order.
struct Derivatives {
  Eigen::Matrix<double, 6, 1> first, second;  // ω v, ω̇ v̇
};
Derivatives derivatives(const std::function<Pose(double)>& pose) {
  const Pose now = pose(0);
  const auto from_now = [&](double t) {
    const Pose then = pose(t);
    Eigen::Matrix<double, 6, 1> d;
    d << log_so3(then.q * now.q.conjugate()), then.p - now.p;
    return d;
  };
  const auto of_step = [&](double h) {
    const Eigen::Matrix<double, 6, 1> ahead = from_now(h), back = from_now(-h);
    return Derivatives{(ahead - back) / (2 * h), (ahead + back) / (h * h)};
  };
  constexpr double kStep = 4e-3;
  const Derivatives coarse = of_step(kStep), fine = of_step(kStep / 2);
  return {(4 * fine.first - coarse.first) / 3, (4 * fine.second - coarse.second) / 3};
}

/// A and B in random motion under weight and two springs, and B's joint to A.
struct Pair {
  Random random;
  World world;
  BodyId a, b;
  JointId joint;
  int coordinates;
  std::function<Pose(const Eigen::VectorXd& x, BodyId body)> pose;
  Eigen::VectorXd rates;

  Pair(const ReactionCase& type, unsigned seed) : random(seed) {
    a = world.add_body({.mass = {1.5, Vec3(0.2, 0.3, 0.35)}, .pose = random.pose()});
    b = world.add_body({.mass = {2.5, Vec3(0.5, 0.3, 0.4)}, .pose = random.pose()});
    for (BodyId body : {a, b})
      world.add_force(SpringDamper(kGround, body, random.vector(2), random.vector(0.2), 40, 0, 0));
    const Allowed allowed = type.make(world, a, b, random);
    joint = world.add_joint("joint", allowed.joint);
    coordinates = 6 + allowed.freedoms;
    pose = [=, A = world.pose(a), on_a = a](const Eigen::VectorXd& x, BodyId body) {
      const Pose start = body == on_a ? A : allowed.pose_B(x.tail(x.size() - 6));
      return shifted(turned(start, x.head(3), A.p), x.segment(3, 3));
    };
    rates.resize(coordinates);
    for (double& rate : rates) rate = random.uniform(-1, 1);
    for (BodyId body : {a, b}) {
      const auto V = along(rates, body).first;
      world.set_twist(body, {V.head(3), V.tail(3)});
    }
  }
  Derivatives along(const Eigen::VectorXd& x, BodyId body) const {
    return derivatives([&](double t) { return pose(t * x, body); });
  }
  /// M V̇ + bias − f of a body from its acceleration.
  Eigen::Matrix<double, 6, 1> missing(BodyId body, const Eigen::Matrix<double, 6, 1>& acceleration) const {
    std::vector<Wrench> forces(world.body_count());
    world.forces(world.state(), forces);
    const Mat3 R = world.pose(body).q.toRotationMatrix();
    const MassProperties& mass = world.mass_properties(body);
    const Mat3 inertia = R * mass.inertia_B() * R.transpose();
    const Vec3 w = world.twist(body).w;
    Eigen::Matrix<double, 6, 1> out;
    out << inertia * acceleration.head(3) + w.cross(inertia * w) - forces[body.index].torque,
        mass.mass() * acceleration.tail(3) - forces[body.index].force;
    return out;
  }
  /// The wrench that the joint gives to B, about B's centre.
  Eigen::Matrix<double, 6, 1> reaction() const {
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(coordinates, coordinates), P_B;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(coordinates);
    Eigen::Matrix<double, 6, 1> c_B;
    for (BodyId body : {a, b}) {
      Eigen::MatrixXd P(6, coordinates), MP(6, coordinates);
      const Eigen::Matrix<double, 6, 1> at_rest = missing(body, Eigen::Matrix<double, 6, 1>::Zero());
      for (int k = 0; k < coordinates; ++k) {
        P.col(k) = along(Eigen::VectorXd::Unit(coordinates, k), body).first;
        MP.col(k) = missing(body, P.col(k)) - at_rest;
      }
      const Eigen::Matrix<double, 6, 1> c = along(rates, body).second;
      A += P.transpose() * MP;
      right -= P.transpose() * missing(body, c);
      if (body == b) P_B = P, c_B = c;
    }
    return missing(b, P_B * A.ldlt().solve(right) + c_B);
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
    const Eigen::Matrix<double, 6, 1> expected = pair.reaction();
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
    ASSERT_TRUE(simulator.step(1e-5).ok()) << simulator.report().message;
    const Reaction mean = simulator.mean_reaction(pair.joint);
    EXPECT_LT((mean.force - force).norm() + (mean.torque - torque).norm(), 1e-3 * size) << seed;
  }
  EXPECT_GE(checked, 3);
}

INSTANTIATE_TEST_SUITE_P(All, JointReaction, ::testing::ValuesIn(kCases),
                         [](const auto& c) { return std::string(c.param.type); });

}  // namespace
}  // namespace taut
