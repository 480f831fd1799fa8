#include "solvers/active_set.h"

#include <gtest/gtest.h>

#include "tests/solvers/law_problems.h"

namespace taut {
namespace {

using namespace law_problems;

struct Solver {
  explicit Solver(const World& world) : system(world, FactorChoice::kAuto), active_set(system) {
    system.linearize(world.state().poses);
    system.set_mass(world.state().poses);
    system.factorize(times);
  }
  ActiveSetOutcome solve(const std::vector<RowLaw>& laws, const VectorXd& b,
                         const ActiveSetSettings& settings = {}) {
    if (lambda.size() == 0) lambda = VectorXd::Zero(b.size());
    w.resize(b.size());
    return active_set.solve(laws, {b.data(), laws.size()}, {lambda.data(), laws.size()},
                            {w.data(), laws.size()}, times, settings);
  }
  StageTimes times;
  ConstraintSystem system;
  ActiveSet active_set;
  VectorXd lambda, w;
};

VectorXd random_rates(int n, std::mt19937& random) {
  VectorXd b(n);
  for (double& v : b) v = uniform(random, -1, 1);
  return b;
}

/// Small problems with up to six bounded rows against every combination of pieces.
class ActiveSetSmall : public testing::TestWithParam<std::tuple<double, bool, bool>> {};

TEST_P(ActiveSetSmall, AgreesWithTheEnumerationOfAllPieces) {
  const auto [repeated, slopes, update] = GetParam();
  std::mt19937 random(7);
  ActiveSetSettings settings;
  settings.update_factor = update;
  int solved = 0, contradictions = 0, fallbacks = 0, pivots = 0, least_index = 0;
  for (int problem = 0; problem < 400; ++problem) {
    const World world = random_world(integer(random, 1, 4), integer(random, 2, 8), repeated, random);
    Solver solver(world);
    const int n = solver.system.row_count();
    const MatrixXd S = dense_system(world);
    // In the range of J, as the rates of bodies are: redundant equalities agree.
    const VectorXd b = S * random_rates(n, random);
    std::vector<RowLaw> laws(n, RowLaw::equality());
    for (int k = integer(random, 0, 5); k >= 0; --k)
      laws[integer(random, 0, n - 1)] = random_law(random, slopes);
    const Solution expected = enumerate_pieces(S, b, laws);
    const ActiveSetOutcome outcome = solver.solve(laws, b, settings);
    fallbacks += outcome.fallbacks;
    pivots += outcome.pivots;
    least_index += outcome.least_index_rounds;
    if (!expected.found) {
      ++contradictions;
      EXPECT_EQ(outcome.status, ActiveSetStatus::kContradiction)
          << problem << " " << to_string(outcome.status);
      continue;
    }
    ++solved;
    ASSERT_TRUE(outcome.ok()) << problem << " " << to_string(outcome.status) << " residual "
                              << outcome.residual;
    const double scale = std::max(1.0, expected.lambda.cwiseAbs().maxCoeff());
    EXPECT_LT((solver.w - expected.w).cwiseAbs().maxCoeff(), 1e-8 * scale) << problem;
    EXPECT_LT((S * (solver.lambda - expected.lambda)).cwiseAbs().maxCoeff(), 1e-8 * scale) << problem;
  }
  EXPECT_GT(solved, 250);
  std::printf("solved %d contradictions %d fallbacks %d pivots %d least-index %d\n", solved, contradictions,
              fallbacks, pivots, least_index);
}

INSTANTIATE_TEST_SUITE_P(All, ActiveSetSmall,
                         testing::Combine(testing::Values(0.0, 0.4), testing::Bool(), testing::Bool()));

}  // namespace
}  // namespace taut
