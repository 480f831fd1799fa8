#include "solvers/laws/row_law.h"

#include <gtest/gtest.h>

#include "tests/solvers/complementarity/law_problems.h"

namespace taut::row_law_test {
namespace {

using namespace law_problems;

TEST(RowLaw, ASumIsTheSumOfTheGraphs) {
  const RowLaw limit = RowLaw::lower_limit(-0.3) + RowLaw::upper_limit(0.7);
  const RowLaw friction = RowLaw::box(-2, 2), motor = RowLaw::box(-5, 1, 0.4);
  const RowLaw viscous = RowLaw::viscous(0.25);
  const RowLaw sum = limit + friction + motor + viscous;
  EXPECT_EQ(sum.steps, 4);
  EXPECT_EQ(sum.slope, 0.25);
  for (double w : {-0.31, -0.29, -0.01, 0.01, 0.39, 0.41, 0.69, 0.71})
    EXPECT_EQ(sum.level_at(w), limit.level_at(w) + friction.level_at(w) + motor.level_at(w)) << w;
}

TEST(RowLaw, StepsBeyondALimitVanish) {
  // Friction at 0 never slips backwards if w ≥ 0.1.
  const RowLaw law = RowLaw::box(-2, 2) + RowLaw::lower_limit(0.1);
  ASSERT_EQ(law.steps, 1);
  EXPECT_EQ(law.at[0], 0.1);
  EXPECT_EQ(law.level[1], -2);
  // Equal limits are an equality, and whatever else acts is part of its λ.
  const RowLaw locked = RowLaw::lower_limit(0.5) + RowLaw::upper_limit(0.5) + RowLaw::box(-1, 1);
  ASSERT_EQ(locked.steps, 1);
  EXPECT_EQ(locked.at[0], 0.5);
  EXPECT_FALSE(locked.bounded());
  // Equal breakpoints are one step.
  const RowLaw both = RowLaw::box(-1, 1) + RowLaw::box(-2, 3);
  ASSERT_EQ(both.steps, 1);
  EXPECT_EQ(both.level[0], 4);
  EXPECT_EQ(both.level[1], -3);
}

TEST(RowLaw, RefusesWhatExcludesItself) {
  EXPECT_THROW((void)(RowLaw::lower_limit(0.5) + RowLaw::upper_limit(0.4)), std::invalid_argument);
  EXPECT_THROW((void)(RowLaw::equality(0) + RowLaw::equality(1)), std::invalid_argument);
  EXPECT_THROW((void)RowLaw::box(1, 1), std::invalid_argument);
  EXPECT_THROW((void)RowLaw::viscous(-1), std::invalid_argument);
  RowLaw five = RowLaw::none();
  for (int k = 0; k < 4; ++k) five = five + RowLaw::box(-1, 1, k);
  EXPECT_THROW((void)(five + RowLaw::box(-1, 1, 4)), std::invalid_argument);
}

TEST(RowLaw, TheOneRowAnswerLiesOnTheLineAndOnTheGraph) {
  std::mt19937 random(3);
  for (int i = 0; i < 20000; ++i) {
    const RowLaw law = random_law(random, true);
    const double s = std::pow(10, uniform(random, -2, 2)), beta = uniform(random, -3, 3);
    const RowLaw::Point point = law.resolve(s, beta);
    const double size = 1 + std::abs(point.lambda) * std::max(1.0, s) + law.slope;
    EXPECT_NEAR(point.w, s * point.lambda + beta, 1e-13 * size * (1 + law.slope));
    EXPECT_LT(violation(law, point.lambda, point.w, 1e-13), 1e-13 * size * (1 + law.slope));
    if (RowLaw::is_vertical(point.segment))
      EXPECT_EQ(point.w, law.rate(point.segment));
    else
      EXPECT_EQ(point.lambda, law.force(point.segment) - law.slope * point.w);
  }
}

}  // namespace
}  // namespace taut::row_law_test
