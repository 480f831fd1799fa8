#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "scenes/files/friction_file.h"
#include "scenes/program/live_server.h"
#include "solvers/linear/cholmod_factor.h"
#include "tests/run_program.h"
#include "tests/sanitized.h"
#include "tests/scenes/program/resource_limit.h"
#include "tests/source_dir.h"
#include "tests/temporary.h"

namespace taut::testing::program_test {
namespace {

using Json = nlohmann::json;

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> found;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) found.push_back(line);
  return found;
}

/// The report without what is measured with a clock.
Json without_times(Json report) {
  for (const char* key : {"wall_time_s", "time_per_step_s", "phases"}) report.erase(key);
  return report;
}

TEST(Program, ListNamesScenesWithParametersDefaultsAndUnits) {
  const Outcome all = run_program({"list"});
  EXPECT_EQ(all.exit_status, 0);
  const std::vector<std::string> shown = lines(all.out);
  for (const char* name :
       {"pendulum-ball", "chain", "bridge-hinge", "bridge", "net-flag", "net-corners", "net"})
    EXPECT_EQ(std::count(shown.begin(), shown.end(), name), 1) << name;
  EXPECT_NE(all.out.find("n=200"), std::string::npos);
  EXPECT_NE(all.out.find("integer"), std::string::npos);

  const Outcome one = run_program({"list", "bridge"});
  EXPECT_EQ(one.exit_status, 0);
  EXPECT_EQ(lines(one.out).front(), "bridge");
  EXPECT_NE(one.out.find("truck=true"), std::string::npos);
}

TEST(Program, CheckCountsFreedomsAndNamesRedundantRows) {
  const Outcome hinges = run_program({"check", "bridge-hinge", "--set", "n=10"});
  EXPECT_EQ(hinges.exit_status, 0) << hinges.err;  // redundancy is no error
  // 11 hinges of 5 rows; the motion left is planar with n − 2 freedoms.
  for (const char* line :
       {"constraint rows 55\n", "rank            52\n", "freedoms        8\n", "redundant rows  3\n"})
    EXPECT_NE(hinges.out.find(line), std::string::npos) << line << hinges.out;
  EXPECT_NE(hinges.out.find("seam_"), std::string::npos);

  const Outcome balls = run_program({"check", "bridge-balls", "--set", "n=50"});
  EXPECT_EQ(balls.exit_status, 0);
  EXPECT_NE(balls.out.find("redundant rows  54\n"), std::string::npos) << balls.out;  // n + 4
  EXPECT_NE(balls.out.find("and 34 more, which"), std::string::npos) << balls.out;    // twenty are named
  const Outcome all = run_program({"check", "bridge-balls", "--set", "n=50", "--all"});
  int named = 0;
  for (std::size_t at = 0; (at = all.out.find("is already held by", at)) != std::string::npos; ++at) ++named;
  EXPECT_EQ(named, 54);
}

