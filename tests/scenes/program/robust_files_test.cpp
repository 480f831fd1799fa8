#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "scenes/support/output_file.h"
#include "tests/run_program.h"
#include "tests/scenes/program/resource_limit.h"
#include "tests/temporary.h"

// What a user has on his disk is what he left there, but for the file that he asked for.
namespace taut::testing::robust_files_test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Words = std::vector<std::string>;

const Words kShortRun{"run", "chain", "--set", "n=3", "--dt", "0.01", "--time", "0.1", "--quiet"};
const char* const kOutputs[] = {"--save", "--report", "--csv", "--poses", "--record", "--gltf", "--plot"};

Words joined(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

struct stat status_of(const std::string& file) {
  struct stat status {};
  EXPECT_EQ(lstat(file.c_str(), &status), 0) << file;
  return status;
}

mode_t mode_of(const std::string& file) { return status_of(file).st_mode & 07777; }

/// The names in a fresh folder.
std::string fresh_folder(const std::string& name) {
  const std::string folder = temporary(name);
  fs::create_directory(folder);
  return folder;
}
std::vector<std::string> names_in(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

TEST(RobustFiles, ADeviceStaysADevice) {
  const std::string device = temporary("device");
  if (mknod(device.c_str(), S_IFCHR | 0666, makedev(1, 3)) != 0)
    GTEST_SKIP() << "needs the rights to make one";
  for (const char* option : kOutputs) {
    const Outcome run = run_program(joined(kShortRun, {option, device}));
    EXPECT_EQ(run.exit_status, 0) << option << ": " << run.err;
    EXPECT_TRUE(S_ISCHR(status_of(device).st_mode)) << option;
  }
}

TEST(RobustFiles, ALinkStaysALink) {
  for (const char* option : kOutputs) {
    const std::string folder = fresh_folder(std::string("links") + option), target = folder + "/there/target";
    fs::create_directory(folder + "/there");
    fs::create_symlink("there/target", folder + "/link");
    for (int round = 0; round < 2; ++round) {  // the first time it leads nowhere
      const Outcome run = run_program(joined(kShortRun, {option, folder + "/link"}));
      EXPECT_EQ(run.exit_status, 0) << option << ": " << run.err;
      EXPECT_TRUE(S_ISLNK(status_of(folder + "/link").st_mode)) << option;
      EXPECT_GT(status_of(target).st_size, 0) << option;
      fs::resize_file(target, 0);
    }
    EXPECT_EQ(names_in(folder + "/there"), Words{"target"}) << option;
  }
}

TEST(RobustFiles, ModesAreKept) {
  const mode_t mask = umask(027);
  for (const char* option : kOutputs) {
    const std::string secret = temporary(std::string("secret") + option),
                      fresh = temporary(std::string("fresh") + option);
    write_text(secret, "old");
    ASSERT_EQ(chmod(secret.c_str(), 0600), 0);
    EXPECT_EQ(run_program(joined(kShortRun, {option, secret})).exit_status, 0) << option;
    EXPECT_EQ(mode_of(secret), 0600u) << option;
    EXPECT_NE(read_text(secret), "old") << option;
    EXPECT_EQ(run_program(joined(kShortRun, {option, fresh})).exit_status, 0) << option;
    EXPECT_EQ(mode_of(fresh), 0640u) << option;
  }
  umask(mask);
}

TEST(RobustFiles, TheOwnerIsKept) {
  if (geteuid() != 0) GTEST_SKIP() << "needs the rights to give a file away";
  const std::string file = temporary("owned.json");
  write_text(file, "old");
  ASSERT_EQ(chown(file.c_str(), 12345, 54321), 0);
  ASSERT_EQ(chmod(file.c_str(), 0664), 0);
  EXPECT_EQ(write_output(file, "new"), "");
  EXPECT_EQ(read_text(file), "new");
  EXPECT_EQ(status_of(file).st_uid, 12345u);
  EXPECT_EQ(status_of(file).st_gid, 54321u);
  EXPECT_EQ(mode_of(file), 0664u);
}

TEST(RobustFiles, NamesOfOneFileStayNamesOfOneFile) {
  const std::string one = temporary("one.json"), other = temporary("other.json");
  write_text(one, "old");
  ASSERT_EQ(link(one.c_str(), other.c_str()), 0);
  EXPECT_EQ(run_program(joined(kShortRun, {"--save", one})).exit_status, 0);
  EXPECT_EQ(status_of(one).st_ino, status_of(other).st_ino);
  EXPECT_EQ(Json::parse(read_text(other))["format"], "taut-state/1");
  const Outcome both = run_program(joined(kShortRun, {"--save", one, "--report", other}));
  EXPECT_EQ(both.exit_status, 2);
  EXPECT_TRUE(contains(both.err, "--save") && contains(both.err, "--report")) << both.err;
}

TEST(RobustFiles, NoFileOfAnotherNameIsTouched) {
  const std::string folder = fresh_folder("beside");
  for (const char* name : {"/a.json.part", "/a.json~", "/a.json.tmp", "/.a.json"})
    write_text(folder + name, "mine");
  EXPECT_EQ(run_program(joined(kShortRun, {"--save", folder + "/a.json"})).exit_status, 0);
  for (const char* name : {"/a.json.part", "/a.json~", "/a.json.tmp", "/.a.json"})
    EXPECT_EQ(read_text(folder + name), "mine") << name;
  EXPECT_EQ(names_in(folder), (Words{".a.json", "a.json", "a.json.part", "a.json.tmp", "a.json~"}));
  const std::string recording = folder + "/a.json.part", state = folder + "/a.json";
  EXPECT_EQ(run_program(joined(kShortRun, {"--save", state, "--record", recording})).exit_status, 0);
  EXPECT_EQ(run_program({"replay", recording}).exit_status, 0);
  EXPECT_EQ(run_program(joined(kShortRun, {"--from", state})).exit_status, 0);
}

TEST(RobustFiles, WhatCannotBeWrittenIsSaidBeforeTheRun) {
  const std::string folder = fresh_folder("asked");
  write_text(folder + "/file", "a file");
  fs::create_symlink("round", folder + "/round");
  const std::string long_name(300, 'x');
  for (const char* option :
       {"--save", "--report", "--csv", "--poses", "--record", "--gltf", "--plot", "--html"})
    for (const std::string& place :
         {folder, folder + "/none/a", folder + "/file/a", folder + "/new/", folder + "/round",
          folder + "/" + long_name, std::string("/proc/none")}) {
      const Outcome run = run_program({"run", "chain", "--set", "n=3", "--time", "1e6", option, place});
      EXPECT_EQ(run.exit_status, 2) << option << ' ' << place;
      EXPECT_TRUE(contains(run.err, option) && contains(run.err, place)) << run.err;
    }
  EXPECT_EQ(names_in(folder), (Words{"file", "round"}));
  EXPECT_EQ(read_text(folder + "/file"), "a file");
}

TEST(RobustFiles, AFolderWithoutRightsIsSaidBeforeTheRun) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  const std::string folder = fresh_folder("locked");
  write_text(folder + "/mine", "old");
  write_text(folder + "/theirs", "old");
  chmod((folder + "/theirs").c_str(), 0400);
  chmod(folder.c_str(), 0500);
  for (const char* name : {"/new", "/theirs"})
    EXPECT_EQ(run_program({"run", "chain", "--time", "1e6", "--save", folder + name}).exit_status, 2) << name;
  EXPECT_EQ(write_output(folder + "/mine", "new"), "");  // it can be written, only not next to it
  EXPECT_EQ(read_text(folder + "/mine"), "new");
  chmod(folder.c_str(), 0700);
}

TEST(RobustFiles, AFifoIsWrittenThrough) {
  const std::string fifo = temporary("fifo");
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  for (const char* option : {"--save", "--report", "--csv"}) {
    std::string text;
    std::thread reader([&] { text = read_text(fifo); });
    EXPECT_EQ(run_program(joined(kShortRun, {option, fifo})).exit_status, 0) << option;
    reader.join();
    EXPECT_FALSE(text.empty()) << option;
    EXPECT_TRUE(S_ISFIFO(status_of(fifo).st_mode)) << option;
  }
}

TEST(RobustFiles, TheStandardOutputTakesTurns) {
  const std::string file = temporary("both.txt");
  const Outcome run = run_program_into(
      file, {"run", "chain", "--set", "n=3", "--dt", "0.01", "--time", "0.1", "--report", "/dev/stdout"});
  EXPECT_EQ(run.exit_status, 0) << run.err;
  const std::string text = read_text(file);
  const std::size_t table = text.find("\nscene ");
  ASSERT_NE(table, std::string::npos) << text;
  EXPECT_EQ(Json::parse(text.substr(0, table))["status"], "success");
}

TEST(RobustFiles, StandardStreamsThatAreClosedAreNoFiles) {
  for (const int closed : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    const std::string report = temporary("closed.json"), csv = temporary("closed.csv");
    const Outcome run = run_program_without(closed, {"run", "chain", "--set", "n=3", "--dt", "0.01", "--time",
                                                     "0.1", "--report", report, "--csv", csv});
    EXPECT_EQ(run.exit_status, closed == STDOUT_FILENO ? 1 : 0) << closed << run.err;
    EXPECT_EQ(Json::parse(read_text(report))["status"], "success") << closed;
    EXPECT_TRUE(read_text(csv).starts_with("time,")) << closed;
    EXPECT_FALSE(contains(read_text(csv), "simulated time")) << closed;
    EXPECT_EQ(contains(run.err, "standard output"), closed == STDOUT_FILENO) << run.err;
    const Outcome quiet = run_program_without(closed, joined(kShortRun, {"--report", report}));
    EXPECT_EQ(quiet.exit_status, 0) << closed << quiet.err;
  }
}

TEST(RobustFiles, AFullDiskLeavesTheOldFile) {
  const std::string folder = fresh_folder("full"), file = folder + "/a.json";
  write_text(file, "old");
  {
    const FileSizeLimit limit(100'000);
    EXPECT_TRUE(contains(write_output(file, std::string(200'000, 'x')), "a.json: File too large"));
    EXPECT_NE(write_output(folder + "/new", std::string(200'000, 'x')), "");
  }
  EXPECT_EQ(read_text(file), "old");
  EXPECT_EQ(names_in(folder), Words{"a.json"});
}

TEST(RobustFiles, ADeathInTheMiddleLeavesTheOldFile) {
  const std::string file = temporary("killed.json");
  write_text(file, "old");
  const pid_t child = fork();
  if (child == 0) {
    OutputFile output(file);
    output.out() << std::string(1'000'000, 'x') << std::flush;
    _exit(0);
  }
  waitpid(child, nullptr, 0);
  EXPECT_EQ(read_text(file), "old");
}

/// Of an export that could not be made, too.
TEST(RobustFiles, WhatWasNotFinishedHasNeverBeen) {
  const std::string folder = fresh_folder("unfinished");
  write_text(folder + "/old", "old");
  for (const char* name : {"/old", "/new"}) {
    OutputFile output(folder + name);
    output.out() << "half a pa";
  }
  EXPECT_EQ(read_text(folder + "/old"), "old");
  EXPECT_EQ(names_in(folder), Words{"old"});
}

TEST(RobustFiles, TheLastStateIsSavedElsewhere) {
  if (access("/dev/full", W_OK) != 0) GTEST_SKIP() << "no /dev/full";
  const std::string elsewhere = fresh_folder("elsewhere"), report = temporary("elsewhere.json");
  setenv("TMPDIR", elsewhere.c_str(), 1);
  const Outcome run = run_program(joined(kShortRun, {"--save", "/dev/full", "--report", report}));
  EXPECT_EQ(run.exit_status, 1);
  EXPECT_TRUE(contains(run.err, "/dev/full: No space left on device")) << run.err;
  const Words saved = names_in(elsewhere);
  ASSERT_EQ(saved.size(), 1u) << run.err;
  const std::string place = elsewhere + "/" + saved.front();
  EXPECT_TRUE(contains(run.err, "saved in " + place)) << run.err;
  EXPECT_TRUE(contains(Json::parse(read_text(report))["warnings"].dump(), place));
  EXPECT_EQ(run_program(joined(kShortRun, {"--from", place})).exit_status, 0);

  setenv("TMPDIR", temporary("nowhere").c_str(), 1);
  const Outcome lost = run_program(joined(kShortRun, {"--save", "/dev/full"}));
  unsetenv("TMPDIR");
  EXPECT_EQ(lost.exit_status, 1);
  EXPECT_TRUE(contains(lost.err, "nor could the state be saved")) << lost.err;
}

/// A wheel whose balls hang on it by next to no inertia: 1500 coupled rows, and many sub-steps to a step.
std::string hub_scene(int spokes) {
  Json bodies{
      {{"name", "hub"}, {"mass", 1000}, {"shape", {{"type", "cylinder"}, {"radius", 5}, {"length", 0.2}}}}};
  Json joints{{{"name", "hang"}, {"type", "ball"}, {"a", "ground"}, {"b", "hub"}, {"anchor", {0, 0, 0.1}}}};
  for (int i = 0; i < spokes; ++i) {
    const double angle = 2 * M_PI * i / spokes, x = 5 * std::cos(angle), y = 5 * std::sin(angle);
    const std::string ball = std::string("r").append(std::to_string(i));
    bodies.push_back({{"name", ball},
                      {"mass", 1},
                      {"shape", {{"type", "sphere"}, {"radius", 2e-5}}},
                      {"position", {x, y, -0.35}}});
    joints.push_back({{"name", std::string("b").append(std::to_string(i))},
                      {"type", "ball"},
                      {"a", "hub"},
                      {"b", ball},
                      {"anchor", {x, y, -0.1}}});
  }
  return Json{
      {"format", "taut-scene/1"}, {"dt", 0.01}, {"duration", 1}, {"bodies", bodies}, {"joints", joints}}
      .dump();
}

/// The first step would take a minute.
TEST(RobustFiles, ASignalEndsALongStep) {
  const std::string scene = temporary("hub.json"), report = temporary("hub_report.json"),
                    csv = temporary("hub.csv"), state = temporary("hub_state.json");
  write_text(scene, hub_scene(1000));
  const Outcome run = run_program(
      {"run", scene, "--report", report, "--csv", csv, "--save", state, "--threads", "1"}, csv, SIGTERM);
  EXPECT_EQ(run.exit_status, 128 + SIGTERM) << run.err;
  const Json json = Json::parse(read_text(report));
  EXPECT_EQ(json["status"], "interrupted");
  EXPECT_EQ(json["steps"], 0);
  EXPECT_EQ(json["final_time_s"], 0);
  EXPECT_EQ(Json::parse(read_text(state))["time"], 0);
}

/// Interrupts a run, goes on from what it has saved, and compares with one that was not interrupted.
void expect_goes_on_to_the_same_bits(const Words& run, std::chrono::milliseconds wait, long more) {
  const std::string state = temporary("stopped.json"), csv = temporary("stopped.csv"),
                    report = temporary("report.json");
  fs::remove(csv);
  const Outcome stopped =
      run_program(joined(run, {"--steps", "1000000000", "--csv", csv, "--save", state, "--report", report}),
                  csv, SIGINT, wait);
  ASSERT_EQ(stopped.exit_status, 130) << stopped.err;
  const long steps = Json::parse(read_text(report))["steps"];
  const auto last = [&](const Words& words) {
    EXPECT_EQ(run_program(joined(run, joined(words, {"--report", report}))).exit_status, 0);
    return Json::parse(read_text(report))["final_state_fingerprint"].get<std::string>();
  };
  EXPECT_EQ(last({"--from", state, "--steps", std::to_string(more)}),
            last({"--steps", std::to_string(steps + more)}))
      << "after " << steps << " steps";
}

TEST(RobustFiles, ARunThatWasStoppedGoesOnToTheSameBits) {
  using std::chrono::milliseconds;
  const Words pile{"run", "pile", "--set", "n=20", "--quiet"};
  expect_goes_on_to_the_same_bits(pile, milliseconds(500), 20);
  // Steps of about a second, which are given up, and not from before the first.
  const std::string scene = temporary("wheel.json");
  write_text(scene, hub_scene(150));
  expect_goes_on_to_the_same_bits({"run", scene, "--quiet"}, milliseconds(2500), 1);
}

}  // namespace
}  // namespace taut::testing::robust_files_test
