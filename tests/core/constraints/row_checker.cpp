#include "tests/core/constraints/row_checker.h"

namespace taut::testing {

Eigen::Matrix<double, 12, 1> stacked(const Twist& V_A, const Twist& V_B) {
  return (Eigen::Matrix<double, 12, 1>() << V_A.w, V_A.v, V_B.w, V_B.v).finished();
}

Eigen::VectorXd RowChecker::residual(const Pose& A, const Pose& B) const {
  Eigen::VectorXd phi(row_count());
  rows_.residual(std::vector<Pose>{{}, A, B}, {phi.data(), phi.data() + phi.size()});
  return phi;
}

RowChecker::Jacobian RowChecker::jacobian(const Pose& A, const Pose& B) const {
  std::vector<double> values = jacobian_values(A, B);
  Jacobian J(row_count(), 12);
  if (row_count() == 0) return J;  // a joint that leaves everything free
  for (int s : {0, 1})
    J.middleCols<6>(6 * s) = Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>>(
        values.data() + rows_.sides()[s].offset, row_count(), 6);
  return J;
}

Eigen::VectorXd RowChecker::bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B) const {
  Eigen::VectorXd gamma(row_count());
  rows_.bias(std::vector<Pose>{{}, A, B}, std::vector<Twist>{{}, V_A, V_B},
             {gamma.data(), gamma.data() + gamma.size()});
  return gamma;
}

std::vector<StiffnessBlocks> RowChecker::stiffness(const Pose& A, const Pose& B,
                                                   const std::vector<double>& lambda) const {
  std::vector<StiffnessBlocks> blocks(3);
  rows_.stiffness(std::vector<Pose>{{}, A, B}, lambda, blocks);
  return blocks;
}

std::vector<Wrench> RowChecker::wrenches(const Pose& A, const Pose& B,
                                         const std::vector<double>& lambda) const {
  std::vector<Wrench> out(3);
  rows_.apply_transpose(jacobian_values(A, B), lambda, out);
  return out;
}

Gap RowChecker::gap(const Pose& A, const Pose& B) const {
  const Eigen::VectorXd phi = residual(A, B);
  return joint_gaps(rows_, {phi.data(), phi.data() + phi.size()}).front();
}

std::vector<double> RowChecker::jacobian_values(const Pose& A, const Pose& B) const {
  std::vector<double> values(rows_.jacobian_size());
  rows_.jacobian(std::vector<Pose>{{}, A, B}, values);
  return values;
}

double RowChecker::jacobian_error(const Pose& A, const Pose& B) const {
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

double RowChecker::bias_error(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B) const {
  if (row_count() == 0) return 0;
  const double h = kDifferenceStep;
  const auto JV = [&](double t) -> Eigen::VectorXd {
    return jacobian(moved(A, t * V_A.w, t * V_A.v), moved(B, t * V_B.w, t * V_B.v)) * stacked(V_A, V_B);
  };
  return relative_error(bias(A, B, V_A, V_B), Eigen::VectorXd((JV(h) - JV(-h)) / (2 * h)));
}

double RowChecker::stiffness_error(const Pose& A, const Pose& B, const std::vector<double>& lambda) const {
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

double RowChecker::third_law_error(const Pose& A, const Pose& B, const std::vector<double>& lambda) const {
  const std::vector<Wrench> f = wrenches(A, B, lambda);
  const Vec3 moment = f[1].torque + A.p.cross(f[1].force) + f[2].torque + B.p.cross(f[2].force);
  const double scale = std::max({1.0, f[1].torque.norm(), f[2].torque.norm(), f[1].force.norm()});
  return std::max((f[1].force + f[2].force).norm(), moment.norm()) / scale;
}

double RowChecker::invariance_error(const Pose& A, const Pose& B, const Quat& R, const Vec3& t) const {
  const Gap before = gap(A, B), after = gap(transformed(R, t, A), transformed(R, t, B));
  return std::max(std::abs(after.metres - before.metres) / std::max(1.0, before.metres),
                  std::abs(after.radians - before.radians));
}

void check_rows(const RowChecker& rows, const Pose& A, const Pose& B, Random& random,
                const RowChecks& checks) {
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
