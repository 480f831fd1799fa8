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

/// Small problems with up to six bounded rows against every combination of pieces: repeated joints, slopes,
/// updates of the factor.
class ActiveSetSmall : public testing::TestWithParam<std::tuple<double, bool, bool>> {};

TEST_P(ActiveSetSmall, AgreesWithTheEnumerationOfAllPieces) {
  const auto [repeated, slopes, update] = GetParam();
  std::mt19937 random(1234);
  ActiveSetSettings settings;
  settings.update_factor = update;
  int solved = 0, contradictions = 0, soft = 0, fallbacks = 0, pivots = 0;
  for (int problem = 0; problem < 1500; ++problem) {
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
    if (getenv("PR") && problem == atoi(getenv("PR"))) setenv("TR","1",1); else unsetenv("TR"); 
 const ActiveSetOutcome outcome = solver.solve(laws, b, settings);
    fallbacks += outcome.descent_rounds > 0;
    pivots += outcome.pivots;
    if (!expected.found) {
      ++contradictions;
      EXPECT_EQ(outcome.status, ActiveSetStatus::kContradiction) << problem;
      continue;
    }
    if (expected.softest < 1e-6) {  // near those that are left alone (kSteppingTolerance): w depends on them
      ++soft;
      continue;
    }
    ++solved;
    ASSERT_TRUE(outcome.ok()) << problem << " " << to_string(outcome.status) << " " << outcome.residual;
    // 1e-9 of the scale is what the residual promises; a condition of 1e3 is on top of it.
    const double size =
        std::max({1.0, expected.lambda.cwiseAbs().maxCoeff(), solver.lambda.cwiseAbs().maxCoeff()});
    EXPECT_LT((solver.w - expected.w).cwiseAbs().maxCoeff(), 1e-8 * size) << problem;
    EXPECT_LT((S * (solver.lambda - expected.lambda)).cwiseAbs().maxCoeff(), 1e-8 * size) << problem;
  }
  EXPECT_GT(solved, 1200);
  EXPECT_GT(contradictions, 20);
  EXPECT_GT(pivots, 1000);
  EXPECT_LT(soft, 8);
  RecordProperty("fallbacks", fallbacks);
  EXPECT_LE(fallbacks, 3);
}

INSTANTIATE_TEST_SUITE_P(All, ActiveSetSmall,
                         testing::Combine(testing::Values(0.0, 0.4), testing::Bool(), testing::Bool()));

/// Limits alone are a linear complementarity problem; up to 40 of them, more than bodies have freedoms.
TEST(ActiveSet, AgreesWithLemkeOnLimits) {
  std::mt19937 random(5);
  int solved = 0, contradictions = 0;
  for (int problem = 0; problem < 300; ++problem) {
    const World world = random_world(integer(random, 2, 8), integer(random, 5, 40), 0.2, random);
    Solver solver(world);
    const int n = solver.system.row_count();
    const MatrixXd S = dense_system(world);
    // Every fifth problem asks for rates that the bodies may be unable to give.
    VectorXd b = S * random_rates(n, random);
    if (problem % 5 == 0) b += 0.1 * random_rates(n, random);
    std::vector<RowLaw> laws;
    VectorXd sign(n), shift(n);
    for (int r = 0; r < n; ++r) {
      shift[r] = integer(random, 0, 1) * uniform(random, -0.3, 0.1);
      sign[r] = integer(random, 0, 3) == 0 ? -1 : 1;
      laws.push_back(sign[r] > 0 ? RowLaw::lower_limit(shift[r]) : RowLaw::upper_limit(shift[r]));
    }
    const Solution expected =
        lemke(sign.asDiagonal() * S * sign.asDiagonal(), sign.asDiagonal() * (b - shift));
    if (getenv("PR") && problem == atoi(getenv("PR"))) setenv("TR","1",1); else unsetenv("TR"); 
 const ActiveSetOutcome outcome = solver.solve(laws, b);
    if (!expected.found) {
      ++contradictions;
      EXPECT_EQ(outcome.status, ActiveSetStatus::kContradiction) << problem;
      continue;
    }
    ++solved;
    ASSERT_TRUE(outcome.ok()) << problem << " " << to_string(outcome.status) << " " << outcome.residual;
    const double size =
        std::max({1.0, expected.lambda.cwiseAbs().maxCoeff(), solver.lambda.cwiseAbs().maxCoeff()});
    EXPECT_LT((solver.w - shift - sign.asDiagonal() * expected.w).cwiseAbs().maxCoeff(), 1e-7 * size)
        << problem;
  }
  std::printf("lemke %d %d\n", solved, contradictions);
  EXPECT_GT(solved, 200);
  EXPECT_GT(contradictions, 5);
}

/// All kinds of laws on up to 60 rows: w = S λ + b and every law, checked with dense arithmetic.  The problem
/// is a convex minimum, so that this proves the solution.
TEST(ActiveSet, SatisfiesEveryLawOnLargerProblems) {
  std::mt19937 random(9);
  int least_index = 0, fallbacks = 0, most_rounds = 0, solved = 0;
  for (int problem = 0; problem < 300; ++problem) {
    const World world = random_world(integer(random, 4, 10), integer(random, 10, 40), 0.2, random);
    Solver solver(world);
    const int n = solver.system.row_count();
    const MatrixXd S = dense_system(world);
    const VectorXd b = S * random_rates(n, random);
    std::vector<RowLaw> laws(n, RowLaw::equality());
    for (RowLaw& law : laws)
      if (integer(random, 0, 1)) {
        do law = random_law(random, true);
        while (law.level[0] > 1e9 || law.level[law.steps] < -1e9);  // no limits: always solvable
      }
    if (getenv("PR") && problem == atoi(getenv("PR"))) setenv("TR","1",1); else unsetenv("TR"); 
 const ActiveSetOutcome outcome = solver.solve(laws, b);
    ASSERT_TRUE(outcome.ok()) << problem << " " << to_string(outcome.status) << " " << outcome.residual;
    const double size = std::max(1.0, solver.lambda.cwiseAbs().maxCoeff());
    EXPECT_LT((S * solver.lambda + b - solver.w).cwiseAbs().maxCoeff(), 1e-11 * size);
    for (int r = 0; r < n; ++r)
      EXPECT_LT(violation(laws[r], solver.lambda[r], solver.w[r], 1e-8 * size), 1e-8 * size)
          << problem << " " << r;
    ++solved;
    least_index += outcome.least_index_rounds;
    fallbacks += outcome.descent_rounds > 0;
    most_rounds = std::max(most_rounds, outcome.rounds);
  }
  std::printf("larger: solved %d least-index %d fallbacks %d most rounds %d\n", solved, least_index,
              fallbacks, most_rounds);
}

}  // namespace
}  // namespace taut
