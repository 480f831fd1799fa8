#include <gtest/gtest.h>

#include <regex>
#include <sstream>

#include "tests/run_program.h"
#include "tests/source_dir.h"
#include "tests/temporary.h"

namespace taut::testing::readme_test {
namespace {

TEST(Readme, ItsExampleIsTheProgramOfTheOutsideProject) {
  const std::string example = read_text(testing::source_dir() + "/tests/outside/bridge.cpp");
  ASSERT_FALSE(example.empty());
  EXPECT_NE(read_text(testing::source_dir() + "/README.md").find("```cpp\n" + example + "```\n"),
            std::string::npos)
      << "README.md must contain tests/outside/bridge.cpp to the letter";
}

/// Numbers as #: they are those of another machine.
std::string without_numbers(const std::string& text) {
  return std::regex_replace(text, std::regex(R"(-?\d+(\.\d+)?(e[-+]\d+)?)"), "#");
}

TEST(Readme, ItShowsWhatTheFirstCommandPrints) {
  const Outcome run = run_program({"run", "bridge"});
  ASSERT_EQ(run.exit_status, 0) << run.err;
  std::string shown;
  std::istringstream in(run.out);
  // It is called ./taut there.
  const std::regex called(R"(^(to see it +)\S*taut )");
  for (std::string line; std::getline(in, line);)
    shown += "    " + std::regex_replace(line, called, "$1./taut ") + "\n";
  EXPECT_NE(without_numbers(read_text(source_dir() + "/README.md")).find(without_numbers(shown)),
            std::string::npos)
      << "README.md must show the output of `taut run bridge`, with other numbers at most:\n"
      << run.out;
}

}  // namespace
}  // namespace taut::testing::readme_test