/// A driver that turns an arm into a limit, from the start or on the way.
TEST(Program, NamesWhatCannotHoldTogether) {
  const std::string file = temporary("arm.json"), report_file = temporary("arm_report.json");
  for (const char* start : {"0.2", "0.35"}) {
    write_text(file, R"({"format": "taut-scene/1", "name": "arm", "dt": 0.01, "duration": 1,
      "bodies": [{"name": "arm", "density": 1000, "shape": {"type": "box", "size": [1, 0.1, 0.1]}}],
      "joints": [
        {"name": "elbow", "type": "hinge", "a": "ground", "b": "arm", "anchor": [0, 0, 0], "axis": [0, 1, 0],
         "axes": {"angle": {"limits": {"lower": -1, "upper": 0.3}}}},
        {"name": "crank", "type": "driver", "of": {"joint": "elbow", "axis": "angle"},
         "motion": {"linear": {"value": )" +
                         std::string(start) + R"(, "rate": 1}}}], "assemble": true})");
    const std::string members = "driver crank, upper limit of hinge elbow angle";
    const bool at_once = start == std::string("0.35");
    const Outcome check = run_program({"check", file});
    EXPECT_EQ(check.exit_status, at_once ? 1 : 0) << check.out << check.err;
    EXPECT_EQ(check.out.find(members) != std::string::npos, at_once) << check.out;
    const Outcome run = run_program({"run", file, "--report", report_file});
    EXPECT_EQ(run.exit_status, 1) << run.err;
    EXPECT_NE(run.out.find("cannot hold together  " + members), std::string::npos) << run.out;
    EXPECT_NE(run.err.find(members), std::string::npos) << run.err;
    const Json report = Json::parse(read_text(report_file));
    EXPECT_EQ(report["status"], "contradiction");
    EXPECT_EQ(report["contradiction"]["members"], Json({"driver crank", "upper limit of hinge elbow angle"}));
    EXPECT_GT(report["contradiction"]["residual"], 1e-4);
  }
}

TEST(Program, CheckNamesReactionsThatAreNotUnique) {
  const Outcome check = run_program({"check", testing::source_dir() + "/scenes/examples/bricard.json"});
  EXPECT_EQ(check.exit_status, 0);
  EXPECT_NE(check.out.find("is already held by"), std::string::npos) << check.out;
  EXPECT_NE(check.out.find("not unique, of 6 joints: P0, P1, P2, P3, P4, P5\n"), std::string::npos)
      << check.out;
}

/// A door on two hinges, of which the second holds what the first one holds.
TEST(Program, ReportsWhoHoldsRedundantRows) {
  const std::string file = temporary("door.json"), report_file = temporary("door_report.json");
  write_text(file,
             R"({"format": "taut-scene/1", "dt": 0.01, "duration": 0.02, "settings": {"report_rank": true},
    "bodies": [{"name": "door", "mass": 1, "inertia": [1, 1, 1], "position": [0.4, 0, 0]}],
    "joints": [
      {"name": "low", "type": "hinge", "a": "ground", "b": "door", "anchor": [0, 0, -1], "axis": [0, 0, 1]},
      {"name": "high", "type": "hinge", "a": "ground", "b": "door", "anchor": [0, 0, 1], "axis": [0, 0, 1]}]})");
  ASSERT_EQ(run_program({"run", file, "--report", report_file, "--quiet"}).exit_status, 0);
  const Json report = Json::parse(read_text(report_file)), held = report["rows_already_held"];
  EXPECT_EQ(report["reactions_not_unique"], Json({"low", "high"}));
  ASSERT_EQ(held.size(), 5u);
  for (const Json& row : held) {
    EXPECT_EQ(row["row"].get<std::string>().find("hinge high: "), 0u) << row;
    EXPECT_EQ(row["held_by"], Json::array({"low"})) << row;
  }
}

TEST(Program, NamesAxesThatStartBeyondTheirLimits) {
  const std::string file = temporary("beyond.json"), report_file = temporary("beyond_report.json");
  write_text(file, R"({"format": "taut-scene/1", "dt": 0.01, "duration": 0.02,
    "bodies": [{"name": "arm", "mass": 1, "inertia": [1, 1, 1]}],
    "joints": [{"name": "elbow", "type": "hinge", "a": "ground", "b": "arm", "anchor": [0, 0, 0],
      "axis": [0, 0, 1], "axes": {"angle": {"limits": {"lower": 0.25, "upper": 1}}}}]})");
  const std::string named = "hinge elbow: axis angle starts at 0, below its lower limit 0.25";
  const Outcome check = run_program({"check", file});
  EXPECT_EQ(check.exit_status, 1) << check.err;
  EXPECT_NE(check.out.find("problem: " + named), std::string::npos) << check.out;
  const Outcome run = run_program({"run", file, "--report", report_file});
  EXPECT_EQ(run.exit_status, 0) << run.err;
  EXPECT_NE(run.out.find(named), std::string::npos) << run.out;
  EXPECT_EQ(Json::parse(read_text(report_file))["warnings"][0], named);
}

/// A wheel whose engine's torque falls linearly to 0 at 20 rad/s, I ω̇ = 1 − ω/20, with what its axis tells.
TEST(Program, AnEngineFollowsItsTableFromAFile) {
  const std::string file = temporary("engine.json"), report_file = temporary("engine_report.json");
  write_text(file, R"({"format": "taut-scene/1", "dt": 0.001, "duration": 0.5, "gravity": [0, 0, 0],
    "bodies": [{"name": "wheel", "mass": 1, "inertia": [0.06, 0.06, 0.06]}],
    "joints": [{"name": "axle", "type": "hinge", "a": "ground", "b": "wheel", "anchor": [0, 0, 0], "axis": [0, 0, 1],
      "axes": {"angle": {"motor": {"velocity": 100, "force_of_speed": [[0, 1], [20, 0]]}}}}],
    "probes": [{"name": "angle", "quantity": "axis", "axis": {"joint": "axle", "axis": "angle"}},
      {"name": "torque", "quantity": "axis-force", "axis": {"joint": "axle", "axis": "angle"}},
      {"name": "power", "quantity": "axis-power", "axis": {"joint": "axle", "axis": "angle"}},
      {"name": "state", "quantity": "axis-state", "axis": {"joint": "axle", "axis": "angle"}}]})");
  ASSERT_EQ(run_program({"run", file, "--report", report_file, "--quiet"}).exit_status, 0);
  const Json report = Json::parse(read_text(report_file)), &probes = report["probes"];
  const double rate = 20 * (1 - std::exp(-0.5 / (20 * 0.06))), torque = 1 - rate / 20;
  EXPECT_NEAR(probes[0]["final"]["rate"].get<double>(), rate, 2e-5);
  EXPECT_NEAR(probes[1]["final"]["motor"].get<double>(), torque, 1e-3);  // the mean of a step
  EXPECT_NEAR(probes[2]["final"]["motor"].get<double>(), torque * rate, 1e-2);
  EXPECT_EQ(probes[3]["final"], (Json{{"stuck", 0.0}, {"saturated", 1.0}, {"at_limit", 0.0}}));
  // All that the wheel has is the motor's work.
  EXPECT_NEAR(report["energy"]["ledger"]["motors"].get<double>(), 0.5 * 0.06 * rate * rate, 1e-5);
  EXPECT_LT(report["energy"]["max_ledger_error"].get<double>(), 1e-14);
}

