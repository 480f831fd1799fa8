#include "solvers/complementarity/active_set.h"

#include <gtest/gtest.h>

#include "scenes/builders/scene.h"
#include "tests/allocation_counter.h"
#include "tests/solvers/complementarity/law_problems.h"

namespace taut::active_set_test {
namespace {

using namespace law_problems;

struct Solver {
  explicit Solver(const World& world) : system(system_of(world)), active_set(system) {
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

/// Friction and motors ask for nothing that they cannot do; limits of dependent rows may.
bool always_solvable(const RowLaw& law) {
  return std::isfinite(law.level[0]) && std::isfinite(law.level[law.steps]);
}

VectorXd random_rates(int n, std::mt19937& random) {
  VectorXd b(n);
  for (double& v : b) v = uniform(random, -1, 1);
  return b;
}

/// Small problems with up to six bounded rows against every combination of segments: repeated joints, slopes,
/// updates of the factor.
class ActiveSetSmall : public ::testing::TestWithParam<std::tuple<double, bool, bool>> {};

TEST_P(ActiveSetSmall, AgreesWithTheEnumerationOfAllPieces) {
  const auto [repeated, slopes, update] = GetParam();
  std::mt19937 random(1234);
  ActiveSetSettings settings;
  settings.update_factor = update;
  int solved = 0, contradictions = 0, soft = 0, fallbacks = 0, pivots = 0;
  for (int problem = 0; problem < 1500; ++problem) {
    const int joints = integer(random, 2, 8), bodies = integer(random, 1, 4);
    const World world = random_world(bodies, joints, repeated, random);
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
    fallbacks += outcome.descent_rounds > 0;
    pivots += outcome.pivots;
    if (!expected.found) {
      ++contradictions;
      EXPECT_EQ(outcome.status, ActiveSetStatus::kContradiction) << problem;
      continue;
    }
    if (expected.softest <
        1e-6) {  // near those that are left alone (RankTuning::kStepping): w depends on them
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
  EXPECT_LE(fallbacks, 3);
}

INSTANTIATE_TEST_SUITE_P(All, ActiveSetSmall,
                         ::testing::Combine(::testing::Values(0.0, 0.4), ::testing::Bool(),
                                            ::testing::Bool()));

/// Limits alone are a linear complementarity problem; up to 40 of them, more than bodies have freedoms.
TEST(ActiveSet, AgreesWithLemkeOnLimits) {
  std::mt19937 random(5);
  int solved = 0, contradictions = 0, lost = 0;
  for (int problem = 0; problem < 300; ++problem) {
    const int joints = integer(random, 5, 40), bodies = integer(random, 2, 8);
    const World world = random_world(bodies, joints, 0.2, random);
    Solver solver(world);
    const int n = solver.system.row_count();
    const MatrixXd S = dense_system(world);
    // Every fifth problem asks for rates that the bodies may be unable to give.
    VectorXd b = S * random_rates(n, random);
    if (problem % 5 == 0) b += 0.1 * random_rates(n, random);
    std::vector<RowLaw> laws;
    VectorXd sign(n), shift(n);
    for (int r = 0; r < n; ++r) {
      sign[r] = integer(random, 0, 3) == 0 ? -1 : 1;
      shift[r] = sign[r] * integer(random, 0, 1) * uniform(random, -0.3, problem % 4 == 0 ? 0.1 : 0);
      laws.push_back(sign[r] > 0 ? RowLaw::lower_limit(shift[r]) : RowLaw::upper_limit(shift[r]));
    }
    const Solution expected =
        lemke(sign.asDiagonal() * S * sign.asDiagonal(), sign.asDiagonal() * (b - shift));
    const ActiveSetOutcome outcome = solver.solve(laws, b);
    if (!expected.found && outcome.ok()) {
      ++lost;  // Lemke's path ended in round-off; the laws themselves are the proof
      for (int r = 0; r < n; ++r)
        EXPECT_LT(violation(laws[r], solver.lambda[r], solver.w[r], 1e-8), 1e-8) << problem << " " << r;
      continue;
    }
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
  EXPECT_LT(lost, 10);
  EXPECT_GT(solved, 200);
  EXPECT_GT(contradictions, 5);
}

/// All kinds of laws on up to 60 rows: w = S λ + b and every law, checked with dense arithmetic.  The problem
/// is a convex minimum, so that this proves the solution.
TEST(ActiveSet, SatisfiesEveryLawOnLargerProblems) {
  std::mt19937 random(9);
  int least_index = 0, fallbacks = 0, solved = 0;
  for (int problem = 0; problem < 300; ++problem) {
    const int joints = integer(random, 10, 40), bodies = integer(random, 4, 10);
    const World world = random_world(bodies, joints, 0.2, random);
    Solver solver(world);
    const int n = solver.system.row_count();
    const MatrixXd S = dense_system(world);
    const VectorXd b = S * random_rates(n, random);
    std::vector<RowLaw> laws(n, RowLaw::equality());
    for (RowLaw& law : laws)
      if (integer(random, 0, 1)) {
        do law = random_law(random, true);
        while (!always_solvable(law));
      }
    const ActiveSetOutcome outcome = solver.solve(laws, b);
    ASSERT_TRUE(outcome.ok()) << problem << " " << to_string(outcome.status) << " " << outcome.residual;
    const double size = std::max(1.0, solver.lambda.cwiseAbs().maxCoeff());
    EXPECT_LT((S * solver.lambda + b - solver.w).cwiseAbs().maxCoeff(), 1e-11 * size);
    for (int r = 0; r < n; ++r)  // an error of w counts c times in λ + c w
      EXPECT_LT(violation(laws[r], solver.lambda[r], solver.w[r], 1e-8 * size),
                1e-8 * size * (1 + laws[r].slope))
          << problem << " " << r;
    ++solved;
    least_index += outcome.least_index_rounds;
    fallbacks += outcome.descent_rounds > 0;
  }
  // What pivoting alone cannot do, the descent does; it is rare.
  EXPECT_EQ(solved, 300);
  EXPECT_LE(fallbacks, 15);
  EXPECT_GT(least_index, 0);
}

/// Two bodies on one line, joined by equal rods: rows with one Jacobian, S = 3 everywhere.
struct Repeated {
  Repeated(int count) {
    BodySpec spec;
    spec.mass = MassProperties::sphere(0.1, 1.0 / 3);
    spec.pose.p = {1, 0, 0};
    const BodyId body = world.add_body(spec);
    for (int i = 0; i < count; ++i) world.add("", Distance(BodyId{0}, body, Vec3::Zero(), Vec3::Zero(), 1));
  }
  World world;
};

TEST(ActiveSet, AMotorAgainstItsLimitInALoopPushesWithItsFullForce) {
  Solver solver(Repeated(2).world);
  // One row is locked, the other has a motor for 2 rad/s with at most 5 N·s.
  const ActiveSetOutcome outcome =
      solver.solve({RowLaw::equality(), RowLaw::box(-5, 5, 2)}, VectorXd::Zero(2));
  ASSERT_TRUE(outcome.ok()) << outcome.residual;
  EXPECT_NEAR(solver.lambda[1], 5, 1e-12);
  EXPECT_NEAR(solver.lambda[0], -5, 1e-7);  // the shift of the singular factor, refined
  EXPECT_NEAR(solver.w[0], 0, 1e-9);
}

TEST(ActiveSet, TwoLimitsHitAtOnceShareTheImpulse) {
  Solver solver(Repeated(2).world);
  const ActiveSetOutcome outcome =
      solver.solve({RowLaw::lower_limit(0), RowLaw::lower_limit(0)}, VectorXd::Constant(2, -6));
  ASSERT_TRUE(outcome.ok());
  EXPECT_NEAR(solver.lambda[0], 1, 1e-8);
  EXPECT_NEAR(solver.lambda[1], 1, 1e-8);
  // Touching without a push is a solution at once, on either segment.
  Solver touching(Repeated(2).world);
  EXPECT_TRUE(touching.solve({RowLaw::lower_limit(1), RowLaw::lower_limit(1)}, VectorXd::Ones(2)).ok());
  EXPECT_EQ(touching.lambda.norm(), 0);
}

TEST(ActiveSet, TheTighterOfTwoLimitsActsAlone) {
  Solver solver(Repeated(3).world);
  const ActiveSetOutcome outcome = solver.solve(
      {RowLaw::lower_limit(0), RowLaw::lower_limit(0.6), RowLaw::box(-1, 1)}, VectorXd::Constant(3, -6));
  ASSERT_TRUE(outcome.ok());
  EXPECT_EQ(solver.lambda[0], 0);
  EXPECT_NEAR(solver.w[0], 0.6, 1e-9);
  EXPECT_EQ(solver.lambda[2], -1);  // slips forward with the limit
  EXPECT_NEAR(solver.lambda[1], 3.2, 1e-8);
}

TEST(ActiveSet, SaysWhatItCannotDo) {
  Solver solver(Repeated(2).world);
  EXPECT_EQ(solver.solve({RowLaw::equality(0), RowLaw::lower_limit(1)}, VectorXd::Zero(2)).status,
            ActiveSetStatus::kContradiction);
  EXPECT_TRUE(solver.lambda.allFinite());
  // The same is right for a caller to whom 2 m/s is nothing.
  ActiveSetSettings lenient;
  lenient.rate_tolerance = 2;
  EXPECT_TRUE(solver.solve({RowLaw::equality(0), RowLaw::lower_limit(1)}, VectorXd::Zero(2), lenient).ok());
  const VectorXd bad = VectorXd::Constant(2, std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(solver.solve({RowLaw::equality(0), RowLaw::lower_limit(1)}, bad).status,
            ActiveSetStatus::kNotFinite);
  // And it is not spoilt by that.
  EXPECT_EQ(solver.lambda.norm(), 0);
  EXPECT_TRUE(solver.solve({RowLaw::equality(0), RowLaw::lower_limit(-1)}, VectorXd::Zero(2)).ok());
}

/// A net or chain with laws on a part of its rows; b is what random velocities give.
struct LargeCase {
  LargeCase(const char* name, int n, double part, unsigned seed)
      : random(seed), scene(build_scene(name, {{"n", double(n)}})), solver(scene.world) {
    const ConstraintSystem& system = solver.system;
    laws.assign(system.row_count(), RowLaw::equality());
    for (RowLaw& law : laws)
      if (uniform(random, 0, 1) < part) {
        do law = random_law(random, true);
        while (system.singular() && !always_solvable(law));
      }
    b = rates(1);
  }
  VectorXd rates(double size) {
    std::vector<Twist> twists(solver.system.rows().body_count());
    for (int i = 0; i < scene.world.body_count(); ++i)
      if (!scene.world.is_fixed(BodyId{i}))
        twists[i] = {size * random_vector(random), size * random_vector(random)};
    VectorXd out(solver.system.row_count());
    solver.system.rows().apply(solver.system.jacobian(), twists, {out.data(), laws.size()});
    return out;
  }
  std::mt19937 random;
  Scene scene;
  Solver solver;
  std::vector<RowLaw> laws;
  VectorXd b;
};

TEST(ActiveSet, AgreesWithLongProjectedGaussSeidelOnScenes) {
  // Nets converge in thousands of sweeps; a chain of n links takes n² of them.
  for (const auto& [name, n] :
       {std::pair("net-corners", 8), std::pair("chain", 24), std::pair("joint-grid", 6)}) {
    LargeCase large(name, n, 0.3, 11);
    const ActiveSetOutcome outcome = large.solver.solve(large.laws, large.b);
    ASSERT_TRUE(outcome.ok()) << name << " " << to_string(outcome.status) << " " << outcome.residual;
    ProjectedGaussSeidel gauss_seidel(large.solver.system);
    VectorXd lambda = VectorXd::Zero(large.b.size()), w(large.b.size());
    const GaussSeidelOutcome swept = gauss_seidel.solve(large.laws, {large.b.data(), large.laws.size()},
                                                        {lambda.data(), large.laws.size()}, 100000, 1e-9);
    EXPECT_TRUE(swept.converged) << name << " " << swept.residual;
    large.solver.system.multiply({lambda.data(), large.laws.size()}, {w.data(), large.laws.size()});
    EXPECT_LT((w + large.b - large.solver.w).cwiseAbs().maxCoeff(), 1e-4) << name << " " << swept.sweeps;
  }
}

TEST(ActiveSet, KeepsItsPromisesOnThousandsOfRows) {
  for (const auto& [name, n] :
       {std::pair("net-corners", 16), std::pair("chain", 700), std::pair("joint-grid", 16)}) {
    LargeCase large(name, n, 0.3, 12);
    const ActiveSetOutcome outcome = large.solver.solve(large.laws, large.b);
    ASSERT_TRUE(outcome.ok()) << name << " " << to_string(outcome.status) << " " << outcome.residual;
    EXPECT_LT(outcome.residual, 1e-9);
    const double size = large.solver.lambda.cwiseAbs().maxCoeff();
    for (int r = 0; r < large.b.size(); ++r)
      ASSERT_LT(violation(large.laws[r], large.solver.lambda[r], large.solver.w[r], 1e-6), 1e-6 * size) << r;
  }
}

TEST(ActiveSet, TheRightSetCostsOneFactorisationAndNoPivot) {
  LargeCase large("net-corners", 10, 0.3, 13);
  Solver& solver = large.solver;
  const std::size_t n = large.laws.size();
  ASSERT_TRUE(solver.solve(large.laws, large.b).ok());
  const VectorXd expected = solver.w;
  solver.system.reset_counters();
  solver.active_set.prepare(large.laws, {large.b.data(), n}, {solver.lambda.data(), n});
  solver.system.factorize(solver.times);
  const ActiveSetOutcome outcome = solver.solve(large.laws, large.b);
  ASSERT_TRUE(outcome.ok());
  EXPECT_EQ(outcome.pivots, 0);
  EXPECT_EQ(outcome.rounds, 0);
  EXPECT_EQ(solver.system.counters().factorizations, 1);
  EXPECT_LE(solver.system.counters().backsolves, 2);
  EXPECT_EQ(solver.system.counters().analyses, 0);
  EXPECT_LT((solver.w - expected).cwiseAbs().maxCoeff(), 1e-10);
}

/// Whatever the path was, by updates or not, later linear solves are those of the final set.
TEST(ActiveSet, SolvesLinearSystemsWithTheFinalSet) {
  LargeCase large("net-corners", 8, 0.3, 16);
  ASSERT_TRUE(large.solver.solve(large.laws, large.b).ok());
  const VectorXd rates = large.b + large.rates(0.05);
  const ActiveSetOutcome outcome = large.solver.solve(large.laws, rates);
  ASSERT_TRUE(outcome.ok());
  EXPECT_EQ(outcome.factorizations, 0);
  EXPECT_GT(outcome.pivots, 0);
  VectorXd x = VectorXd::Ones(rates.size()), Sx(rates.size());
  const std::size_t n = large.laws.size();
  large.solver.active_set.solve_linear({x.data(), n});
  large.solver.system.multiply({x.data(), n}, {Sx.data(), n});
  for (std::size_t r = 0; r < n; ++r) {
    const bool vertical = RowLaw::is_vertical(large.solver.active_set.segments()[r]);
    if (vertical)
      EXPECT_NEAR(Sx[r], 1, 1e-9) << r;
    else if (large.laws[r].slope > 0)
      EXPECT_NEAR(Sx[r] + x[r] / large.laws[r].slope, 1, 1e-9) << r;
    else
      EXPECT_EQ(x[r], 0) << r;
  }
}

TEST(ActiveSet, FreeRowsAreExactToRoundOff) {
  LargeCase large("net-corners", 10, 0.3, 14);
  const ActiveSetOutcome outcome = large.solver.solve(large.laws, large.b);
  ASSERT_TRUE(outcome.ok());
  EXPECT_LT(outcome.residual, 1e-12);
}

TEST(ActiveSet, AllocatesNothing) {
  LargeCase large("net-corners", 8, 0.3, 15);
  Solver& solver = large.solver;
  const std::size_t n = large.laws.size();
  ASSERT_TRUE(solver.solve(large.laws, large.b).ok());
  std::vector<VectorXd> other;
  for (int i = 0; i < 10; ++i) other.push_back(large.b + large.rates(0.2));
  const long before = allocation_count();
  int pivots = 0;
  for (const VectorXd& b : other) {
    solver.active_set.prepare(large.laws, {b.data(), n}, {solver.lambda.data(), n});
    solver.system.factorize(solver.times);
    const ActiveSetOutcome outcome = solver.solve(large.laws, b);
    EXPECT_TRUE(outcome.ok());
    pivots += outcome.pivots;
  }
  EXPECT_EQ(allocation_count() - before, 0);
  EXPECT_GT(pivots, 20);
}

}  // namespace
}  // namespace taut::active_set_test
