#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <limits>
#include <memory>
#include <string_view>
#include <vector>

#include "core/constraints/rows.h"
#include "core/world/diagnostics.h"
#include "core/world/world.h"
#include "tests/core/random_state.h"

/// Holds the rows of any joint, or of a single row part, against what they must be by definition:
///
///   jacobian   φ̇ = J V           against differences of φ                      (core/constraints, Eq. 1)
///   bias       γ = J̇ V           against differences of J V along the flow of constant V  (Eq. 2)
///   stiffness  K = −∂(Jᵀλ)/∂q    against differences of Jᵀλ                              (Eq. 3)
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

Eigen::Matrix<double, 12, 1> stacked(const Twist& V_A, const Twist& V_B);

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

  Eigen::VectorXd residual(const Pose& A, const Pose& B) const;
  Jacobian jacobian(const Pose& A, const Pose& B) const;
  Eigen::VectorXd bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B) const;
  /// Blocks of A (1) and B (2).
  std::vector<StiffnessBlocks> stiffness(const Pose& A, const Pose& B,
                                         const std::vector<double>& lambda) const;
  /// Jᵀλ: wrenches on the ground (0), A (1) and B (2).
  std::vector<Wrench> wrenches(const Pose& A, const Pose& B, const std::vector<double>& lambda) const;
  Gap gap(const Pose& A, const Pose& B) const;

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
  std::vector<double> jacobian_values(const Pose& A, const Pose& B) const;

  World world_;
  Rows rows_;
};

template <typename Analytic, typename Numeric>
double relative_error(const Analytic& analytic, const Numeric& numeric) {
  if (!analytic.allFinite() || !numeric.allFinite()) return std::numeric_limits<double>::infinity();
  return (analytic - numeric).cwiseAbs().maxCoeff() / std::max(1.0, numeric.cwiseAbs().maxCoeff());
}

/// What is left out where a part's documentation says that it does not hold.
struct RowChecks {
  bool stiffness = true;  ///< no: Orientation away from φ = 0
  bool third_law = true;  ///< no: Point away from φ = 0, whose forces act at two places
};

void check_rows(const RowChecker& rows, const Pose& A, const Pose& B, Random& random,
                const RowChecks& checks = {});
template <typename AnyJoint>
void check_rows(const AnyJoint& joint, const Pose& A, const Pose& B, Random& random,
                const RowChecks& checks = {}) {
  check_rows(RowChecker(joint), A, B, random, checks);
}

}  // namespace taut::testing