TEST(Program, ReportsWhatBroke) {
  const std::string report_file = temporary("bridge.json");
  const Outcome run = run_program({"run", "suspension-bridge", "--report", report_file});
  EXPECT_EQ(run.exit_status, 0) << run.err;
  EXPECT_NE(run.out.find("broken joints"), std::string::npos) << run.out;
  const Json breaks = Json::parse(read_text(report_file))["breaks"];
  ASSERT_GE(breaks.size(), 3u);
  for (const Json& event : breaks) {
    EXPECT_EQ(event["joint"].get<std::string>().substr(0, 7), "hanger_");
    EXPECT_GT(event["force_N"].get<double>(), 2.1 * 400 * 9.81);
    EXPECT_TRUE(event["with"].is_null());
  }
}

/// 1e308 rad/s: after two seconds the angle is no number that a computer has.
TEST(Program, ADriverThatIsNotFiniteAtSomeTimeEndsInAStatus) {
  const std::string file = temporary("driver.json"), report_file = temporary("driver_report.json");
  write_text(file, R"({"format": "taut-scene/1", "dt": 0.1, "duration": 1, "gravity": [0, 0, 0],
    "bodies": [{"name": "wheel", "mass": 1, "inertia": [1, 1, 1]}],
    "joints": [
      {"name": "axle", "type": "slider", "a": "ground", "b": "wheel", "anchor": [0, 0, 0], "axis": [0, 0, 1]},
      {"name": "drive", "type": "driver", "of": {"joint": "axle", "axis": "displacement"},
       "motion": {"speeds": [[0, 0], [0.3, 0], [0.4, 1e308], [50, 1e308]]}}]})");
  const Outcome run = run_program({"run", file, "--report", report_file, "--quiet"});
  EXPECT_EQ(run.exit_status, 1) << run.out << run.err;
  const Json report = Json::parse(read_text(report_file));
  EXPECT_NE(report["status"], "success");
  EXPECT_LE(report["final_time_s"].get<double>(), 0.4);
}

