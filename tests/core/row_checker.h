#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <limits>
#include <memory>
#include <string_view>
#include <vector>

#include "core/diagnostics.h"
#include "core/rows.h"
#include "core/world.h"
#include "tests/core/random_state.h"

/// Holds the rows of any joint, or of a single row part, against what they must be by definition:
///
///   jacobian   φ̇ = J V           against differences of φ                                (core/README, Eq.
///   2) bias       γ = J̇ V           against differences of J V along the flow of constant V (Eq. 3)
///   stiffness  K = −∂(Jᵀλ)/∂q    against differences of Jᵀλ                              (Eq. 4)
///   third law  Jᵀλ is free of net force, and of net moment about any point
///   invariance a rigid motion of both bodies changes no gap
///
/// One line checks a new joint:  check_rows(joint, A, B, random).
namespace taut::testing {

/// Central differences lose ε²/6 φ''' to truncation and about u |φ| / ε to rounding; both are near 1e-10 at
/// ε = u^(1/3) for quantities of order one.  Third derivatives of the residuals reach some tens in the random
/// states below, hence 1e-8.  It is relative to the size of the compared quantity, at least 1.
inline constexpr double kDifferenceStep = 6e-6;
inline constexpr double kDifferenceTolerance = 1e-8;
/// Sums of a few dozen products of order ten: 1e-13 is expected, 1e-12 allowed.
inline constexpr double kRoundOffTolerance = 1e-12;

/// A joint that consists of one row part.
template <typename Part>
class SinglePart final : public Joint {
 public:
  SinglePart(BodyId a, BodyId b, const Part& part) : Joint(a, b), part_(part) {}
  std::string_view type() const override { return "single part"; }
  void append_rows(RowSink& rows) const override { rows.add(part_); }
  Vec3 reaction_point_B() const override { return Vec3::Zero(); }

 private:
  Part part_;
};

/// A world of two free bodies; joints under test tie body 1 (A) to body 2 (B).
inline World pair_of_bodies(const Pose& A = {}, const Pose& B = {}) {
  World world;
  world.add_body({.name = "A", .pose = A});
  world.add_body({.name = "B", .pose = B});
  return world;
}
inline constexpr BodyId kA{1}, kB{2};

/// The rows of one joint as dense vectors and matrices of the poses of A and B.
class RowChecker {
 public:
  using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, 12>;  // of (ω_A, v_A, ω_B, v_B)

  /// With `axes` all free axes get a row too.
  template <typename AnyJoint>
  explicit RowChecker(const AnyJoint& joint, bool axes = false)
      : world_(pair_of_bodies()), rows_(with(world_, joint, axes)) {}

  int row_count() const { return rows_.row_count(); }
  const Rows& rows() const { return rows_; }

  Eigen::VectorXd residual(const Pose& A, const Pose& B) const {
    Eigen::VectorXd phi(row_count());
    rows_.residual(std::vector<Pose>{{}, A, B}, {phi.data(), phi.data() + phi.size()});
    return phi;
  }
  Jacobian jacobian(const Pose& A, const Pose& B) const {
    std::vector<double> values = jacobian_values(A, B);
    Jacobian J(row_count(), 12);
    for (int s : {0, 1})
      J.middleCols<6>(6 * s) = Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>>(
          values.data() + rows_.sides()[s].offset, row_count(), 6);
    return J;
  }
  Eigen::VectorXd bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B) const {
    Eigen::VectorXd gamma(row_count());
    rows_.bias(std::vector<Pose>{{}, A, B}, std::vector<Twist>{{}, V_A, V_B},
               {gamma.data(), gamma.data() + gamma.size()});
    return gamma;
  }
  /// Blocks of A (1) and B (2).
  std::vector<StiffnessBlocks> stiffness(const Pose& A, const Pose& B,
                                         const std::vector<double>& lambda) const {
    std::vector<StiffnessBlocks> blocks(3);
    rows_.stiffness(std::vector<Pose>{{}, A, B}, lambda, blocks);
    return blocks;
  }
  /// Jᵀλ: wrenches on the ground (0), A (1) and B (2).
  std::vector<Wrench> wrenches(const Pose& A, const Pose& B, const std::vector<double>& lambda) const {
    std::vector<Wrench> out(3);
    rows_.apply_transpose(jacobian_values(A, B), lambda, out);
    return out;
  }
  Gap gap(const Pose& A, const Pose& B) const {
    const Eigen::VectorXd phi = residual(A, B);
    return joint_gaps(rows_, {phi.data(), phi.data() + phi.size()}).front();
  }

  // Largest errors, relative to the size of what is compared (at least 1).
  double jacobian_error(const Pose& A, const Pose& B) const;
  double bias_error(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B) const;
  double stiffness_error(const Pose& A, const Pose& B, const std::vector<double>& lambda) const;
  double third_law_error(const Pose& A, const Pose& B, const std::vector<double>& lambda) const;
  double invariance_error(const Pose& A, const Pose& B, const Quat& R, const Vec3& t) const;

 private:
  template <typename AnyJoint>
  static const World& with(World& world, const AnyJoint& joint, bool axes) {
    const JointId id = world.add("joint", joint);
    for (int k = 0; axes && k < world.axis_count(id); ++k) world.set_limits({id, k}, AxisLimits{});
    return world;
  }
  std::vector<double> jacobian_values(const Pose& A, const Pose& B) const {
    std::vector<double> values(rows_.jacobian_size());
    rows_.jacobian(std::vector<Pose>{{}, A, B}, values);
    return values;
  }

  World world_;
  Rows rows_;
};

