#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "core/constraints/rows.h"
#include "core/joints/joints.h"
#include "solvers/laws/row_law.h"
#include "solvers/system/constraint_system.h"

/// Problems λ ∈ L(w) − c w, w = S λ + b for the tests of their solvers, and a solver that knows nothing of
/// pivoting.
namespace taut::law_problems {

using Eigen::MatrixXd;
using Eigen::VectorXd;

inline double uniform(std::mt19937& random, double lo, double hi) {
  return std::uniform_real_distribution<double>(lo, hi)(random);
}
inline int integer(std::mt19937& random, int lo, int hi) {
  return std::uniform_int_distribution<int>(lo, hi)(random);
}
inline Vec3 random_vector(std::mt19937& random) {
  return {uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)};
}

/// Bodies of 0.1 to 10 kg, joined by rods with one row each and some ball joints with three; a part
/// `repeated` of the joints are copies of others, so that their rows are dependent.
inline World random_world(int bodies, int joints, double repeated, std::mt19937& random) {
  World world;
  for (int b = 0; b < bodies; ++b) {
    BodySpec spec;
    const double size = uniform(random, 0.2, 1);
    spec.mass = MassProperties::box(Vec3(size, 0.7 * size, 1.3 * size), std::pow(10, uniform(random, -1, 1)));
    spec.pose.p = 2 * random_vector(random);
    const double w = uniform(random, -1, 1), z = uniform(random, -1, 1), y = uniform(random, -1, 1),
                 x = uniform(random, 0.1, 1);
    spec.pose.q = Quat(Eigen::Vector4d(x, y, z, w)).normalized();
    world.add_body(spec);
  }
  struct Made {
    int a, b;
    Vec3 p, q;
    bool ball;
  };
  std::vector<Made> made;
  while (static_cast<int>(made.size()) < joints) {
    Made next;
    if (!made.empty() && uniform(random, 0, 1) < repeated) {
      next = made[integer(random, 0, static_cast<int>(made.size()) - 1)];
    } else {
      next = {integer(random, 0, bodies), integer(random, 1, bodies), random_vector(random),
              random_vector(random), uniform(random, 0, 1) < 0.15};
      if (next.a == next.b) continue;
    }
    made.push_back(next);
    if (next.ball)
      world.add("", Ball(BodyId{next.a}, BodyId{next.b}, next.p, next.q));
    else
      world.add("", Distance(BodyId{next.a}, BodyId{next.b}, next.p, next.q, 1));
  }
  return world;
}

/// The joints as a linear system at the world's state; not factored.
inline ConstraintSystem system_of(const World& world) {
  ConstraintSystem system(world, FactorChoice::kAuto);
  system.linearize(world.state().poses);
  system.set_mass(world.state().poses);
  return system;
}

/// J M⁻¹ Jᵀ, dense, from the world's own masses.
inline MatrixXd dense_system(const World& world) {
  const Rows rows(world);
  std::vector<double> values(rows.jacobian_size()), column(rows.row_count());
  rows.jacobian(world.state().poses, values);
  MatrixXd J(rows.row_count(), 6 * rows.body_count()), inverse_mass = MatrixXd::Zero(J.cols(), J.cols());
  std::vector<Twist> twists(rows.body_count(), Twist{Vec3::Zero(), Vec3::Zero()});
  for (int b = 0; b < rows.body_count(); ++b)
    for (int k = 0; k < 6; ++k) {
      (k < 3 ? twists[b].w[k % 3] : twists[b].v[k % 3]) = 1;
      rows.apply(values, twists, column);
      J.col(6 * b + k) = Eigen::Map<VectorXd>(column.data(), J.rows());
      twists[b] = {Vec3::Zero(), Vec3::Zero()};
    }
  for (int b = 0; b < rows.body_count(); ++b) {
    if (world.is_fixed(BodyId{b})) continue;
    const Mat3 R = world.pose(BodyId{b}).q.toRotationMatrix();
    const MassProperties& mass = world.mass_properties(BodyId{b});
    inverse_mass.block<3, 3>(6 * b, 6 * b) = R * mass.inertia_B().inverse() * R.transpose();
    inverse_mass.block<3, 3>(6 * b + 3, 6 * b + 3) = Mat3::Identity() / mass.mass();
  }
  return J * inverse_mass * J.transpose();
}

/// A law of any kind that a joint axis or contact can have, in units where λ and w are about 1.
inline RowLaw random_law(std::mt19937& random, bool slopes) {
  const auto rate = [&] { return integer(random, 0, 2) == 0 ? 0.0 : uniform(random, -0.5, 0.5); };
  const double w = rate(), force = uniform(random, 0.02, 1);
  RowLaw law;
  switch (integer(random, 0, 6)) {
    case 0:
      law = RowLaw::lower_limit(w);
      break;
    case 1:
      law = RowLaw::upper_limit(w);
      break;
    case 2:
      law = RowLaw::box(-force, force, 0);
      break;
    case 3:
      law = RowLaw::box(-force, 0.3 * force, w);
      break;
    case 4:
      law = RowLaw::lower_limit(w - 0.2) + RowLaw::upper_limit(w + 0.3);
      break;
    case 5:
      law = RowLaw::box(-force, force, 0) + RowLaw::box(-0.5, 0.5, w);
      break;
    default:
      law = RowLaw::lower_limit(w - 0.5) + RowLaw::box(-force, force, w);
      break;
  }
  if (slopes && integer(random, 0, 2) == 0) law = law + RowLaw::viscous(std::pow(10, uniform(random, -3, 2)));
  return law;
}

