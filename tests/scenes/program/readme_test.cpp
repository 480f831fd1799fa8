#include <gtest/gtest.h>

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

}  // namespace
}  // namespace taut::testing::readme_test