TEST(Program, RunWritesReportAndCsv) {
  const std::string report_file = temporary("r.json"), csv_file = temporary("r.csv");
  const Outcome run = run_program({"run", "chain", "--set", "n=10", "--dt", "0.001", "--time", "0.02",
                                   "--report", report_file, "--csv", csv_file});
  ASSERT_EQ(run.exit_status, 0) << run.err;
  EXPECT_EQ(run.err, "");  // no progress bar without a terminal
  EXPECT_NE(run.out.find("joint error"), std::string::npos);

  const Json report = Json::parse(read_text(report_file));
  for (const char* key : {"scene",
                          "parameters",
                          "bodies",
                          "joints",
                          "constraint_rows",
                          "dt",
                          "steps",
                          "simulated_time_s",
                          "wall_time_s",
                          "time_per_step_s",
                          "phases",
                          "analyses",
                          "factorizations",
                          "backsolves",
                          "newton_iterations",
                          "substeps",
                          "max_joint_error_m",
                          "max_joint_angle_error_rad",
                          "max_joint_velocity_error",
                          "energy",
                          "status",
                          "warnings",
                          "probes"})
    EXPECT_TRUE(report.contains(key)) << key;
  EXPECT_EQ(report["scene"], "chain");
  EXPECT_EQ(report["parameters"]["n"], 10);
  EXPECT_EQ(report["bodies"], 10);
  EXPECT_EQ(report["joints"], 10);
  EXPECT_EQ(report["constraint_rows"], 30);
  EXPECT_EQ(report["dt"], 0.001);
  EXPECT_EQ(report["steps"], 20);
  EXPECT_NEAR(report["simulated_time_s"], 0.02, 1e-15);
  EXPECT_EQ(report["status"], "success");
  EXPECT_LT(report["max_joint_error_m"], 1e-9);
  EXPECT_GT(report["time_per_step_s"]["median"], 0);
  EXPECT_GE(report["time_per_step_s"]["p95"], report["time_per_step_s"]["median"]);
  EXPECT_NEAR(report["energy"]["scale"], 4.905, 1e-12);
  EXPECT_NEAR(report["energy"]["final"], report["energy"]["initial"], 1e-3);

  const std::vector<std::string> csv = lines(read_text(csv_file));
  ASSERT_EQ(csv.size(), 1 + 1 + 20);  // header, start, steps
  EXPECT_EQ(csv[0], "time,probe.x,probe.y,probe.z");
  for (const std::string& line : csv) EXPECT_EQ(std::count(line.begin(), line.end(), ','), 3) << line;
  // The report ends where the CSV does.
  EXPECT_EQ(csv.back().substr(csv.back().rfind(',') + 1), report["probes"][0]["final"]["z"].dump());
}

TEST(Program, StepsAreRoundedFromTheTime) {
  const std::string report = temporary("rounded.json");
  for (const auto& [time, steps] : {std::pair{"0.0249", 2}, {"0.0251", 3}}) {
    ASSERT_EQ(
        run_program({"run", "chain", "--set", "n=2", "--dt", "0.01", "--time", time, "--report", report})
            .exit_status,
        0);
    EXPECT_EQ(Json::parse(read_text(report))["steps"], steps) << time;
  }
}

TEST(Program, QuietPrintsNothing) {
  const Outcome run = run_program({"run", "chain", "--set", "n=2", "--steps", "3", "--quiet"});
  EXPECT_EQ(run.exit_status, 0);
  EXPECT_EQ(run.out + run.err, "");
}

TEST(Program, EveryIntegratorRuns) {
  for (const char* integrator :
       {"rattle", "rattle4", "rattle6", "rattle8", "force-euler", "force-runge-kutta", "moreau-jean",
        "recursive", "recursive-midpoint", "lagrangian", "lagrangian-midpoint"}) {
    const std::string report = temporary("integrator.json");
    const Outcome run = run_program({"run", "pendulum-hinge", "--dt", "0.001", "--steps", "10",
                                     "--integrator", integrator, "--report", report});
    EXPECT_EQ(run.exit_status, 0) << integrator << run.err;
    EXPECT_EQ(Json::parse(read_text(report))["integrator"], integrator);
  }
}