inline Eigen::Matrix<double, 12, 1> stacked(const Twist& V_A, const Twist& V_B) {
  return (Eigen::Matrix<double, 12, 1>() << V_A.w, V_A.v, V_B.w, V_B.v).finished();
}

template <typename Analytic, typename Numeric>
double relative_error(const Analytic& analytic, const Numeric& numeric) {
  if (!analytic.allFinite() || !numeric.allFinite()) return std::numeric_limits<double>::infinity();
  return (analytic - numeric).cwiseAbs().maxCoeff() / std::max(1.0, numeric.cwiseAbs().maxCoeff());
}

inline double RowChecker::jacobian_error(const Pose& A, const Pose& B) const {
  if (row_count() == 0) return 0;
  const double h = kDifferenceStep;
  Jacobian numeric(row_count(), 12);
  for (int k = 0; k < 12; ++k) {
    const Vec3 e = h * Vec3::Unit(k % 3), zero = Vec3::Zero();
    const Vec3 turn = k % 6 < 3 ? e : zero, shift = k % 6 < 3 ? zero : e;
    const auto phi = [&](double sign) {
      return k < 6 ? residual(moved(A, sign * turn, sign * shift), B)
                   : residual(A, moved(B, sign * turn, sign * shift));
    };
    numeric.col(k) = (phi(1) - phi(-1)) / (2 * h);
  }
  return relative_error(jacobian(A, B), numeric);
}

inline double RowChecker::bias_error(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B) const {
  if (row_count() == 0) return 0;
  const double h = kDifferenceStep;
  const auto JV = [&](double t) -> Eigen::VectorXd {
    return jacobian(moved(A, t * V_A.w, t * V_A.v), moved(B, t * V_B.w, t * V_B.v)) * stacked(V_A, V_B);
  };
  return relative_error(bias(A, B, V_A, V_B), Eigen::VectorXd((JV(h) - JV(-h)) / (2 * h)));
}

inline double RowChecker::stiffness_error(const Pose& A, const Pose& B,
                                          const std::vector<double>& lambda) const {
  const double h = kDifferenceStep;
  const std::vector<StiffnessBlocks> analytic = stiffness(A, B, lambda);
  double worst = 0;
  for (int body : {1, 2}) {
    // The wrench on `body` after that body alone has moved.
    const auto wrench = [&](const Vec3& turn, const Vec3& shift) {
      return body == 1 ? wrenches(moved(A, turn, shift), B, lambda)[1]
                       : wrenches(A, moved(B, turn, shift), lambda)[2];
    };
    Mat3 rotation, translation;
    for (int k = 0; k < 3; ++k) {
      const Vec3 e = h * Vec3::Unit(k), zero = Vec3::Zero();
      rotation.col(k) = (wrench(-e, zero).torque - wrench(e, zero).torque) / (2 * h);
      translation.col(k) = (wrench(zero, -e).force - wrench(zero, e).force) / (2 * h);
    }
    worst = std::max(
        {worst, relative_error(analytic[body].rotation, Mat3(0.5 * (rotation + rotation.transpose()))),
         relative_error(analytic[body].translation, Mat3(0.5 * (translation + translation.transpose())))});
  }
  return worst;
}

inline double RowChecker::third_law_error(const Pose& A, const Pose& B,
                                          const std::vector<double>& lambda) const {
  const std::vector<Wrench> f = wrenches(A, B, lambda);
  const Vec3 moment = f[1].torque + A.p.cross(f[1].force) + f[2].torque + B.p.cross(f[2].force);
  const double scale = std::max({1.0, f[1].torque.norm(), f[2].torque.norm(), f[1].force.norm()});
  return std::max((f[1].force + f[2].force).norm(), moment.norm()) / scale;
}

inline double RowChecker::invariance_error(const Pose& A, const Pose& B, const Quat& R, const Vec3& t) const {
  const Gap before = gap(A, B), after = gap(transformed(R, t, A), transformed(R, t, B));
  return std::max(std::abs(after.metres - before.metres) / std::max(1.0, before.metres),
                  std::abs(after.radians - before.radians));
}

/// What is left out where a part's documentation says that it does not hold.
struct RowChecks {
  bool stiffness = true;  ///< no: Orientation away from φ = 0
  bool third_law = true;  ///< no: Point away from φ = 0, whose forces act at two places
};

template <typename AnyJoint>
void check_rows(const AnyJoint& joint, const Pose& A, const Pose& B, Random& random,
                const RowChecks& checks = {}) {
  const RowChecker rows(joint);
  const std::vector<double> lambda = random.multipliers(rows.row_count());
  const Twist V_A = random.twist(), V_B = random.twist();
  const Quat R = random.rotation();
  EXPECT_LT(rows.jacobian_error(A, B), kDifferenceTolerance);
  EXPECT_LT(rows.bias_error(A, B, V_A, V_B), kDifferenceTolerance);
  EXPECT_LT(checks.stiffness ? rows.stiffness_error(A, B, lambda) : 0, kDifferenceTolerance);
  EXPECT_LT(checks.third_law ? rows.third_law_error(A, B, lambda) : 0, kRoundOffTolerance);
  EXPECT_LT(rows.invariance_error(A, B, R, random.vector(2)), kRoundOffTolerance);
  // q and −q are one orientation.
  const Pose A2{Quat(-A.q.w(), -A.q.x(), -A.q.y(), -A.q.z()), A.p};
  EXPECT_EQ(rows.residual(A2, B), rows.residual(A, B));
  EXPECT_EQ(rows.jacobian(A2, B), rows.jacobian(A, B));
  EXPECT_EQ(rows.bias(A2, B, V_A, V_B), rows.bias(A, B, V_A, V_B));
}

}  // namespace taut::testing
