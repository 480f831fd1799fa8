#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/run_program.h"
#include "tests/source_dir.h"
#include "tests/temporary.h"

/// `taut new` and `taut schema`: what a scene begins with.
namespace taut::testing::new_program_test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const std::string kSchema = source_dir() + "/scenes/examples/taut-scene.schema.json";

std::vector<std::string> listed_templates() {
  std::vector<std::string> names;
  std::istringstream lines(run_program({"new", "--list"}).out);
  for (std::string line; std::getline(lines, line);) names.push_back(line.substr(0, line.find(' ')));
  return names;
}

TEST(ProgramNew, ListsItsTemplates) {
  EXPECT_EQ(listed_templates(), (std::vector<std::string>{"arm", "chain", "machine", "pendulum"}));
  EXPECT_NE(run_program({"new", "--list"}).out.find("A robot arm: "), std::string::npos);
}

/// Without a warning, so that a beginner's own mistakes are the only ones.
TEST(ProgramNew, WritesScenesThatAreFineAndRun) {
  for (const std::string& name : listed_templates()) {
    const std::string file = temporary("new_" + name + ".json"), report = temporary("new_report.json");
    const Outcome written = run_program({"new", file, "--template", name});
    ASSERT_EQ(written.exit_status, 0) << written.err;
    EXPECT_NE(written.out.find("wrote " + file), std::string::npos) << written.out;
    const Outcome check = run_program({"check", file});
    EXPECT_EQ(check.exit_status, 0) << check.err;
    EXPECT_NE(check.out.find("fine: nothing wrong found"), std::string::npos) << name << check.out;
    const Outcome run = run_program({"run", file, "--quiet", "--report", report});
    EXPECT_EQ(run.exit_status, 0) << run.err;
    EXPECT_EQ(run.err, "") << name;
    const Json told = Json::parse(read_text(report));
    EXPECT_EQ(told["status"], "success") << name;
    // Of order 2: a pendulum's 48 J swing within 1.2e-3 of them at 4 ms.
    EXPECT_LE(told["energy"]["max_unexplained_rel"].get<double>(), 1.5e-3) << name;
  }
}

TEST(ProgramNew, BeginsWithAMachineOfWhichEveryPartIsExplained) {
  const std::string file = temporary("own.json");
  ASSERT_EQ(run_program({"new", file}).exit_status, 0);
  const std::string text = read_text(file);
  const Json scene = Json::parse(text, nullptr, true, true);
  EXPECT_EQ(scene["name"], "machine");
  EXPECT_EQ(scene["joints"][0]["type"], "hinge");
  EXPECT_TRUE(scene["joints"][0]["axes"]["angle"].contains("motor"));
  EXPECT_EQ(scene["ground"]["shapes"][0]["type"], "half_space");
  EXPECT_TRUE(fs::exists(std::string(scene["$schema"]))) << scene["$schema"];
  // A comment above each list and each body or joint, or at its beginning.
  std::istringstream lines(text);
  int comments = 0;
  for (std::string line; std::getline(lines, line);) comments += line.find("//") != std::string::npos;
  EXPECT_GE(comments, 12);
}

TEST(ProgramNew, WritesOverNothingUnlessAsked) {
  const std::string file = temporary("mine.json");
  write_text(file, "mine");
  const Outcome refused = run_program({"new", file});
  EXPECT_EQ(refused.exit_status, 2);
  EXPECT_NE(refused.err.find("--force"), std::string::npos) << refused.err;
  EXPECT_EQ(read_text(file), "mine");
  EXPECT_EQ(run_program({"new", file, "--force"}).exit_status, 0);
  EXPECT_NE(read_text(file).find("\"machine\""), std::string::npos);
}

TEST(ProgramNew, RefusesWhatCouldNotBeRun) {
  const auto expect = [](const std::vector<std::string>& arguments, const std::string& hint) {
    const Outcome outcome = run_program(arguments);
    EXPECT_EQ(outcome.exit_status, 2);
    EXPECT_NE(outcome.err.find(hint), std::string::npos) << outcome.err;
  };
  expect({"new", temporary("arm")}, "must end in .json");
  EXPECT_FALSE(fs::exists(temporary("arm")));
  expect({"new"}, "needs the name of a file");
  expect({"new", temporary("a.json"), "--template", "pendulm"}, R"(did you mean "pendulum"?)");
  expect({"new", temporary("no/folder/a.json")}, "new: ");
}

TEST(ProgramSchema, IsThatOfTheSources) { EXPECT_EQ(run_program({"schema"}).out, read_text(kSchema)); }

}  // namespace
}  // namespace taut::testing::new_program_test
