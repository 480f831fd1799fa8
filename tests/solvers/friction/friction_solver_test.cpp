#include "solvers/friction/friction_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

// Impulses of frictional contact against closed forms, and against the laws written once more.
namespace taut::friction_solver_test {
namespace {

using Vector = Eigen::VectorXd;

FrictionProblem problem_of(const Eigen::MatrixXd& W, const Vector& q, const Vector& mu, int equalities = 0) {
  FrictionProblem problem{.W = {}, .q = q, .mu = mu, .equalities = equalities};
  problem.W = W.sparseView(0, 0);
  return problem;
}

/// A point of 2 kg on the ground.
FrictionProblem one_contact(const Eigen::Vector3d& q, double mu) {
  return problem_of(0.5 * Eigen::Matrix3d::Identity(), q, Vector::Constant(1, mu));
}

/// How far impulses and rates are from Signorini's and Coulomb's law as they are taught, in r and u = W r +
/// q: no negative ones, not both, within the cone, and against the slip where there is one.
double law_error(const FrictionProblem& problem, const Vector& r) {
  const Vector u = problem.W * r + problem.q;
  double error = 0;
  for (int i = 0; i < problem.equalities; ++i) error = std::max(error, std::abs(u[i]));
  for (int k = 0; k < problem.contacts(); ++k) {
    const int at = problem.equalities + 3 * k;
    const Eigen::Vector2d f = r.segment<2>(at + 1), slip = u.segment<2>(at + 1);
    const double most = problem.mu[k] * std::max(0.0, r[at]);
    error = std::max({error, -r[at], -u[at], std::min(r[at], u[at]), f.norm() - most});
    // μ r_N u_T + |u_T| r_T = 0
    error = std::max(error, (most * slip + slip.norm() * f).norm());
  }
  return error;
}

TEST(Friction, OfOnePointIsThatOfTheLaws) {
  const auto impulses = [](const Eigen::Vector3d& q, double mu) {
    const FrictionResult result = solve_friction(one_contact(q, mu));
    EXPECT_EQ(result.status, FrictionStatus::kSolved);
    return Eigen::Vector3d(result.r);
  };
  EXPECT_LE(impulses({1, 2, 3}, 0.5).norm(), 1e-15);                                     // leaves
  EXPECT_LE((impulses({-1, 0.3, 0}, 0.5) - Eigen::Vector3d(2, -0.6, 0)).norm(), 1e-9);   // sticks
  EXPECT_LE((impulses({-1, 3, 4}, 0.5) - Eigen::Vector3d(2, -0.6, -0.8)).norm(), 1e-9);  // slides
  EXPECT_LE((impulses({-1, 3, 4}, 0) - Eigen::Vector3d(2, 0, 0)).norm(), 1e-9);          // smooth
}

/// Where the tangent is coupled to the normal, as under a rod that leans, the normal impulse follows from the
/// slip:  u_n = 0 = (W_nn − μ W_nt s) r_n + q_n.
TEST(Friction, OfALeaningRodIsThatOfItsSlip) {
  Eigen::Matrix3d W;
  W << 2, 0.9, 0, 0.9, 1.5, 0, 0, 0, 1;
  const double mu = 0.4;
  const FrictionResult result =
      solve_friction(problem_of(W, Eigen::Vector3d(-1, 5, 0), Vector::Constant(1, mu)));
  ASSERT_EQ(result.status, FrictionStatus::kSolved);
  const double normal = 1 / (2 - mu * 0.9);
  EXPECT_LE((result.r - Eigen::Vector3d(normal, -mu * normal, 0)).norm(), 1e-9);
}

/// Random systems of bodies, over- and underdetermined, with equalities and very different masses.
TEST(Friction, OfRandomSystemsMeetsTheLaws) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> part(0, 1);
  int hard = 0;
  for (int world = 0; world < 300; ++world) {
    const int contacts = 1 + world % 12, equalities = world % 4, bodies = 1 + world % 7;
    const int rows = equalities + 3 * contacts;
    Eigen::MatrixXd J(rows, 6 * bodies);
    for (int i = 0; i < rows; ++i)
      for (int j = 0; j < J.cols(); ++j) J(i, j) = normal(random);
    Vector v(J.cols()), root(J.cols()), mu(contacts);
    for (int j = 0; j < J.cols(); ++j) {
      root[j] = std::pow(10, -1.5 * part(random));
      v[j] = normal(random);
    }
    for (double& m : mu) m = world % 5 == 0 ? 0 : 1.2 * part(random);
    const Eigen::MatrixXd A = J * root.asDiagonal();
    // What the bodies do by themselves can be stopped: equalities and normals are then never in
    // contradiction.
    const FrictionProblem problem = problem_of(A * A.transpose(), J * v, mu, equalities);
    const FrictionResult result = solve_friction(problem);
    if (result.status == FrictionStatus::kNoSolution) continue;
    EXPECT_EQ(result.status, FrictionStatus::kSolved) << world << ' ' << result.errors.largest();
    EXPECT_LE(law_error(problem, result.r), 1e-6 * std::max(1.0, result.r.cwiseAbs().maxCoeff())) << world;
    hard += result.rung != FrictionRung::kSweeps;
  }
  EXPECT_LE(hard, 60);
}

/// A box between two walls that both come nearer: no impulse stops them, and d tells by which normals.
TEST(Friction, BetweenWallsThatCloseHasNoSolution) {
  Eigen::MatrixXd J(6, 3);
  J << 1, 0, 0, 0, 1, 0, 0, 0, 1, -1, 0, 0, 0, 1, 0, 0, 0, 1;
  const Vector q = (Vector(6) << -1, 0.1, 0, -1, 0.1, 0).finished();
  const FrictionProblem problem = problem_of(J * J.transpose(), q, Vector::Constant(2, 0.5));
  const FrictionResult result = solve_friction(problem);
  ASSERT_EQ(result.status, FrictionStatus::kNoSolution);
  ASSERT_TRUE(result.certificate.has_value());
  const Vector& d = *result.certificate;
  EXPECT_LE((problem.W * d).norm(), 1e-6 * d.norm());
  EXPECT_LT(d.dot(problem.q), 0);
  EXPECT_GE(std::min(d[0], d[3]), 0);
  // With a compliance there is one.
  const FrictionProblem soft =
      problem_of(J * J.transpose() + 0.1 * Eigen::MatrixXd::Identity(6, 6), q, Vector::Constant(2, 0.5));
  const FrictionResult softened = solve_friction(soft);
  EXPECT_EQ(softened.status, FrictionStatus::kSolved);
  EXPECT_LE(law_error(soft, softened.r), 1e-8);
}

/// Nor is there one beside a body that is a thousand times as fast, and what shows it is found before rungs
/// that take long.
TEST(Friction, BetweenWallsThatCloseHasNoSolutionBesideFastBodies) {
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(9, 6);
  J.topLeftCorner(6, 3) << 1, 0, 0, 0, 1, 0, 0, 0, 1, -1, 0, 0, 0, 1, 0, 0, 0, 1;
  J.bottomRightCorner(3, 3).setIdentity();
  const Vector q = (Vector(9) << -1, 0.1, 0, -1, 0.1, 0, -1e3, 2e3, 0).finished();
  const FrictionResult result = solve_friction(problem_of(J * J.transpose(), q, Vector::Constant(3, 0.5)));
  ASSERT_EQ(result.status, FrictionStatus::kNoSolution);
  EXPECT_NEAR((*result.certificate)[0], 1, 1e-6);
  EXPECT_NEAR((*result.certificate)[3], 1, 1e-6);
  EXPECT_LE(std::abs((*result.certificate)[6]), 1e-9);
  EXPECT_LE(result.factorisations, 200);
}

/// Equalities that exclude each other have no solution either.
TEST(Friction, WithContradictoryEqualitiesHasNoSolution) {
  Eigen::MatrixXd J(5, 3);
  J << 1, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0;
  const Vector q = (Vector(5) << 1, -1, -1, 0, 0).finished();
  EXPECT_EQ(solve_friction(problem_of(J * J.transpose(), q, Vector::Constant(1, 0.5), 2)).status,
            FrictionStatus::kNoSolution);
}

/// What no impulse moves closes however large it is: alone, and beside what can be stopped, in any unit.
TEST(Friction, OfBodiesThatDoNotMoveHasNoSolutionIfTheyClose) {
  const Vector closing = (Vector(3) << -1, 0.3, 0).finished(),
               parting = (Vector(3) << 0.1, 0.3, 0).finished();
  for (const double unit : {1e-12, 1.0, 1e6}) {
    for (const double mu : {0.0, 0.5}) {
      const FrictionProblem fixed =
          problem_of(Eigen::Matrix3d::Zero(), unit * closing, Vector::Constant(1, mu));
      const FrictionResult result = solve_friction(fixed);
      ASSERT_EQ(result.status, FrictionStatus::kNoSolution) << unit << ' ' << mu;
      EXPECT_LT(result.certificate->dot(fixed.q), 0);
      EXPECT_EQ(result.certificate->tail(2).norm(), 0);
    }
    Eigen::MatrixXd W = Eigen::MatrixXd::Zero(6, 6);
    W.topLeftCorner(3, 3) = unit * Eigen::Matrix3d::Identity();
    const Vector q = (Vector(6) << -2, 0.1, 0, closing).finished();
    const FrictionProblem beside = problem_of(W, q, Vector::Constant(2, 0.5));
    const FrictionResult stopped = solve_friction(beside);
    ASSERT_EQ(stopped.status, FrictionStatus::kNoSolution) << unit;
    EXPECT_LE((W * *stopped.certificate).norm(), 1e-6 * unit);
    EXPECT_LT(stopped.certificate->dot(q), 0);
  }
  EXPECT_EQ(solve_friction(problem_of(Eigen::Matrix3d::Zero(), parting, Vector::Constant(1, 0.5))).status,
            FrictionStatus::kSolved);
  // A joint between bodies that do not move cannot be closed either.
  EXPECT_EQ(
      solve_friction(problem_of(Eigen::MatrixXd::Zero(1, 1), Vector::Constant(1, 2), Vector(), 1)).status,
      FrictionStatus::kNoSolution);
}

/// Eliminated, one of three equalities being the sum of the others, contacts have the impulses that they have
/// beside them, and W is that of dense algebra.
TEST(Friction, OfContactsWhoseJointsHoldIsTheSameWithoutThem) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd J(9, 12);
  for (double& value : J.reshaped()) value = normal(random);
  J.row(2) = J.row(0) + J.row(1);
  Vector v(12);
  for (double& value : v) value = normal(random);
  const Eigen::MatrixXd W = J * J.transpose();
  const FrictionProblem beside = problem_of(W, J * v, Vector::Constant(2, 0.4), 3);
  const FrictionProblem alone = beside.without_equalities();
  EXPECT_EQ(alone.equalities, 0);
  ASSERT_EQ(alone.rows(), 6);
  const Eigen::MatrixXd inverse = W.topLeftCorner(3, 3).completeOrthogonalDecomposition().pseudoInverse();
  const Eigen::MatrixXd exact =
      W.bottomRightCorner(6, 6) - W.bottomLeftCorner(6, 3) * inverse * W.topRightCorner(3, 6);
  EXPECT_LE((Eigen::MatrixXd(alone.W) - exact).norm(), 1e-12 * exact.norm());
  const FrictionResult with = solve_friction(beside), without = solve_friction(alone);
  ASSERT_EQ(with.status, FrictionStatus::kSolved);
  ASSERT_EQ(without.status, FrictionStatus::kSolved);
  EXPECT_LE((with.r.tail(6) - without.r).norm(), 1e-7 * without.r.norm());
  // One that asks for nothing, of bodies that do not move, changes nothing.
  Eigen::MatrixXd wider = Eigen::MatrixXd::Zero(10, 10);
  wider.bottomRightCorner(9, 9) = W;
  const Vector q = (Vector(10) << 0, beside.q).finished();
  const FrictionProblem fixed = problem_of(wider, q, beside.mu, 4).without_equalities();
  EXPECT_LE((Eigen::MatrixXd(fixed.W) - exact).norm(), 1e-12 * exact.norm());
}

