#include "scenes/bench/friction_report.h"

#include <gtest/gtest.h>

// What the page of `taut bench --friction` says of results that are made up.
namespace taut::friction_report_test {
namespace {

using Json = nlohmann::ordered_json;

Json run_of(const char* problem, int contacts, const char* solver, const char* method, const char* start,
            const char* status, double seconds, int factorisations = -1) {
  Json run{{"problem", problem}, {"contacts", contacts}, {"solver", solver},  {"method", method},
           {"start", start},     {"status", status},     {"seconds", seconds}};
  if (factorisations >= 0) run["factorisations"] = factorisations;
  if (std::string(status) == "inexact")
    run["residual"] = {{"impulses", 1e-9}, {"rates", 3e-5}, {"map", 2e-6}};
  return run;
}

/// On a small problem PROX takes half of taut's time, on a large one twice; one is left to NSGS, one has no
/// solution.
BenchResults results() {
  return {{"machine", {{"processor", "a machine"}}},
          {"limit_s", 5.0},
          {"runs",
           {run_of("small.dat", 10, "taut", "", "cold", "solved", 2e-3, 4),
            run_of("small.dat", 10, "taut", "", "warm", "solved", 1e-3, 2),
            run_of("small.dat", 10, "siconos", "prox", "cold", "solved", 1e-3),
            run_of("large.dat", 300, "taut", "", "cold", "solved", 10e-3, 80),
            run_of("large.dat", 300, "siconos", "prox", "cold", "solved", 20e-3),
            run_of("hard.dat", 400, "taut", "", "cold", "inexact", 1, 900),
            run_of("hard.dat", 400, "siconos", "nsgs", "cold", "solved", 3),
            run_of("hard.dat", 400, "siconos", "prox", "cold", "time limit", 5),
            run_of("none.dat", 5, "taut", "", "cold", "no solution", 1e-3, 9)}}};
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(FrictionReport, LabelsSolversByMethodAndStart) {
  EXPECT_EQ((FrictionRun{"taut", "", "cold"}.label()), "taut cold");
  EXPECT_EQ((FrictionRun{"taut", "", "warm"}.label()), "taut warm");
  EXPECT_EQ((FrictionRun{"siconos", "vi", "cold"}.label()), "siconos vi");
  EXPECT_EQ(friction_plan().size(), 7u);
}

TEST(FrictionReport, CountsWhatHasASolutionAndComparesWithProx) {
  const std::string page = friction_page(results(), "taut bench --friction");
  EXPECT_TRUE(contains(page, "- problems: 4, of which 1 are shown to have no solution")) << page;
  EXPECT_TRUE(contains(page, "| taut cold | 2 of 3 | 80, 80, 80, 80 | 33.3 % | 1 of 2, 10.0 |")) << page;
  EXPECT_TRUE(contains(page, "| siconos prox | 2 of 3 |  |  | 1 of 2, 20.0 |")) << page;
  EXPECT_TRUE(contains(page, "| all solved, cold | 2 of 3 | no |")) << page;
  EXPECT_TRUE(contains(page, "0.50 of its time on the 1 that both solve | yes |")) << page;
  EXPECT_TRUE(contains(page, "| hard.dat | 400 | inexact 3e-05 |")) << page;
}

/// What is not solved comes first, then what is slower.
TEST(FrictionReport, ListsWhereTautLosesFirst) {
  const std::string losses = friction_losses(results());
  EXPECT_TRUE(contains(losses, "A peer is ahead on 2 of 4 problems.")) << losses;
  const std::size_t hard = losses.find("| hard.dat | 400 | inexact 3e-05 | siconos nsgs | 3e+03 | inf |");
  const std::size_t small = losses.find("| small.dat | 10 | 2 (4) | siconos prox | 1 | 2 |");
  ASSERT_NE(hard, std::string::npos) << losses;
  ASSERT_NE(small, std::string::npos) << losses;
  EXPECT_LT(hard, small);
  EXPECT_FALSE(contains(losses, "large.dat"));
}

/// Within twice the least time taut has solved two of three problems; steps are at log2 of the factor.
TEST(FrictionReport, DrawsPerformanceProfiles) {
  const std::string script = friction_plots(results(), "folder");
  EXPECT_TRUE(contains(script, "folder/profile-all.svg"));
  EXPECT_TRUE(contains(script, "folder/profile-large.svg"));
  EXPECT_TRUE(contains(script, "$P0 << EOD\n0 0\n0 0.333333\n1 0.666667\n20 0.666667\nEOD\n")) << script;
}

}  // namespace
}  // namespace taut::friction_report_test
