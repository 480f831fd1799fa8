#include "scenes/support/suggestion.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "scenes/support/temporary_folder.h"

namespace taut::suggestion_test {
namespace {

TEST(Suggestion, NamesTheNearestOfFew) {
  const std::vector<std::string> names{"bridge", "bridge-hinge", "run", "N", "hinge"};
  for (const auto& [given, meant] : std::vector<std::pair<std::string, std::string>>{
           {"brigde", "bridge"},  // two letters exchanged are one slip
           {"birdge", "bridge"},
           {"brige", "bridge"},
           {"bridgge", "bridge"},
           {"rnu", "run"},
           {"ruun", "run"},
           {"Hinge", "hinge"},
           {"HINGE", "hinge"},
           {"n", "N"},
           {"bridge_hinge", "bridge-hinge"}})
    EXPECT_EQ(did_you_mean(given, names), "; did you mean \"" + meant + "\"?") << given;
  for (const char* given : {"", "x", "rope", "arm", "hngggge", "bridge over the river"})
    EXPECT_EQ(did_you_mean(given, names), "") << given;
  EXPECT_EQ(did_you_mean(std::string(65, 'a'), {std::string(65, 'a')}), "");  // too long to be compared
}

TEST(Suggestion, NamesFilesOfTheSameFolder) {
  const TemporaryFolder folder("suggestion");
  std::filesystem::create_directory(folder.path() / "arms.json");  // a folder is no file
  std::ofstream(folder.path() / "arm.json") << "{}";
  EXPECT_EQ(did_you_mean_file(folder.path() / "amr.json"),
            "; did you mean \"" + (folder.path() / "arm.json").string() + "\"?");
  EXPECT_EQ(did_you_mean_file(folder.path() / "arm.json"), "");
  EXPECT_EQ(did_you_mean_file(folder.path() / "leg.json"), "");
  EXPECT_EQ(did_you_mean_file(folder.path() / "nowhere" / "arm.json"), "");
}

}  // namespace
}  // namespace taut::suggestion_test
