#include "benchmarks/random_stages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "solvers/friction/friction_solver.h"

// A few of the random stages of benchmarks/random_stages: towers, walls, heaps, arches, wedges, nets, plates
// and linkages with masses that differ by up to 10⁶.
namespace taut::random_stages_test {
namespace {

TEST(RandomStages, AreSolvedOrShownToHaveNoSolution) {
  std::vector<int> factorisations;
  int inexact = 0;
  for (int i = 1000; i < 1048; ++i) {
    const benchmarks::RandomStage stage(i);
    const FrictionProblem problem = stage.problem();
    const FrictionResult result = solve_friction(problem);
    factorisations.push_back(result.factorisations);
    inexact += result.status == FrictionStatus::kInexact;
    if (result.status == FrictionStatus::kSolved) {
      EXPECT_TRUE(friction_errors(problem, result.r).met(1e-8)) << i;
    }
    EXPECT_EQ(result.certificate.has_value(), result.status == FrictionStatus::kNoSolution) << i;
  }
  EXPECT_EQ(inexact, 0);
  // Of 10⁴ the median is 6.
  std::nth_element(factorisations.begin(), factorisations.begin() + 24, factorisations.end());
  EXPECT_LE(factorisations[24], 10);
}

/// The same number is the same problem, with joints that depend on each other among them.
TEST(RandomStages, AreTheSameEachTime) {
  for (int i = 0; i < 8; ++i) {
    const FrictionProblem one = benchmarks::RandomStage(i).problem(),
                          two = benchmarks::RandomStage(i).problem();
    EXPECT_EQ(one.q, two.q);
    EXPECT_EQ((one.W - two.W).norm(), 0);
    EXPECT_EQ(benchmarks::RandomStage(i).family(),
              benchmarks::kStageFamilyNames[static_cast<std::size_t>(i)]);
    EXPECT_EQ(one.equalities > 0, i == 5 || i == 7) << i;
    EXPECT_GE(benchmarks::RandomStage(i, 3).problem().rows(), 3);
  }
}

}  // namespace
}  // namespace taut::random_stages_test
