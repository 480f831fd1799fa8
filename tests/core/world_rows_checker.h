#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <vector>

#include "core/constraints/rows.h"
#include "core/world/world.h"
#include "tests/core/constraints/row_checker.h"
#include "tests/core/random_state.h"

/// Holds all rows of a world, of any number of bodies and with drivers, against what they must be:
///
///   rate       φ̇ = J V + φ_t     against differences of φ along a motion of constant twists
///   bias       φ̈ = γ             against differences of J V + φ_t along the same motion
///   stiffness  K = −∂(Jᵀλ)/∂q    against differences of Jᵀλ, body by body
///   third law  Jᵀλ over all bodies, the ground among them, has no resultant
namespace taut::testing {

/// As kDifferenceTolerance, with leeway for third derivatives of short wires, which grow like 1/length².
inline constexpr double kWorldTolerance = 1e-7;

class WorldRowsChecker {
 public:
  explicit WorldRowsChecker(const World& world) : world_(world), rows_(world) {}

  /// The state at time t along constant twists.
  State at(double t, const std::vector<Twist>& twists) const {
    State state = world_.state();
    state.twists = twists;
    state.time += t;
    for (int b = 1; b < world_.body_count(); ++b)
      state.poses[b] = moved(state.poses[b], t * twists[b].w, t * twists[b].v);
    return state;
  }
  Eigen::VectorXd residual(const State& state) const {
    Eigen::VectorXd phi(rows_.row_count());
    rows_.residual(state, {phi.data(), phi.data() + phi.size()});
    return phi;
  }
  Eigen::VectorXd rate(const State& state) const {
    std::vector<double> J(rows_.jacobian_size(), 99);  // must be overwritten
    Eigen::VectorXd out(rows_.row_count());
    rows_.jacobian(state, J);
    rows_.apply(J, state.twists, {out.data(), out.data() + out.size()});
    rows_.add_rate(state, {out.data(), out.data() + out.size()});
    return out;
  }
  std::vector<Wrench> wrenches(const State& state, const std::vector<double>& lambda) const {
    std::vector<double> J(rows_.jacobian_size(), 99);
    rows_.jacobian(state, J);
    std::vector<Wrench> out(rows_.body_count());
    rows_.apply_transpose(J, lambda, out);
    return out;
  }

  void check(Random& random, const RowChecks& checks = {}) const {
    for (int trial = 0; trial < 8; ++trial) {
      std::vector<Twist> V(world_.body_count());
      for (int b = 1; b < world_.body_count(); ++b)
        if (!world_.is_fixed(BodyId{b})) V[b] = random.twist();
      const double h = kDifferenceStep;
      const auto now = at(0, V), before = at(-h, V), after = at(h, V);
      EXPECT_LT(relative_error(rate(now), Eigen::VectorXd((residual(after) - residual(before)) / (2 * h))),
                kWorldTolerance);
      Eigen::VectorXd bias(rows_.row_count());
      rows_.bias(now, V, {bias.data(), bias.data() + bias.size()});
      EXPECT_LT(relative_error(bias, Eigen::VectorXd((rate(after) - rate(before)) / (2 * h))),
                kWorldTolerance);
    }
    const std::vector<double> lambda = random.multipliers(rows_.row_count());
    if (checks.stiffness) check_stiffness(lambda);
    if (!checks.third_law) return;
    Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
    const auto on = wrenches(world_.state(), lambda);
    for (int b = 0; b < world_.body_count(); ++b) {
      force += on[b].force;
      moment += on[b].torque + world_.pose(BodyId{b}).p.cross(on[b].force);
    }
    EXPECT_LT(force.norm() + moment.norm(), 10 * kRoundOffTolerance);
  }

 private:
  void check_stiffness(const std::vector<double>& lambda) const {
    std::vector<StiffnessBlocks> blocks(rows_.body_count());
    rows_.stiffness(world_.state(), lambda, blocks);
    const double h = kDifferenceStep;
    for (int b = 1; b < world_.body_count(); ++b) {
      const auto wrench = [&](const Vec3& turn, const Vec3& shift) {
        State state = world_.state();
        state.poses[b] = moved(state.poses[b], turn, shift);
        return wrenches(state, lambda)[b];
      };
      Mat3 rotation, translation;
      for (int k = 0; k < 3; ++k) {
        const Vec3 e = h * Vec3::Unit(k), zero = Vec3::Zero();
        rotation.col(k) = (wrench(-e, zero).torque - wrench(e, zero).torque) / (2 * h);
        translation.col(k) = (wrench(zero, -e).force - wrench(zero, e).force) / (2 * h);
      }
      EXPECT_LT(relative_error(blocks[b].rotation, Mat3(0.5 * (rotation + rotation.transpose()))),
                kWorldTolerance);
      EXPECT_LT(relative_error(blocks[b].translation, Mat3(0.5 * (translation + translation.transpose()))),
                kWorldTolerance);
    }
  }

  const World& world_;
  Rows rows_;
};

}  // namespace taut::testing
