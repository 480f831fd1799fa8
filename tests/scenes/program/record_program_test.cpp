#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "scenes/export/html_export.h"
#include "scenes/program/progress_bar.h"
#include "scenes/recording/recording_reader.h"
#include "tests/run_program.h"
#include "tests/temporary.h"

namespace taut::testing::record_program_test {
namespace {

using Words = std::vector<std::string>;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

Words joined(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// Whether pages can be made here at all: three.js is no package of Debian's.
bool has_three() {
  try {
    return !find_three().empty();
  } catch (const std::invalid_argument&) {
    return false;
  }
}
const char* const kNoThree = "three.js is missing (npm install --prefix scenes/export/viewer)";

const Words kShortRun{"run", "chain", "--set", "n=3", "--dt", "0.01", "--time", "0.5", "--quiet"};

TEST(RecordProgram, FramesComeAtTheRateAskedFor) {
  const std::string file = temporary("rate.taut");
  for (const auto& [rate, count] : {std::pair{"10", 6}, {"25", 14}, {"0", 51}, {"1000", 51}, {"0.5", 2}}) {
    ASSERT_EQ(run_program(joined(kShortRun, {"--record", file, "--frames-per-second", rate})).exit_status, 0);
    const RecordingReader reader(file);
    EXPECT_EQ(reader.frame_count(), count) << rate;
    EXPECT_EQ(reader.time(0), 0);
    EXPECT_NEAR(reader.time(count - 1), 0.5, 1e-12) << rate;  // the last instant is always there
    EXPECT_EQ(reader.damage(), "");
  }
  const Outcome bad = run_program(joined(kShortRun, {"--record", file, "--frames-per-second", "-1"}));
  EXPECT_EQ(bad.exit_status, 2);
  EXPECT_TRUE(contains(bad.err, "--frames-per-second")) << bad.err;
}

TEST(RecordProgram, ReplayMakesTheSameFilesAsTheRun) {
  if (!has_three()) GTEST_SKIP() << kNoThree;
  const Words from_run{"--html", temporary("a.html"), "--gltf", temporary("a.glb"),
                       "--plot", temporary("a.svg"),  "--vtk",  temporary("a_vtk")};
  const Words from_replay{"--html", temporary("b.html"), "--gltf", temporary("b.glb"),
                          "--plot", temporary("b.svg"),  "--vtk",  temporary("b_vtk")};
  const std::string recording = temporary("same.taut");
  const Outcome run = run_program(joined(joined(kShortRun, {"--record", recording}), from_run));
  ASSERT_EQ(run.exit_status, 0) << run.err;
  const Outcome replay = run_program(joined({"replay", recording, "--quiet"}, from_replay));
  ASSERT_EQ(replay.exit_status, 0) << replay.err;
  for (const char* name :
       {".html", ".glb", ".svg", "_vtk/bodies.pvd", "_vtk/joints_00003.vtp", "_vtk/names.csv"}) {
    const std::string first = read_text(temporary(std::string("a") + name));
    EXPECT_FALSE(first.empty()) << name;
    EXPECT_TRUE(first == read_text(temporary(std::string("b") + name))) << name;
  }
}

// One page that needs nothing from anywhere.
TEST(RecordProgram, ThePageRefersToNothingOutside) {
  if (!has_three()) GTEST_SKIP() << kNoThree;
  const std::string file = temporary("alone.html");
  ASSERT_EQ(run_program(joined(kShortRun, {"--html", file})).exit_status, 0);
  const std::string page = read_text(file);
  for (const char* part :
       {"<script src", "<link rel=\"stylesheet\"", "@import", "src=\"http", "href=\"http", "{{"})
    EXPECT_FALSE(contains(page, part)) << part;
  EXPECT_TRUE(contains(page, "<title>chain</title>"));
}

TEST(RecordProgram, WithoutThreeThePageIsRefusedAndAllElseWorks) {
  ASSERT_EQ(setenv("TAUT_THREE", "/no/such/folder", 1), 0);
  const Outcome page = run_program(joined(kShortRun, {"--html", temporary("none.html")}));
  const Outcome rest =
      run_program(joined(kShortRun, {"--gltf", temporary("none.glb"), "--plot", temporary("none.svg")}));
  unsetenv("TAUT_THREE");
  EXPECT_EQ(page.exit_status, 2);
  EXPECT_TRUE(contains(page.err, "three.js") && contains(page.err, "npm install") &&
              contains(page.err, "/no/such/folder"))
      << page.err;
  EXPECT_FALSE(std::filesystem::exists(temporary("none.html")));
  EXPECT_EQ(rest.exit_status, 0) << rest.err;
}

TEST(RecordProgram, CtrlCLeavesAWholeRecordingAndItsPage) {
  if (!has_three()) GTEST_SKIP() << kNoThree;
  const std::string recording = temporary("stopped.taut"), page = temporary("stopped.html");
  const std::string report = temporary("stopped.json");
  const Outcome run = run_program({"run", "chain", "--set", "n=50", "--time", "10000", "--record", recording,
                                   "--html", page, "--report", report, "--frames-per-second", "20"},
                                  recording);
  EXPECT_EQ(run.exit_status, 130) << run.err;
  RecordingReader reader(recording);
  EXPECT_EQ(reader.damage(), "");
  ASSERT_TRUE(reader.end());
  EXPECT_EQ(reader.end()->status, "interrupted");
  ASSERT_GT(reader.frame_count(), 1);
  EXPECT_EQ(nlohmann::json::parse(read_text(report))["final_time_s"], reader.time(reader.frame_count() - 1));
  EXPECT_TRUE(contains(read_text(page), "</html>"));
}

TEST(RecordProgram, AFullDiskIsSaidAndTheRunGoesOn) {
  const std::string report = temporary("full.json");
  const Outcome run = run_program(joined(kShortRun, {"--record", "/dev/full", "--report", report}));
  EXPECT_EQ(run.exit_status, 1);
  EXPECT_TRUE(contains(run.err, "/dev/full: No space left on device; it is cut short after 0 frames"))
      << run.err;
  const auto json = nlohmann::json::parse(read_text(report));
  EXPECT_EQ(json["status"], "success");
  EXPECT_EQ(json["steps"], 50);
  EXPECT_TRUE(contains(json["warnings"].dump(), "No space left on device"));
}

TEST(RecordProgram, AFullDiskIsSaidOfEveryExport) {
  for (const std::string option : {"--html", "--gltf", "--plot"}) {
    if (option == "--html" && !has_three()) continue;
    const Outcome run = run_program(joined(kShortRun, {option, "/dev/full"}));
    EXPECT_EQ(run.exit_status, 1) << option;
    EXPECT_TRUE(contains(run.err, "could not write /dev/full")) << option << ": " << run.err;
  }
}

// Nothing can be caught; the recording has what was at most a second old.
TEST(RecordProgram, AKilledRunLeavesAReadableRecording) {
  const std::string recording = temporary("killed.taut"), csv = temporary("killed.csv");
  const Outcome run = run_program({"run", "chain", "--set", "n=50", "--time", "10000", "--record", recording,
                                   "--frames-per-second", "0", "--quiet"},
                                  recording, SIGKILL, std::chrono::milliseconds(1500));
  EXPECT_EQ(run.exit_status, 128 + SIGKILL);
  RecordingReader reader(recording);
  EXPECT_FALSE(reader.end());
  EXPECT_NE(reader.damage(), "");
  ASSERT_GT(reader.frame_count(), 10);
  EXPECT_EQ(reader.frame(reader.frame_count() - 1).poses.size(), 51u);
  const Outcome replay = run_program({"replay", recording, "--csv", csv});
  EXPECT_EQ(replay.exit_status, 1);
  EXPECT_TRUE(contains(replay.err, "cut short") || contains(replay.err, "end")) << replay.err;
  const std::string table = read_text(csv);
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), reader.frame_count() + 1);
}

TEST(RecordProgram, OutputsThatCannotBeWrittenAreRefusedBeforeTheRun) {
  for (const std::string option : {"--record", "--html", "--gltf", "--plot"}) {
    if (option == "--html" && !has_three()) continue;
    const Outcome run = run_program({"run", "chain", "--time", "1e6", option, "/no/such/folder/file"});
    EXPECT_EQ(run.exit_status, 2) << option;
    EXPECT_TRUE(contains(run.err, option) && contains(run.err, "/no/such/folder/file")) << run.err;
  }
  write_text(temporary("a_file"), "");
  const Outcome vtk =
      run_program({"run", "chain", "--time", "1e6", "--vtk", temporary("a_file") + "/folder"});
  EXPECT_EQ(vtk.exit_status, 2);
  EXPECT_TRUE(contains(vtk.err, "--vtk")) << vtk.err;
  const Outcome twice =
      run_program({"run", "chain", "--time", "1e6", "--html", temporary("x"), "--gltf", temporary("x")});
  EXPECT_EQ(twice.exit_status, 2);
  EXPECT_TRUE(contains(twice.err, "--gltf: must not be the file of --html")) << twice.err;
}

TEST(RecordProgram, ADamagedRecordingIsSaidAndShownAsFarAsItGoes) {
  const std::string whole = temporary("w.taut"), cut = temporary("c.taut"), csv = temporary("c.csv");
  ASSERT_EQ(run_program(joined(kShortRun, {"--record", whole, "--frames-per-second", "0"})).exit_status, 0);
  const std::string bytes = read_text(whole);
  write_text(cut, bytes.substr(0, bytes.rfind("tCHKDONE") + 10));
  const Outcome replay = run_program({"replay", cut, "--csv", csv});
  EXPECT_EQ(replay.exit_status, 1);
  EXPECT_TRUE(contains(replay.err, "cut short")) << replay.err;
  const std::string table = read_text(csv);
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 52);
  EXPECT_EQ(table.substr(0, table.find('\n')),
            "time,kinetic energy,potential energy,gap,gap angle,probe.x,probe.y,probe.z");

