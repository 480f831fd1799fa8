#include "scenes/support/child_process.h"

#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include "scenes/support/program_path.h"
#include "scenes/support/temporary_folder.h"

namespace taut::child_process_test {
namespace {

namespace fs = std::filesystem;

/// Of the pipe by which its end is known the program has its own end alone: both have one name.
TEST(ChildProcess, InheritsNothingButItsOwnEnd) {
  if (!fs::exists("/proc/self/fd")) GTEST_SKIP() << "no list of what is open";
  const ChildResult result = run_child(
      "/bin/sh", {"-c", "readlink /proc/$$/fd/1; for f in /proc/$$/fd/*; do readlink $f; done; true"}, true,
      20);
  ASSERT_TRUE(result.good()) << result.message();
  std::istringstream lines(result.output);
  std::string own, line;
  std::getline(lines, own);
  ASSERT_TRUE(own.starts_with("pipe:")) << result.output;
  int ends = 0;
  while (std::getline(lines, line)) ends += line == own;
  EXPECT_EQ(ends, 1) << result.output;
}

TEST(ChildProcess, SaysHowItEnded) {
  EXPECT_EQ(run_child("/bin/sh", {"-c", "echo a; exit 3"}, true).message(), "exit status 3");
  EXPECT_EQ(run_child("/bin/sh", {"-c", "echo a"}, true).output, "a\n");
  EXPECT_EQ(run_child("/bin/sh", {"-c", "kill -9 $$"}).message(), "killed by signal 9");
  EXPECT_EQ(run_child("/bin/sh", {"-c", "exec sleep 30"}, false, 0.1).message(), "time limit");
  EXPECT_EQ(run_child("/no/such", {}).end, ChildResult::End::kNotStarted);
}

TEST(TemporaryFolder, IsOursAndGoesWithWhatIsInIt) {
  fs::path place;
  {
    const TemporaryFolder one("--test"), two("--test");
    place = one.path();
    EXPECT_NE(one.path(), two.path());
    EXPECT_EQ(fs::status(place).permissions(), fs::perms::owner_all);
    fs::create_directory(place / "inside");
  }
  EXPECT_FALSE(fs::exists(place));
  const std::string name = free_temporary_name("taut-test", ".txt"),
                    other = free_temporary_name("taut-test", ".txt");
  EXPECT_NE(name, other);
  EXPECT_TRUE(name.ends_with(".txt") && fs::file_size(name) == 0);
  EXPECT_EQ(fs::status(name).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  fs::remove(name), fs::remove(other);
}

TEST(ProgramPath, IsThatOfTheTests) { EXPECT_EQ(program_path().filename(), "scenes_tests"); }

}  // namespace
}  // namespace taut::child_process_test
