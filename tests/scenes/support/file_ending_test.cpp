#include "scenes/support/file_ending.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <stdexcept>

#include "tests/run_program.h"
#include "tests/temporary.h"

namespace taut::file_ending_test {
namespace {

bool takes(const std::string& file, FileKind kind) {
  try {
    require_ending("--option", file, kind);
    return true;
  } catch (const std::invalid_argument& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("--option"), std::string::npos) << message;
    EXPECT_NE(message.find("its file must end in ."), std::string::npos) << message;
    EXPECT_NE(message.find(file), std::string::npos) << message;
    return false;
  }
}

TEST(FileEnding, IsThatOfWhatIsWritten) {
  EXPECT_TRUE(takes("a.glb", FileKind::kAnimation));
  EXPECT_TRUE(takes("a.b.GLB", FileKind::kAnimation));
  EXPECT_FALSE(takes("a.txt", FileKind::kAnimation));
  EXPECT_FALSE(takes("a.gltf", FileKind::kAnimation));  // which is text
  EXPECT_FALSE(takes("a.anim", FileKind::kAnimation));
  EXPECT_FALSE(takes("page.svg", FileKind::kPage));
  EXPECT_FALSE(takes("curves.png", FileKind::kPicture));
  EXPECT_TRUE(takes("a.csv", FileKind::kTable));
  EXPECT_TRUE(takes("a.txt", FileKind::kTable));
  EXPECT_FALSE(takes("a.json", FileKind::kTable));
  EXPECT_FALSE(takes("a.csv", FileKind::kJson));
  EXPECT_TRUE(takes("a.state", FileKind::kJson));  // of no other kind
  EXPECT_FALSE(takes("a.html", FileKind::kRecording));
  for (const FileKind kind : {FileKind::kPage, FileKind::kAnimation, FileKind::kPicture, FileKind::kTable,
                              FileKind::kJson, FileKind::kRecording}) {
    EXPECT_TRUE(takes("", kind));
    EXPECT_TRUE(takes("run", kind));
    EXPECT_TRUE(takes("run.2/out", kind));
    EXPECT_TRUE(takes("/dev/null", kind));
  }
}

TEST(FileEnding, OfAFolderIsThatOfNoFile) {
  const auto refused = [](const std::string& folder) {
    try {
      require_folder_name("--vtk", folder);
      return false;
    } catch (const std::invalid_argument&) {
      return true;
    }
  };
  EXPECT_TRUE(refused("a.vtk"));
  EXPECT_TRUE(refused("a.pvd"));
  EXPECT_FALSE(refused("a"));
  EXPECT_FALSE(refused("run.2"));
  const std::string there = testing::temporary("folder.txt");
  std::filesystem::create_directory(there);
  EXPECT_FALSE(refused(there));
}

/// Before the run, and nothing is written.
TEST(FileEnding, TheProgramAsksForIt) {
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"--gltf", ".txt"}, {"--html", ".glb"},   {"--plot", ".html"},
      {"--vtk", ".vtk"},  {"--csv", ".json"},   {"--report", ".csv"},
      {"--save", ".svg"}, {"--poses", ".json"}, {"--record", ".json"}};
  for (const auto& [option, ending] : wrong) {
    const std::string file = testing::temporary("wrong" + ending);
    const testing::Outcome run = testing::run_program({"run", "chain", "--time", "1e6", option, file});
    EXPECT_EQ(run.exit_status, 2) << option;
    EXPECT_NE(run.err.find(option + ": writes "), std::string::npos) << run.err;
    EXPECT_FALSE(std::filesystem::exists(file)) << option;
  }
}

}  // namespace
}  // namespace taut::file_ending_test
