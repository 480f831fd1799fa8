#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/run_program.h"
#include "tests/temporary.h"

/// What is strange in a scene file, as the program says it.
namespace taut::testing::scene_warnings_program_test {
namespace {

TEST(ProgramWarnings, OfSceneFilesHaveTheirLine) {
  const std::string file = temporary("door.json"), report = temporary("report.json");
  write_text(file, R"({"format": "taut-scene/1", "dt": 0.01, "duration": 0.02,
 "bodies": [{"name": "door", "mass": 1, "inertia": [1, 1, 1]}],
 "joints": [{"name": "post", "type": "hinge", "a": "ground", "b": "door", "anchor": [0, 0, 0], "axis": [0, 0, 3],
   "axes": {"angle": {"limits": {"lower": -90, "upper": 90}}}}]})");
  const std::vector<std::string> expected{
      file + ":3:104: /joints/0/axis of \"post\": has length 3 and is taken with length 1 (value: [0,0,3])",
      file +
          ":4:43: /joints/0/axes/angle/limits/lower of \"post\": is 14.3 turns, since it is in radians; if "
          "degrees "
          "are meant, write \"lower_deg\" (value: -90)",
      file + ":4:57: /joints/0/axes/angle/limits/upper of \"post\": is 14.3 turns"};
  const Outcome check = run_program({"check", file}), run = run_program({"run", file, "--report", report});
  EXPECT_EQ(check.exit_status, 0) << check.err;
  EXPECT_EQ(run.exit_status, 0) << run.err;
  const nlohmann::json written = nlohmann::json::parse(read_text(report));
  for (const std::string& warning : expected) {
    EXPECT_NE(check.out.find("warning: " + warning), std::string::npos) << warning << "\n" << check.out;
    EXPECT_NE(run.out.find(" " + warning), std::string::npos) << warning << "\n" << run.out;
    EXPECT_TRUE(std::ranges::any_of(written["warnings"], [&](const nlohmann::json& each) {
      return each.get<std::string>().starts_with(warning);
    })) << warning;
  }
}

}  // namespace
}  // namespace taut::testing::scene_warnings_program_test
