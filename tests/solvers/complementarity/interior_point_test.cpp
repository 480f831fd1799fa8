#include "solvers/complementarity/interior_point.h"

#include <gtest/gtest.h>

#include "scenes/builders/scene.h"
#include "solvers/simulator/simulator.h"
#include "tests/solvers/complementarity/law_problems.h"

namespace taut::interior_point_test {
namespace {

using namespace law_problems;

struct Interior {
  explicit Interior(const World& world) : system(system_of(world)), solver(system) {}
  InteriorOutcome solve(const std::vector<RowLaw>& laws, const VectorXd& b) {
    if (lambda.size() == 0) lambda = VectorXd::Zero(b.size());
    w.resize(b.size());
    return solver.solve(laws, {b.data(), laws.size()}, {lambda.data(), laws.size()}, {w.data(), laws.size()},
                        {}, times);
  }
  StageTimes times;
  ConstraintSystem system;
  InteriorPoint solver;
  VectorXd lambda, w;
};

VectorXd random_rates(int n, std::mt19937& random) {
  VectorXd b(n);
  for (double& v : b) v = uniform(random, -1, 1);
  return b;
}

/// All kinds of laws with up to six bounded rows, also dependent ones, against every combination of segments:
/// w is unique.
TEST(InteriorPoint, AgreesWithTheEnumerationOfAllPieces) {
  std::mt19937 random(77);
  int solved = 0, missed = 0, most = 0;
  for (int problem = 0; problem < 600; ++problem) {
    const int joints = integer(random, 2, 8), bodies = integer(random, 1, 4);
    const World world = random_world(bodies, joints, 0.3, random);
    Interior interior(world);
    const int n = interior.system.row_count();
    const MatrixXd S = dense_system(world);
    const VectorXd b = S * random_rates(n, random);
    std::vector<RowLaw> laws(n, RowLaw::equality());
    for (int k = integer(random, 0, 5); k >= 0; --k)
      laws[integer(random, 0, n - 1)] = random_law(random, true);
    const Solution expected = enumerate_pieces(S, b, laws);
    if (!expected.found || expected.softest < 1e-6) continue;
    const InteriorOutcome outcome = interior.solve(laws, b);
    most = std::max(most, outcome.iterations);
    if (!outcome.converged) {
      ++missed;
      continue;
    }
    ++solved;
    const double size =
        std::max({1.0, expected.lambda.cwiseAbs().maxCoeff(), interior.lambda.cwiseAbs().maxCoeff()});
    // 1e-9 of the size of impulses is its tolerance; a condition of 1e3 is on top of it.
    EXPECT_LT((interior.w - expected.w).cwiseAbs().maxCoeff(), 1e-6 * size) << problem;
    EXPECT_LT((S * interior.lambda + b - interior.w).cwiseAbs().maxCoeff(), 1e-8 * size) << problem;
  }
  RecordProperty("solved", solved);
  RecordProperty("missed", missed);
  RecordProperty("most", most);
  EXPECT_GT(solved, 450);
  EXPECT_LE(missed, 6);
}

/// Friction and motors in ten times as many rows as freedoms: every law by itself, with dense arithmetic.
TEST(InteriorPoint, MeetsTheLawsOfManyDependentRowsInFewIterations) {
  std::mt19937 random(3);
  for (int problem = 0; problem < 20; ++problem) {
    const World world = random_world(6, 250, 0.5, random);
    Interior interior(world);
    const int n = interior.system.row_count();
    const MatrixXd S = dense_system(world);
    const VectorXd b = S * random_rates(n, random) / n;
    std::vector<RowLaw> laws;
    for (int r = 0; r < n; ++r) {
      const double force = std::pow(10, uniform(random, -4, -1));
      laws.push_back(RowLaw::box(-force, force, integer(random, 0, 5) == 0 ? uniform(random, -0.1, 0.1) : 0));
    }
    const InteriorOutcome outcome = interior.solve(laws, b);
    ASSERT_TRUE(outcome.converged) << problem << " " << outcome.residual;
    EXPECT_LE(outcome.iterations, 40) << problem;
    const VectorXd w = S * interior.lambda + b;
    // 1e-9 of the size of impulses, which is below 1 here.
    for (int r = 0; r < n; ++r)
      EXPECT_LT(violation(laws[r], interior.lambda[r], w[r], 1e-7), 1e-7) << problem << " " << r;
  }
}

/// Friction about all axes of every joint welds the loops of a net: thousands of rows stick and depend on
/// each other.  Gravity works against friction alone.
TEST(InteriorPoint, CarriesANetWithFrictionInEveryJoint) {
  for (const double friction : {1e-3, 0.1, 10.0}) {
    Scene scene = build_scene("net-friction", {{"n", 8}, {"friction", friction}});
    Simulator simulator(scene.world);
    for (int step = 0; step < 12; ++step) {
      const StepReport& report = simulator.step(scene.dt);
      ASSERT_TRUE(report.exact()) << friction << " " << report.message;
      EXPECT_LE(report.complementarity_residual, 1e-9) << friction;
      EXPECT_LE(report.gap.metres, 1e-9) << friction;
      EXPECT_LE(report.works.axes.friction, 1e-9) << friction;
    }
  }
}

}  // namespace
}  // namespace taut::interior_point_test