TEST(Friction, FromItsOwnSolutionCostsNothing) {
  const FrictionProblem problem = one_contact({-1, 3, 4}, 0.5);
  const FrictionResult cold = solve_friction(problem);
  const FrictionResult warm = solve_friction(problem, {}, &cold.r);
  EXPECT_EQ(warm.status, FrictionStatus::kSolved);
  EXPECT_EQ(warm.factorisations, 0);
  EXPECT_EQ(warm.sweeps, 0);
  EXPECT_EQ(warm.rung, FrictionRung::kGuess);
}

/// Residuals do not change with units: mass in tonnes, length in millimetres.
TEST(Friction, IsMeasuredWithoutUnits) {
  Eigen::MatrixXd J(6, 3);
  J << 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.6, 0.8, 0, -0.8, 0.6, 0, 0, 0, 1;
  const Vector q = (Vector(6) << -1, 0.4, 0.2, -0.3, 0.1, 0.7).finished(), mu = Vector::Constant(2, 0.3);
  const Vector r = (Vector(6) << 1, -0.1, 0, 0.5, 0.1, -0.2).finished();
  const FrictionErrors metres = friction_errors(problem_of(J * J.transpose(), q, mu), r);
  const FrictionErrors millimetres = friction_errors(problem_of(1e3 * J * J.transpose(), 1e3 * q, mu), r);
  const FrictionErrors tonnes = friction_errors(problem_of(1e3 * J * J.transpose(), q, mu), 1e-3 * r);
  EXPECT_GT(metres.impulses, 1e-3);
  for (const FrictionErrors& other : {millimetres, tonnes}) {
    EXPECT_NEAR(other.impulses, metres.impulses, 1e-12);
    EXPECT_NEAR(other.rates, metres.rates, 1e-12);
    EXPECT_NEAR(other.map, metres.map, 1e-6);
  }
}

