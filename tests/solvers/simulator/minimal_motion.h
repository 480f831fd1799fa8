#pragma once

#include <Eigen/Dense>
#include <functional>
#include <utility>
#include <vector>

#include "core/world/world.h"
#include "tests/core/random_state.h"

namespace taut::testing {

using SixNumbers = Eigen::Matrix<double, 6, 1>;

inline Pose turned(const Pose& pose, const Vec3& turn, const Vec3& p_W) {
  const Quat R = exp_so3(turn);
  return {R * pose.q, p_W + R * (pose.p - p_W)};
}
inline Pose shifted(const Pose& pose, const Vec3& d) { return {pose.q, pose.p + d}; }
/// … with a body that turns by x₁₋₃ about its centre p and moves by x₄₋₆.
inline Pose carried_along(const Pose& pose, const Vec3& p, const Eigen::VectorXd& x) {
  return shifted(turned(pose, x.head(3), p), x.segment(3, 3));
}

/// Twist and acceleration of a pose over time, at 0, by differences of fourth order.
struct Derivatives {
  SixNumbers first, second;  // ω v, ω̇ v̇
};
inline Derivatives derivatives(const std::function<Pose(double)>& pose) {
  const Pose now = pose(0);
  const auto from_now = [&](double t) {
    const Pose then = pose(t);
    SixNumbers d;
    d << log_so3(then.q * now.q.conjugate()), then.p - now.p;
    return d;
  };
  const auto of_step = [&](double h) {
    const SixNumbers ahead = from_now(h), back = from_now(-h);
    return Derivatives{(ahead - back) / (2 * h), (ahead + back) / (h * h)};
  };
  constexpr double kDifference = 4e-3;
  const Derivatives coarse = of_step(kDifference), fine = of_step(kDifference / 2);
  return {(4 * fine.first - coarse.first) / 3, (4 * fine.second - coarse.second) / 3};
}

/// A mechanism in minimal coordinates x, all 0 at the start, that know neither rows nor multipliers.  With
/// twists V = P ẋ + ∂/∂t,
///
///   Pᵀ (M V̇ + bias − f) = 0,   V̇ = P ẍ + c,
///
/// where P and c are differences of the poses over x and time; what all joints of a body give it is what
/// Newton and Euler miss there.
struct MinimalMotion {
  using PoseOf = std::function<Pose(const Eigen::VectorXd& x, double time, BodyId body)>;

  World world;
  std::vector<BodyId> bodies;
  PoseOf pose;
  Eigen::VectorXd rates;

  BodyId add_body(BodySpec body) {
    bodies.push_back(world.add_body(std::move(body)));
    return bodies.back();
  }
  /// Random rates, and the twists of the bodies with them.
  void start_moving(int coordinates, Random& random, PoseOf pose_of) {
    pose = std::move(pose_of);
    rates.resize(coordinates);
    for (double& rate : rates) rate = random.uniform(-1, 1);
    for (BodyId body : bodies) {
      const SixNumbers V = along(rates, 1, body).first;
      world.set_twist(body, {V.head(3), V.tail(3)});
    }
  }
  /// The wrench that the joints give to a body, about its centre.
  SixNumbers missing_wrench(BodyId of) const {
    const auto coordinates = rates.size();
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(coordinates, coordinates), P_of;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(coordinates);
    SixNumbers c_of;
    for (BodyId body : bodies) {
      Eigen::MatrixXd P(6, coordinates), MP(6, coordinates);
      const SixNumbers at_rest = missing(body, SixNumbers::Zero());
      for (int k = 0; k < coordinates; ++k) {
        P.col(k) = along(Eigen::VectorXd::Unit(coordinates, k), 0, body).first;
        MP.col(k) = missing(body, P.col(k)) - at_rest;
      }
      const SixNumbers c = along(rates, 1, body).second;
      A += P.transpose() * MP;
      right -= P.transpose() * missing(body, c);
      if (body == of) P_of = P, c_of = c;
    }
    return missing(of, P_of * A.ldlt().solve(right) + c_of);
  }

 private:
  Derivatives along(const Eigen::VectorXd& x, double time, BodyId body) const {
    return derivatives([&](double t) { return pose(t * x, t * time, body); });
  }
  /// M V̇ + bias − f of a body from its acceleration.
  SixNumbers missing(BodyId body, const SixNumbers& acceleration) const {
    std::vector<Wrench> forces(world.body_count());
    world.forces(world.state(), forces);
    const Mat3 R = world.pose(body).q.toRotationMatrix();
    const MassProperties& mass = world.mass_properties(body);
    const Mat3 inertia = R * mass.inertia_B() * R.transpose();
    const Vec3 w = world.twist(body).w;
    SixNumbers out;
    out << inertia * acceleration.head(3) + w.cross(inertia * w) - forces[body.index].torque,
        mass.mass() * acceleration.tail(3) - forces[body.index].force;
    return out;
  }
};

}  // namespace taut::testing