/// How far λ is from L(w) − c w if w may be off by `slack`: read off the steps, one by one.
inline double violation(const RowLaw& law, double lambda, double w, double slack) {
  double low = law.level[0], high = law.level[0];
  for (int k = 0; k < law.steps; ++k) {
    if (w + slack >= law.at[k]) low = law.level[k + 1];
    if (w - slack > law.at[k]) high = law.level[k + 1];
  }
  const double value = lambda + law.slope * w;
  return std::max({0.0, low - value, value - high});
}

struct Solution {
  bool found = false;
  VectorXd lambda, w;
  double softest = 0;  ///< least eigenvalue above round-off of S of the vertical rows, scaled to S_rr = 1
};

inline double softest_direction(const MatrixXd& S, const std::vector<int>& segment) {
  std::vector<int> free;
  for (std::size_t r = 0; r < segment.size(); ++r)
    if (RowLaw::is_vertical(segment[r])) free.push_back(static_cast<int>(r));
  if (free.empty()) return 1;
  const MatrixXd block = S(free, free);
  const VectorXd scale = block.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd scaled = scale.asDiagonal() * block * scale.asDiagonal();
  const VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<MatrixXd>(scaled, Eigen::EigenvaluesOnly).eigenvalues();
  double softest = 1;
  for (double e : eigenvalues)
    if (e > 1e-14) softest = std::min(softest, e);
  return softest;
}

/// Tries every combination of segments; for up to six bounded rows.
inline Solution enumerate_pieces(const MatrixXd& S, const VectorXd& b, const std::vector<RowLaw>& laws) {
  constexpr double kSlack = 1e-9;
  const int n = static_cast<int>(b.size());
  std::vector<int> segment(n);
  for (int r = 0; r < n; ++r) segment[r] = laws[r].bounded() ? 0 : 1;
  for (;;) {
    bool possible = true;
    for (int r = 0; r < n; ++r) possible = possible && laws[r].exists(segment[r]);
    if (possible) {
      // Unknown are λ of verticals and of levels with a slope: A λ = d.
      MatrixXd A = S;
      VectorXd d(n);
      for (int r = 0; r < n; ++r) {
        if (RowLaw::is_vertical(segment[r])) {
          d[r] = laws[r].rate(segment[r]) - b[r];
        } else {  // λ + c (S λ)_r = l − c b
          A.row(r) *= laws[r].slope;
          A(r, r) += 1;
          d[r] = laws[r].force(segment[r]) - laws[r].slope * b[r];
        }
      }
      const VectorXd lambda = A.completeOrthogonalDecomposition().solve(d);
      const VectorXd w = S * lambda + b;
      bool right = (A * lambda - d).cwiseAbs().maxCoeff() < kSlack;
      for (int r = 0; r < n && right; ++r) {
        const double value = lambda[r] + laws[r].slope * w[r];
        right = RowLaw::is_vertical(segment[r])
                    ? value >= laws[r].low(segment[r]) - kSlack && value <= laws[r].high(segment[r]) + kSlack
                    : w[r] >= laws[r].first(segment[r]) - kSlack && w[r] <= laws[r].last(segment[r]) + kSlack;
      }
      if (right) return {true, lambda, w, softest_direction(S, segment)};
    }
    int r = 0;
    for (; r < n; ++r) {
      if (!laws[r].bounded()) continue;
      if (++segment[r] < laws[r].segments()) break;
      segment[r] = 0;
    }
    if (r == n) return {};
  }
}

/// λ ≥ 0, w = S λ + b ≥ 0, λ·w = 0 by Lemke's complementary pivots on a dense tableau.  For positive
/// semidefinite S it ends on a ray only if there is no solution [CottlePangStone1992, 4.4].
inline Solution lemke(const MatrixXd& S, const VectorXd& b) {
  const int n = static_cast<int>(b.size());
  if (b.minCoeff() >= 0) return {true, VectorXd::Zero(n), b};
  // Columns: w, λ, the artificial variable, right-hand side;  w − S λ − e z = b.
  MatrixXd T(n, 2 * n + 2);
  T << MatrixXd::Identity(n, n), -S, -VectorXd::Ones(n), b;
  std::vector<int> basis(n);
  for (int r = 0; r < n; ++r) basis[r] = r;
  int row = 0, entering = 2 * n;
  b.minCoeff(&row);
  for (int pivots = 0; pivots < 100 * n; ++pivots) {
    const int leaving = basis[row];
    T.row(row) /= T(row, entering);
    for (int r = 0; r < n; ++r)
      if (r != row) T.row(r) -= (T(r, entering) * T.row(row)).eval();
    basis[row] = entering;
    if (leaving == 2 * n) {
      Solution solution{true, VectorXd::Zero(n), {}};
      for (int r = 0; r < n; ++r)
        if (basis[r] >= n) solution.lambda[basis[r] - n] = T(r, 2 * n + 1);
      solution.w = S * solution.lambda + b;
      return solution;
    }
    entering = leaving < n ? leaving + n : leaving - n;
    row = -1;
    double smallest = 0;
    for (int r = 0; r < n; ++r) {
      if (T(r, entering) < 1e-9) continue;
      const double ratio = T(r, 2 * n + 1) / T(r, entering);
      // Ties go to the artificial variable, so that the path may end.
      if (row < 0 || ratio < smallest - 1e-12 || (ratio < smallest + 1e-12 && basis[r] == 2 * n)) {
        smallest = ratio;
        row = r;
      }
    }
    if (row < 0) return {};
  }
  return {};
}

}  // namespace taut::law_problems