TEST(Friction, RefusesWhatIsNoProblem) {
  FrictionProblem good = one_contact({-1, 0, 0}, 0.5);
  const auto message = [](const FrictionProblem& problem, const Vector* guess = nullptr,
                          double accuracy = 1e-8) {
    try {
      solve_friction(problem, {.accuracy = accuracy}, guess);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const auto with = [&](auto&& change) {
    FrictionProblem problem = good;
    change(problem);
    return message(problem);
  };
  EXPECT_TRUE(with([](auto& p) { p.mu[0] = -1; }).starts_with("mu: "));
  EXPECT_TRUE(with([](auto& p) { p.mu[0] = NAN; }).starts_with("mu: "));
  EXPECT_TRUE(with([](auto& p) { p.q[1] = INFINITY; }).starts_with("q: "));
  EXPECT_TRUE(with([](auto& p) { p.q.resize(2); }).starts_with("q: "));
  EXPECT_TRUE(with([](auto& p) { p.equalities = -3; }).starts_with("equalities: "));
  EXPECT_TRUE(with([](auto& p) { p.equalities = 1; }).starts_with("W: "));
  EXPECT_TRUE(with([](auto& p) { p.W.coeffRef(0, 0) = NAN; }).starts_with("W: "));
  const Vector guess = Vector::Zero(2);
  EXPECT_TRUE(message(good, &guess).starts_with("guess: "));
  EXPECT_TRUE(message(good, nullptr, 0).starts_with("accuracy: "));
  FrictionProblem empty;
  EXPECT_EQ(solve_friction(empty).status, FrictionStatus::kSolved);
}

}  // namespace
}  // namespace taut::friction_solver_test