TEST(Program, PosesOfAllBodiesAreWrittenAtIntervals) {
  const std::string file = temporary("poses.csv");
  ASSERT_EQ(run_program({"run", "chain", "--set", "n=3", "--dt", "0.01", "--steps", "10", "--poses", file,
                         "--poses-interval", "0.05"})
                .exit_status,
            0);
  const std::vector<std::string> poses = lines(read_text(file));
  EXPECT_EQ(poses[0], "time,body,px,py,pz,qw,qx,qy,qz");
  EXPECT_EQ(poses.size(), 1 + 3 * 3);  // 0, 0.05 and 0.1 s
}

TEST(Program, SameInputSameBits) {
  Json reports[2];
  std::string csv[2];
  for (int i = 0; i < 2; ++i) {
    const std::string report_file = temporary("bits.json"), csv_file = temporary("bits.csv");
    ASSERT_EQ(run_program({"run", "net-flag", "--set", "n=5", "--steps", "60", "--report", report_file,
                           "--csv", csv_file})
                  .exit_status,
              0);
    reports[i] = without_times(Json::parse(read_text(report_file)));
    csv[i] = read_text(csv_file);
  }
  EXPECT_EQ(reports[0], reports[1]);  // with the fingerprint of the final state
  EXPECT_EQ(csv[0], csv[1]);
  EXPECT_EQ(reports[0]["final_state_fingerprint"].get<std::string>().size(), 16);
}

TEST(Program, ANetOfFiftyThousandRodsRunsWithinFourGigabytes) {
  if (testing::sanitized()) GTEST_SKIP() << "checks take all addresses that there are";
  const std::string report = temporary("net.json");
  const std::vector<std::string> net{"run", "net-corners", "--set", "n=160", "--dt", "0.001", "--steps", "4"};
  {
    const ResourceLimit limit(RLIMIT_AS, 400'000'000);  // that it holds
    EXPECT_NE(run_program(net).exit_status, 0);
  }
  const ResourceLimit limit(RLIMIT_AS, 4'000'000'000);
  std::vector<std::string> words = net;
  words.insert(words.end(), {"--report", report});
  const Outcome run = run_program(words);
  ASSERT_EQ(run.exit_status, 0) << run.err;
  EXPECT_EQ(Json::parse(read_text(report))["bodies"], 50880);
}

TEST(Program, InterruptEndsTheRunWithTableAndReport) {
  const std::string report_file = temporary("interrupted.json");
  const std::string csv = temporary("interrupted.csv");  // there from the start
  const Outcome run = run_program(
      {"run", "chain", "--set", "n=50", "--time", "1000000", "--report", report_file, "--csv", csv}, csv);
  EXPECT_EQ(run.exit_status, 130);
  EXPECT_NE(run.out.find("interrupted"), std::string::npos);
  const Json report = Json::parse(read_text(report_file));
  EXPECT_EQ(report["status"], "interrupted");
  EXPECT_LT(report["steps"], report["steps_asked"]);
}

TEST(Program, NoOutputIsWrittenOverAnotherOrOverAnInput) {
  const std::string csv = temporary("a.csv"), folder = csv.substr(0, csv.rfind('/')),
                    scene = temporary("s.json"),
                    text = R"({"format": "taut-scene/1", "generate": [{"builder": "pendulum-ball"}]})",
                    state = temporary("s.state"), recording = temporary("r.taut");
  write_text(scene, text);
  ASSERT_EQ(run_program({"run", scene, "--steps", "2", "--save", state, "--record", recording}).exit_status,
            0);
  const auto refusal = [](std::vector<std::string> words) {
    const Outcome outcome = run_program(words);
    EXPECT_EQ(outcome.exit_status, 2);
    return outcome.err;
  };
  const auto expect = [](const std::string& message, const std::string& words) {
    EXPECT_NE(message.find(words), std::string::npos) << message;
  };
  expect(refusal({"run", "chain", "--steps", "2", "--csv", csv, "--poses", folder + "/./a.csv"}),
         "--poses: must not be the file of --csv");
  expect(refusal({"run", scene, "--steps", "2", "--report", scene}),
         "--report: must not be the file of the scene");
  expect(refusal({"run", scene, "--steps", "2", "--from", state, "--csv", state}),
         "--csv: must not be the file of --from");
  expect(refusal({"replay", recording, "--csv", recording}), "--csv: must not be the file of the recording");
  EXPECT_EQ(read_text(scene), text);
  // A state may be gone on from in place, and devices take everything.
  for (const auto& words : {std::vector<std::string>{"--from", state, "--save", state},
                            {"--csv", "/dev/null", "--report", "/dev/null"}}) {
    std::vector<std::string> all{"run", scene, "--steps", "2"};
    all.insert(all.end(), words.begin(), words.end());
    const Outcome outcome = run_program(all);
    EXPECT_EQ(outcome.exit_status, 0) << outcome.err;
  }
}

TEST(Program, OutputThatCannotBeWrittenToItsEndIsAFailure) {
  const Outcome run = run_program({"run", "chain", "--set", "n=2", "--steps", "3", "--csv", "/dev/full"});
  EXPECT_EQ(run.exit_status, 1);
  EXPECT_NE(run.err.find("/dev/full"), std::string::npos) << run.err;
}

/// The shell's > on a full disk: nothing of it may look like success.
TEST(Program, WhatCannotBePrintedIsAFailure) {
  const std::string recording = temporary("full.taut");
  ASSERT_EQ(
      run_program({"run", "pendulum-ball", "--steps", "2", "--record", recording, "--quiet"}).exit_status, 0);
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{"list"},
                                             {"check", "pendulum-ball"},
                                             {"run", "pendulum-ball", "--steps", "2"},
                                             {"replay", recording},
                                             {"--help"},
                                             {"run", "--help"},
                                             {"--version"}}) {
    const Outcome run = run_program_into("/dev/full", arguments);
    EXPECT_EQ(run.exit_status, 1) << arguments.front();
    EXPECT_NE(run.err.find("taut: cannot write to the standard output"), std::string::npos)
        << arguments.front() << run.err;
    EXPECT_EQ(run_program_into("/dev/null", arguments).exit_status, 0) << arguments.front();
  }
  EXPECT_EQ(run_program_into("/dev/full", {"run", "pendulum-ball", "--steps", "2", "--quiet"}).exit_status,
            0);
}

