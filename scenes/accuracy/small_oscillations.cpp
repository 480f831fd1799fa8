#include "scenes/accuracy/small_oscillations.h"

#include <cmath>

#include "core/base/check.h"
#include "core/constraints/rows.h"
#include "core/math/dense.h"

namespace taut {
namespace {

/// Dense J with six columns per moving body; `column[body]` is −1 for the others.
dense::Matrix dense_jacobian(const Rows& rows, const State& state, const std::vector<int>& column,
                             int columns) {
  std::vector<double> values(rows.jacobian_size());
  rows.jacobian(state.poses, values);
  dense::Matrix J = dense::Matrix::Zero(rows.row_count(), columns);
  for (const Rows::Side& side : rows.sides())
    if (column[side.body] >= 0)
      J.block(side.first_row, column[side.body], side.row_count, 6) =
          Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>>(
              values.data() + side.offset, side.row_count, 6);
  return J;
}

dense::Vector dense_forces(const World& world, const State& state, const std::vector<int>& column,
                           int columns) {
  std::vector<Wrench> wrenches(world.body_count());
  world.forces(state, wrenches);
  dense::Vector f(columns);
  for (int b = 0; b < world.body_count(); ++b)
    if (column[b] >= 0) f.segment<6>(column[b]) << wrenches[b].torque, wrenches[b].force;
  return f;
}

State moved(const State& state, int body, int coordinate, double by) {
  State out = state;
  const Vec3 step = by * Vec3::Unit(coordinate % 3);
  Pose& pose = out.poses[body];
  if (coordinate < 3)
    pose.q = (exp_so3(step) * pose.q).normalized();
  else
    pose.p += step;
  return out;
}

dense::Matrix dense_mass(const World& world, const std::vector<int>& column, int columns) {
  dense::Matrix M = dense::Matrix::Zero(columns, columns);
  for (int b = 0; b < world.body_count(); ++b) {
    if (column[b] < 0) continue;
    const MassProperties& mass = world.mass_properties(BodyId{b});
    const Mat3 R = world.pose(BodyId{b}).q.toRotationMatrix();
    M.block<3, 3>(column[b], column[b]) = R * mass.inertia_B() * R.transpose();
    M.block<3, 3>(column[b] + 3, column[b] + 3) = mass.mass() * Mat3::Identity();
  }
  return M;
}

Mode mode_of(double omega, const dense::Vector& x, const dense::Vector& Mx, const std::vector<int>& column) {
  Mode mode;
  mode.omega = omega;
  for (int c : column) {
    mode.shape.push_back(c < 0 ? Twist{} : Twist{x.segment<3>(c), x.segment<3>(c + 3)});
    mode.momentum.push_back(c < 0 ? Wrench{} : Wrench{Mx.segment<3>(c), Mx.segment<3>(c + 3)});
  }
  return mode;
}

}  // namespace

std::vector<Mode> natural_modes(const World& world) {
  const Rows rows(world);
  const State& state = world.state();
  std::vector<int> column(world.body_count(), -1), body_of;
  for (int b = 0; b < world.body_count(); ++b)
    if (!world.is_fixed(BodyId{b})) {
      column[b] = 6 * static_cast<int>(body_of.size());
      body_of.push_back(b);
    }
  const int n = 6 * static_cast<int>(body_of.size());

  const dense::Matrix J = dense_jacobian(rows, state, column, n);
  const dense::SingularValues svd = dense::singular_values(J);
  const Eigen::Index rank = (svd.values.array() > 1e-9 * svd.values[0]).count();
  const dense::Matrix Z = svd.V.rightCols(n - rank);
  const dense::Vector f = dense_forces(world, state, column, n);
  const dense::Vector lambda = svd.U.leftCols(rank) * (svd.values.head(rank).cwiseInverse().asDiagonal() *
                                                       (svd.V.leftCols(rank).transpose() * -f));
  const double imbalance = (f + J.transpose() * lambda).norm();
  if (imbalance > 1e-8 * f.norm()) fail("modes", "the world is not in equilibrium", imbalance);

  dense::Matrix K(n, n);
  constexpr double kStep = 1e-5;  // truncation and round-off of the central difference are both near 1e-10
  for (int c = 0; c < n; ++c) {
    const auto load = [&](double by) {
      const State at = moved(state, body_of[c / 6], c % 6, by);
      return dense::Vector(dense_forces(world, at, column, n) +
                           dense_jacobian(rows, at, column, n).transpose() * lambda);
    };
    K.col(c) = (load(-kStep) - load(kStep)) / (2 * kStep);
  }

  const dense::Matrix M = dense_mass(world, column, n);
  const dense::Matrix Kz = Z.transpose() * K * Z;
  const dense::Eigenpairs eigen =
      dense::generalized_eigenpairs(0.5 * (Kz + Kz.transpose()), Z.transpose() * M * Z);
  std::vector<Mode> modes;
  for (Eigen::Index i = 0; i < eigen.values.size(); ++i) {
    const double square = eigen.values[i];
    if (square < 1e-6 * eigen.values.maxCoeff()) continue;  // spins that nothing restores
    const dense::Vector x = Z * eigen.vectors.col(i);
    modes.push_back(mode_of(std::sqrt(square), x, M * x, column));
  }
  return modes;
}

}  // namespace taut
