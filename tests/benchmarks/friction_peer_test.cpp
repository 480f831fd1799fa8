#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "scenes/support/child_process.h"

/// Whether each solver of friction problems that is installed solves what it is given, and is judged alike.
namespace taut::testing::friction_peer_test {
namespace {

using Json = nlohmann::json;

struct SolverCase {
  const char *peer, *method, *start;
};
void PrintTo(const SolverCase& c, std::ostream* out) { *out << c.peer << c.method << c.start; }

class FrictionPeers : public ::testing::TestWithParam<SolverCase> {
 protected:
  static std::filesystem::path program() {
    return std::filesystem::path(TAUT_PEERS) / (std::string("peer_friction_") + GetParam().peer);
  }
  void SetUp() override {
    if (!std::filesystem::exists(program())) GTEST_SKIP() << GetParam().peer << " is not installed";
  }
  /// The lines that it prints for a problem.
  static std::vector<Json> lines_of(const std::string& problem) {
    const ChildResult child = run_child(
        program(), {"--problem", problem, "--method", GetParam().method, "--start", GetParam().start}, true,
        60);
    EXPECT_TRUE(child.good()) << child.message();
    std::vector<Json> lines;
    std::istringstream text(child.output);
    for (std::string line; std::getline(text, line);)
      if (Json json = Json::parse(line, nullptr, false); json.is_object()) lines.push_back(std::move(json));
    return lines;
  }
};

/// A plate on a few points, a heap: easy for all.
TEST_P(FrictionPeers, SolveWhatIsEasy) {
  for (const char* problem : {"stage:6", "stage:2"}) {
    const std::vector<Json> lines = lines_of(problem);
    ASSERT_FALSE(lines.empty()) << problem;
    const Json& last = lines.back();
    EXPECT_EQ(last.at("status"), "solved") << last;
    EXPECT_EQ(last.at("problem"), problem);
    EXPECT_LE(last.at("residual").at("impulses").get<double>(), 1e-8);
    EXPECT_GT(last.at("seconds").get<double>(), 0);
  }
}

INSTANTIATE_TEST_SUITE_P(All, FrictionPeers,
                         ::testing::Values(SolverCase{"taut", "", "cold"}, SolverCase{"taut", "", "warm"},
                                           SolverCase{"siconos", "vi", "cold"},
                                           SolverCase{"siconos", "prox", "cold"},
                                           SolverCase{"siconos", "nsn", "cold"},
                                           SolverCase{"siconos", "nsgs", "cold"}),
                         [](const auto& solver) {
                           const SolverCase& c = solver.param;
                           return std::string(c.peer) + c.method + c.start;
                         });

}  // namespace
}  // namespace taut::testing::friction_peer_test