TEST(Program, VersionSaysWhatIsBuiltIn) {
  const Outcome version = run_program({"--version"});
  EXPECT_EQ(version.exit_status, 0) << version.err;
  EXPECT_EQ(version.out.substr(0, version.out.find('\n')), "taut " TAUT_VERSION);
  for (const char* part : {"models ", "contacts ", "solver ", "live view ", "HDF5 ", "pages ", "pictures "})
    EXPECT_NE(version.out.find(std::string("\n") + part), std::string::npos) << part << version.out;
  EXPECT_EQ(version.out.find("live view  not built in") == std::string::npos, serves_live()) << version.out;
  EXPECT_EQ(version.out.find("HDF5       not built in") == std::string::npos, reads_hdf5()) << version.out;
  EXPECT_NE(version.out.find(blas_name()), std::string::npos) << version.out;
}

/// Every mistake on the command line ends with status 2 and names the option and the value.
struct Mistake {
  const char* name;
  std::vector<std::string> arguments;
  std::vector<std::string> named;
};
std::ostream& operator<<(std::ostream& out, const Mistake& mistake) { return out << mistake.name; }

class ProgramUsage : public ::testing::TestWithParam<Mistake> {};

TEST_P(ProgramUsage, ExitsWithTwoAndNamesOptionAndValue) {
  const Outcome run = run_program(GetParam().arguments);
  EXPECT_EQ(run.exit_status, 2);
  EXPECT_EQ(run.out, "");
  for (const std::string& word : GetParam().named)
    EXPECT_NE(run.err.find(word), std::string::npos) << run.err;
}