  write_text(cut, bytes.substr(0, 40));
  const Outcome nothing = run_program({"replay", cut, "--csv", csv});
  EXPECT_EQ(nothing.exit_status, 2);
  EXPECT_TRUE(contains(nothing.err, "header")) << nothing.err;
}

TEST(ProgressLine, ShowsSimulatedTimeRateRemainingTimeAndGap) {
  EXPECT_EQ(progress_line(120, 240, 0.01, 0.5, {3.14e-11, 0}),
            "[##########..........]  50 %  t = 1.2 s  240 steps/s  0:01 left  gap 3.1e-11 m");
  EXPECT_EQ(progress_line(0, 10, 0.01, 0, {0, 0}),
            "[....................]   0 %  t = 0 s  0 steps/s  gap 0.0e+00 m");
  EXPECT_TRUE(
      contains(progress_line(1, 7300, 1, 1, {1e-9, 2e-10}), "2:01:39 left  gap 1.0e-09 m 2.0e-10 rad"));
}

TEST(RecordProgram, OfTwoRecordingsThereIsAPageAndNothingElse) {
  const std::string a = temporary("two_a.taut"), b = temporary("two_b.taut"), page = temporary("two.html");
  ASSERT_EQ(run_program(joined(kShortRun, {"--record", a})).exit_status, 0);
  ASSERT_EQ(
      run_program({"run", "net", "--set", "n=3", "--time", "0.1", "--quiet", "--record", b}).exit_status, 0);
  const Outcome both = run_program({"replay", a, b});
  EXPECT_EQ(both.exit_status, 0);
  EXPECT_TRUE(contains(both.out, "chain n=3") && contains(both.out, "net")) << both.out;
  for (const char* option : {"--gltf", "--plot", "--csv", "--vtk"}) {
    const std::string file = temporary("two.out");
    const Outcome other = run_program({"replay", a, b, option, file});
    EXPECT_EQ(other.exit_status, 2) << option;
    EXPECT_TRUE(contains(other.err, option)) << other.err;
    EXPECT_FALSE(std::filesystem::exists(file));
  }
  EXPECT_EQ(run_program({"replay", a, temporary("nowhere.taut")}).exit_status, 2);
  EXPECT_EQ(run_program({"replay", a, b, "--html", b}).exit_status, 2);
  if (!has_three()) GTEST_SKIP() << kNoThree;
  ASSERT_EQ(run_program({"replay", a, b, "--html", page, "--quiet"}).exit_status, 0);
  RecordingReader first(a), second(b);
  EXPECT_EQ(read_text(page), html_page(first, &second).text);
  EXPECT_NE(read_text(page), html_page(first).text);
  // A second one that was cut short is shown as far as it goes.
  std::filesystem::resize_file(b, std::filesystem::file_size(b) - 30);
  const Outcome cut = run_program({"replay", a, b, "--html", page});
  EXPECT_EQ(cut.exit_status, 1);
  EXPECT_TRUE(contains(cut.err, "two_b.taut")) << cut.err;
  EXPECT_TRUE(contains(read_text(page), "id=\"second\""));
}

}  // namespace
}  // namespace taut::testing::record_program_test
