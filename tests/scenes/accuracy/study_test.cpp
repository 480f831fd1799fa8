#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "scenes/accuracy/convergence_study.h"
#include "scenes/accuracy/energy_study.h"
#include "scenes/accuracy/method_study.h"
#include "tests/source_dir.h"

/// What `taut accuracy --study` says, against what is known of the methods.
namespace taut::study_test {
namespace {

TEST(Study, OrderIsTheSlopeOfTheShortestStepsAboveRoundOff) {
  ConvergenceRun run;
  for (double dt : {0.8, 0.4, 0.2, 0.1}) run.points.push_back({dt, 1e-3 * std::pow(dt, 6), 1, ""});
  run.points.push_back({0.05, 1e-13, 1, ""});
  run.points.push_back({0.025, 1, 1, "failed"});
  EXPECT_NEAR(run.order(), 6, 1e-12);
  run.points.resize(1);
  EXPECT_EQ(run.order(), 0);
}

TEST(Study, EnergyDriftIsTheSlopeTimesTheTime) {
  EnergyRun run;
  for (int i = 1; i <= 50; ++i) run.windows.push_back({0.1 * i, -2, 3 - 0.02 * i, 5});  // −0.2 a second
  EXPECT_NEAR(run.drift(), -0.2 * 5, 1e-12);
  EXPECT_EQ(run.largest(), 5);
}

// 20,000 steps, as a short form of the million: RATTLE's energy comes back, and windows leave no step out.
TEST(Study, EnergyOfTheDoublePendulumComesBack) {
  const std::vector<EnergyRun> all = run_energy(20'000, 1e-3);
  std::map<std::string, EnergyRun> runs;
  for (const EnergyRun& run : all) runs[run.method] = run;
  ASSERT_EQ(runs.size(), 4u);
  for (const EnergyRun& run : all) {
    EXPECT_EQ(run.failed, "") << run.method;
    ASSERT_EQ(run.windows.size(), 500u);
    EXPECT_NEAR(run.windows.back().time, 20, 1e-9);
    for (const EnergyRun::Window& w : run.windows) {
      EXPECT_LE(w.least, w.mean);
      EXPECT_LE(w.mean, w.most);
    }
    EXPECT_LE(run.max_gap, 1e-9) << run.method;
  }
  const EnergyRun &second = runs["RATTLE"], &fourth = runs["RATTLE of order 4"];
  const EnergyRun& runge_kutta = runs["force level, Runge-Kutta, position push"];
  EXPECT_LT(std::abs(second.drift()), 0.05 * second.largest());
  EXPECT_LT(std::abs(fourth.drift()), 0.05 * fourth.largest());
  EXPECT_LT(fourth.largest(), 1e-3 * second.largest());
  const EnergyRun& midpoint = runs["recursion, midpoint"];
  EXPECT_LT(std::abs(midpoint.drift()), 0.05 * midpoint.largest());
  // Runge–Kutta loses energy all the time, however little.
  EXPECT_GT(std::abs(runge_kutta.drift()), 0.2 * runge_kutta.largest());
}

TEST(Study, IntegratorsAndSolversHaveTheirOrders) {
  const std::filesystem::path folder = std::filesystem::path(testing::source_dir()) / "tests" / "references";
  const std::map<std::string, double> nominal = {{"rattle", 2},      {"rattle4", 4},
                                                 {"rattle6", 6},     {"rattle8", 8},
                                                 {"force-euler", 1}, {"force-runge-kutta", 4},
                                                 {"moreau-jean", 1}, {"gauss-seidel", 2},
                                                 {"pairwise", 2},    {"propagation", 2},
                                                 {"recursive", 4},   {"recursive-midpoint", 2},
                                                 {"lagrangian", 4},  {"lagrangian-midpoint", 2}};
  for (const ConvergenceRun& run : run_convergence(folder, {"pendulum_simple_90", "no such case"})) {
    EXPECT_EQ(run.id, "pendulum_simple_90");
    if (run.method == "rattle8") {  // at round-off after its first step
      EXPECT_LE(run.points.front().error, 1e-7);
    } else if (run.method == "recursive" || run.method == "lagrangian") {
      // Errors of higher order outweigh that of order 4 down to steps of 4 ms; it is seen below.
      ASSERT_EQ(run.points[6].dt, 1e-3);
      EXPECT_NEAR(std::log2(run.points[5].error / run.points[6].error), 4, 0.2) << run.method;
    } else {
      EXPECT_NEAR(run.order(), nominal.at(run.method), 0.3) << run.method;
    }
  }
}

TEST(Study, MethodsDoWhatTheyAreKnownFor) {
  std::map<std::string, std::map<std::string, MethodRun>> runs;
  for (MethodRun& run : run_methods(1e-3, 0.5)) runs[run.mechanism][run.method] = std::move(run);
  ASSERT_EQ(runs.size(), 3u);
  for (auto& [mechanism, by] : runs) {
    EXPECT_EQ(by.size(), compared_methods().size());
    EXPECT_LE(by["RATTLE"].max_gap, 1e-9) << mechanism;
    EXPECT_LE(by["RATTLE of order 4"].max_drift, by["RATTLE"].max_drift) << mechanism;
    EXPECT_EQ(by["recursion, Runge-Kutta"].failed, "") << mechanism;
    EXPECT_LE(by["recursion, Runge-Kutta"].max_gap, 1e-9) << mechanism;
    EXPECT_LE(by["recursion, Runge-Kutta"].max_drift, by["RATTLE"].max_drift) << mechanism;
    // The same accelerations to round-off.
    EXPECT_NEAR(by["Lagrange, Runge-Kutta"].energy_end, by["recursion, Runge-Kutta"].energy_end, 1e-9);
    // Joints drift apart at force level, and less with a cure.
    EXPECT_GT(by["force level, Euler"].max_gap, 5e-5) << mechanism;
    EXPECT_LT(by["force level, Euler, Baumgarte 0.8"].max_gap, 0.1 * by["force level, Euler"].max_gap);
    EXPECT_LT(by["force level, Runge-Kutta, position push"].max_gap, by["force level, Runge-Kutta"].max_gap);
    // More sweeps, less gap.
    EXPECT_LE(by["Gauss-Seidel impulses, 50 sweeps, SOR 1.5"].max_gap,
              by["Gauss-Seidel impulses, 10 sweeps"].max_gap);
    EXPECT_LE(by["pairwise impulses, 50 a joint"].max_gap, by["pairwise impulses, 10 a joint"].max_gap);
  }
}

}  // namespace
}  // namespace taut::study_test
