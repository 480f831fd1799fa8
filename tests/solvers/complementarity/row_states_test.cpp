#include <gtest/gtest.h>

#include "solvers/complementarity/projected_gauss_seidel.h"
#include "solvers/system/row_updates.h"
#include "tests/solvers/complementarity/law_problems.h"

namespace taut::row_states_test {
namespace {

using namespace law_problems;

std::vector<double> random_states(int n, std::mt19937& random) {
  std::vector<double> states(n, 0.0);
  for (double& s : states) {
    const int kind = integer(random, 0, 3);
    if (kind == 0) s = kMasked;
    if (kind == 1) s = std::pow(10, uniform(random, -2, 2));
  }
  return states;
}

/// (S + Σ)⁺ x on the rows that are not masked, by a dense decomposition of S scaled to S_rr = 1: the least
/// norm is that of the scaled multipliers, as ε diag S has it.
VectorXd dense_solve(const MatrixXd& S, const std::vector<double>& states, const VectorXd& x) {
  const auto n = static_cast<int>(states.size());
  std::vector<int> rows;
  for (int r = 0; r < n; ++r)
    if (states[r] != kMasked) rows.push_back(r);
  VectorXd out = VectorXd::Zero(n);
  if (rows.empty()) return out;
  MatrixXd A = S(rows, rows);
  for (std::size_t i = 0; i < rows.size(); ++i) A(i, i) += states[rows[i]];
  const VectorXd scale = A.diagonal().cwiseSqrt().cwiseInverse();
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> decomposition;
  decomposition.setThreshold(1e-10);
  decomposition.compute(scale.asDiagonal() * A * scale.asDiagonal());
  const VectorXd x_rows = x(rows), scaled = scale.cwiseProduct(x_rows);
  const VectorXd solution = scale.cwiseProduct(VectorXd(decomposition.solve(scaled)));
  for (std::size_t i = 0; i < rows.size(); ++i) out[rows[i]] = solution[i];
  return out;
}

/// Right-hand sides that the rows can reach: (S + Σ) y.
VectorXd reachable(const MatrixXd& S, const std::vector<double>& states, std::mt19937& random) {
  VectorXd y(S.rows());
  for (int r = 0; r < y.size(); ++r) y[r] = states[r] == kMasked ? 0 : uniform(random, -1, 1);
  VectorXd x = S * y;
  for (int r = 0; r < y.size(); ++r)
    if (states[r] != kMasked) x[r] += states[r] * y[r];
  return x;
}

/// Independent, then with repeated joints: singular, two back-solves through the shifted factor.
class RowStates : public ::testing::TestWithParam<double> {};

TEST_P(RowStates, SolveOnlyOnTheRowsThatAreLeft) {
  std::mt19937 random(21);
  int singular = 0;
  for (int problem = 0; problem < 300; ++problem) {
    const int joints = integer(random, 3, 10), bodies = integer(random, 4, 6);
    const World world = random_world(bodies, joints, GetParam(), random);
    ConstraintSystem system = system_of(world);
    const MatrixXd S = dense_system(world);
    const int n = system.row_count();
    StageTimes times;
    const std::vector<double> states = random_states(n, random);
    system.set_row_states(states);
    system.factorize(times);
    singular += system.singular();
    const VectorXd right = reachable(S, states, random), expected = dense_solve(S, states, right);
    VectorXd x = right;
    system.solve({x.data(), states.size()});
    // One pass of Eq. 1: 2 ε over the smallest eigenvalue, which is above 1e-4 here.
    EXPECT_LT((x - expected).norm(), 2e-4 * (1 + expected.norm())) << problem;
    for (int r = 0; r < n; ++r)
      if (states[r] == kMasked) {
        EXPECT_EQ(x[r], 0);
      }
    EXPECT_EQ(system.counters().analyses, 1);

    // All rows free again.
    system.set_row_states({});
    system.factorize(times);
    const std::vector<double> free(n, 0.0);
    const VectorXd full = reachable(S, free, random);
    x = full;
    system.solve({x.data(), states.size()});
    EXPECT_LT((S * x - full).norm(), 2e-4 * (1 + full.norm())) << problem;
  }
  EXPECT_EQ(singular > 50, GetParam() > 0) << singular;
}

TEST_P(RowStates, UpdatesOfAFactorAreAsGoodAsANewOne) {
  std::mt19937 random(22);
  int updated = 0, refused = 0;
  for (int problem = 0; problem < 300; ++problem) {
    const int joints = integer(random, 3, 10), bodies = integer(random, 4, 6);
    const World world = random_world(bodies, joints, GetParam(), random);
    ConstraintSystem system = system_of(world);
    const MatrixXd S = dense_system(world);
    const int n = system.row_count();
    StageTimes times;
    system.set_row_states(random_states(n, random));
    system.factorize(times);
    RowUpdates updates(system);
    for (int change = 0; change < 3; ++change) {  // columns stay from one to the next
      const std::vector<double> states = random_states(n, random);
      if (!updates.set_states(states, RowUpdates::kMaxRows)) {
        ++refused;
        continue;
      }
      ++updated;
      const VectorXd right = reachable(S, states, random);
      VectorXd x = right;
      updates.solve({x.data(), states.size()});
      VectorXd back = S * x;
      for (int r = 0; r < n; ++r) back[r] = states[r] == kMasked ? right[r] : back[r] + states[r] * x[r];
      EXPECT_LT((back - right).norm(), 2e-4 * (1 + right.norm())) << problem << " " << change;
      for (int r = 0; r < n; ++r)
        if (states[r] == kMasked) {
          EXPECT_EQ(x[r], 0);
        }
    }
  }
  // Repeated rows that join a regular factor make it singular: refused.
  EXPECT_GT(updated, (GetParam() > 0 ? 1 : 20) * refused) << refused;
}

INSTANTIATE_TEST_SUITE_P(Independent, RowStates, ::testing::Values(0.0));
INSTANTIATE_TEST_SUITE_P(Repeated, RowStates, ::testing::Values(0.4));

TEST(RowStates, ABudgetOfBackSolvesIsKept) {
  std::mt19937 random(23);
  const World world = random_world(12, 12, 0, random);
  ConstraintSystem system = system_of(world);
  StageTimes times;
  system.factorize(times);
  RowUpdates updates(system);
  std::vector<double> states(system.row_count(), 0.0);
  EXPECT_TRUE(updates.set_states(states, -1));
  states[0] = states[1] = kMasked;
  system.reset_counters();
  EXPECT_FALSE(updates.set_states(states, 1));
  EXPECT_TRUE(updates.set_states(states, 2));
  EXPECT_EQ(system.counters().backsolves, 2);
  states[0] = 0;
  EXPECT_TRUE(updates.set_states(states, 0));  // known from before
  EXPECT_FALSE(updates.set_states(states, -1));
  EXPECT_EQ(updates.changed_rows(), 0);
}

TEST(ProjectedGaussSeidel, FindsWhatTheEnumerationFinds) {
  std::mt19937 random(24);
  int checked = 0;
  for (int problem = 0; problem < 300; ++problem) {
    const World world = random_world(6, 6, 0, random);
    ConstraintSystem system = system_of(world);
    StageTimes times;
    system.factorize(times);
    const int n = system.row_count();
    const MatrixXd S = dense_system(world);
    VectorXd b(n), lambda = VectorXd::Zero(n);
    for (double& v : b) v = uniform(random, -1, 1);
    std::vector<RowLaw> laws(n, RowLaw::equality());
    for (int r = 0; r < std::min(n, 5); ++r) laws[r] = random_law(random, true);
    const Solution expected = enumerate_pieces(S, b, laws);
    if (!expected.found || expected.softest < 1e-3) continue;
    ProjectedGaussSeidel solver(system);
    const std::size_t size = laws.size();
    const GaussSeidelOutcome outcome =
        solver.solve(laws, {b.data(), size}, {lambda.data(), size}, 200000, 1e-13);
    EXPECT_TRUE(outcome.converged) << problem;
    EXPECT_LT((S * lambda + b - expected.w).cwiseAbs().maxCoeff(), 1e-8) << problem;
    ++checked;
  }
  EXPECT_GT(checked, 200);
}

}  // namespace
}  // namespace taut::row_states_test
