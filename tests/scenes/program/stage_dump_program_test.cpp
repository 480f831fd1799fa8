#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/run_program.h"
#include "tests/temporary.h"

// Friction problems of a run, and that `taut friction` solves them.
namespace taut::testing::stage_dump_program_test {
namespace {

namespace fs = std::filesystem;

TEST(StageDumpProgram, WritesWhatTheProgramForFrictionSolves) {
  const fs::path folder = temporary("stages");
  const Outcome run = run_program({"run", "chain-over-cylinder", "--set", "n=8", "--steps", "40", "--quiet",
                                   "--dump-stages", folder.string()});
  ASSERT_EQ(run.exit_status, 0) << run.err;
  std::vector<std::string> words{"friction", "--json", "-"};
  for (const auto& entry : fs::directory_iterator(folder)) words.push_back(entry.path().string());
  ASSERT_GE(words.size(), 43u);  // of a step there are two
  EXPECT_TRUE(fs::exists(folder / "000040-velocities.dat"));
  const Outcome solved = run_program(words);
  EXPECT_EQ(solved.exit_status, 0) << solved.err;
  for (const auto& result : nlohmann::json::parse(solved.out)) {
    EXPECT_EQ(result.at("status"), "solved") << result;
    EXPECT_GT(result.at("contacts"), 0);
  }
}

TEST(StageDumpProgram, RefusesAFolderThatCannotBe) {
  const Outcome run =
      run_program({"run", "stack", "--steps", "1", "--quiet", "--dump-stages", "/dev/null/stages"});
  EXPECT_EQ(run.exit_status, 2);
  EXPECT_NE(run.err.find("--dump-stages"), std::string::npos) << run.err;
}

}  // namespace
}  // namespace taut::testing::stage_dump_program_test