INSTANTIATE_TEST_SUITE_P(
    Mistakes, ProgramUsage,
    ::testing::Values(
        Mistake{"nothing", {}, {"subcommand"}}, Mistake{"unknown_command", {"walk"}, {"walk"}},
        Mistake{"no_scene", {"run"}, {"scene"}},
        Mistake{"unknown_scene", {"run", "brigde"}, {"brigde", "did you mean \"bridge\"?"}},
        Mistake{"scene_like_no_other", {"run", "nonsense"}, {"nonsense", "bridge-hinge"}},
        Mistake{"unknown_scene_to_list", {"list", "brigde"}, {"brigde"}},
        Mistake{"unknown_scene_to_check", {"check", "brigde"}, {"brigde"}},
        Mistake{"unknown_option", {"run", "chain", "--fast"}, {"--fast"}},
        Mistake{"zero_dt", {"run", "chain", "--dt", "0"}, {"--dt", "0"}},
        Mistake{"negative_dt", {"run", "chain", "--dt", "-0.5"}, {"--dt", "-0.5"}},
        Mistake{"nan_dt", {"run", "chain", "--dt", "nan"}, {"--dt", "nan"}},
        Mistake{"infinite_dt", {"run", "chain", "--dt", "inf"}, {"--dt", "inf"}},
        Mistake{"word_dt", {"run", "chain", "--dt", "fast"}, {"--dt", "fast"}},
        Mistake{"negative_time", {"run", "chain", "--time", "-2"}, {"--time", "-2"}},
        Mistake{"nan_time", {"run", "chain", "--time", "nan"}, {"--time", "nan"}},
        Mistake{"time_below_one_step", {"run", "chain", "--time", "1e-9"}, {"--time", "1e-09"}},
        Mistake{"endless_time", {"run", "chain", "--time", "1e300"}, {"--time", "e+300"}},
        Mistake{"zero_steps", {"run", "chain", "--steps", "0"}, {"--steps", "0"}},
        Mistake{"half_steps", {"run", "chain", "--steps", "1.5"}, {"--steps", "1.5"}},
        Mistake{
            "steps_and_time", {"run", "chain", "--steps", "3", "--time", "1"}, {"--steps", "--time", "3"}},
        Mistake{"unknown_integrator",
                {"run", "chain", "--integrator", "euler"},
                {"--integrator", "euler", "rattle"}},
        Mistake{"unknown_key", {"run", "chain", "--set", "links=3"}, {"links"}},
        Mistake{"no_value", {"run", "chain", "--set", "n"}, {"--set", "n"}},
        Mistake{"word_value", {"run", "chain", "--set", "n=ten"}, {"--set", "n=ten"}},
        Mistake{"nan_value", {"run", "chain", "--set", "n=nan"}, {"--set", "n=nan"}},
        Mistake{"value_twice", {"run", "chain", "--set", "n=2", "--set", "n=3"}, {"--set", "n=3"}},
        Mistake{"value_out_of_range", {"run", "chain", "--set", "n=0"}, {"n", "0"}},
        Mistake{"fractional_count", {"run", "chain", "--set", "n=2.5"}, {"n", "2.5"}},
        Mistake{"unwritable_report",
                {"run", "chain", "--report", "/no/such/r.json"},
                {"--report", "/no/such/r.json"}},
        Mistake{"unwritable_csv", {"run", "chain", "--csv", "/no/such/r.csv"}, {"--csv", "/no/such/r.csv"}},
        Mistake{
            "unwritable_poses", {"run", "chain", "--poses", "/no/such/p.csv"}, {"--poses", "/no/such/p.csv"}},
        Mistake{"same_file_twice",
                {"run", "chain", "--report", "no_such_file", "--csv", "./no_such_file"},
                {"--report", "--csv", "no_such_file"}},
        Mistake{"missing_file", {"run", "no/such.json"}, {"no/such.json"}},
        Mistake{"parameters_of_a_file", {"run", "no/such.json", "--set", "n=3"}, {"--set", "no/such.json"}}),
    [](const auto& mistake) { return std::string(mistake.param.name); });

TEST(Program, ABadSceneFileIsRefusedWithThePlaceOfTheMistake) {
  const std::string file = temporary("bad.json");
  write_text(file, R"({"bodies": [{"name": "rod", "mass": -1}]})");
  for (const char* command : {"run", "check"}) {
    const Outcome run = run_program({command, file});
    EXPECT_EQ(run.exit_status, 2) << command;
    EXPECT_NE(run.err.find("bad.json"), std::string::npos) << run.err;
    EXPECT_NE(run.err.find("mass"), std::string::npos) << run.err;
  }
}

}  // namespace
}  // namespace taut::testing::program_test
