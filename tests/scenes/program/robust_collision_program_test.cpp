#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/run_program.h"
#include "tests/scenes/program/resource_limit.h"
#include "tests/source_dir.h"
#include "tests/temporary.h"

// What the program says where contacts cannot be had.
namespace taut::robust_collision_program_test {
namespace {

using Json = nlohmann::json;
using testing::Outcome;
using testing::read_text;
using testing::run_program;
using testing::temporary;
using testing::write_text;

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }
std::string adversary(const std::string& name) { return testing::source_dir() + "/tests/adversary/" + name; }

TEST(RobustReachProgram, APositionBeyondAllReasonIsRefusedByName) {
  for (const char* command : {"run", "check"}) {
    const Outcome outcome = run_program({command, adversary("fcl_segv_far.json")});
    EXPECT_LT(outcome.exit_status, 128) << outcome.err;
    EXPECT_NE(outcome.exit_status, 0);
    for (const char* part : {"b2", "position", "1e30", "1e+155"})
      EXPECT_TRUE(has(outcome.err, part)) << outcome.err << part;
  }
}

TEST(RobustReachProgram, AStateBeyondAllReasonIsRefusedByName) {
  Json scene = Json::parse(read_text(adversary("fcl_segv_far.json")));
  scene["bodies"][2]["position"] = {20, 0, 0};
  const std::string file = temporary("near.json"), state_file = temporary("state.json");
  write_text(file, scene.dump());
  ASSERT_EQ(run_program({"run", file, "--steps", "1", "--save", state_file}).exit_status, 0);
  std::string state = read_text(state_file);
  const std::size_t at = state.find("20.0") != std::string::npos ? state.find("20.0") : state.find("20");
  ASSERT_NE(at, std::string::npos) << state;
  state.replace(at, 2, "2e155");
  if (state.compare(at + 5, 2, ".0") == 0) state.erase(at + 5, 2);
  write_text(state_file, state);
  const Outcome outcome = run_program({"run", file, "--steps", "1", "--from", state_file});
  EXPECT_EQ(outcome.exit_status, 2) << outcome.err;
  for (const char* part : {"position of b2", "1e30"}) EXPECT_TRUE(has(outcome.err, part)) << outcome.err;
}

TEST(RobustPairsProgram, ShapesThatPassThroughEachOtherAreWarnedOf) {
  const std::string file = adversary("mesh_on_mesh.json"), report_file = temporary("report.json");
  const Outcome check = run_program({"check", file});
  EXPECT_EQ(check.exit_status, 0);
  EXPECT_TRUE(has(check.out, "warning: ") && has(check.out, "triangle_mesh of low and triangle_mesh of up"))
      << check.out;
  const Outcome run = run_program({"run", file, "--report", report_file, "--quiet"});
  EXPECT_EQ(run.exit_status, 0);
  // At the start, and when they meet, once.
  const std::size_t first = run.err.find("triangle_mesh of low and triangle_mesh of up");
  ASSERT_NE(first, std::string::npos) << run.err;
  const std::size_t second = run.err.find("triangle_mesh of low and triangle_mesh of up meet at t =");
  ASSERT_NE(second, std::string::npos) << run.err;
  EXPECT_EQ(run.err.find("meet at", second + 50), std::string::npos) << run.err;
  const Json report = Json::parse(read_text(report_file));
  EXPECT_EQ(report["max_unsupported_pairs"], 1);
  std::string warnings;
  for (const Json& warning : report["warnings"]) warnings += warning.get<std::string>() + "\n";
  EXPECT_TRUE(has(warnings, "no contact between") && has(warnings, "meet at t =")) << warnings;
}

TEST(RobustPairsProgram, WhatHasContactsIsNotWarnedOf) {
  // On a mesh and on a height field everything has contacts but another mesh.
  for (const char* name : {"shapes_on_mesh.json", "shapes_on_height_field.json"}) {
    const Outcome check = run_program({"check", adversary(name)});
    const std::string ground = has(name, "height") ? "height_field of ground" : "triangle_mesh of ground";
    EXPECT_TRUE(has(check.out, ground + " and triangle_mesh of ")) << check.out;
    EXPECT_FALSE(has(check.out, "more pairs")) << check.out;
    for (const char* convex : {"sphere of", "box of", "capsule of", "cylinder of", "cone of"})
      EXPECT_FALSE(has(check.out, convex)) << check.out;
  }
}

std::string heap_file(int count) {
  Json scene = {{"format", "taut-scene/1"}, {"dt", 1.0 / 240}, {"bodies", Json::array()}};
  const Json shape = {{"type", "sphere"}, {"radius", 0.1}};
  for (int i = 0; i < count; ++i)
    scene["bodies"].push_back(
        {{"name", std::string("b").append(std::to_string(i))}, {"density", 1000}, {"shapes", {shape}}});
  const std::string file = temporary(std::string("heap_").append(std::to_string(count)) + ".json");
  write_text(file, scene.dump());
  return file;
}

TEST(RobustCrowdProgram, BodiesInOnePlaceAreToldAtOnce) {
  const std::string file = heap_file(300);
  const auto start = std::chrono::steady_clock::now();
  const Outcome check = run_program({"check", file});
  EXPECT_EQ(check.exit_status, 1);
  EXPECT_TRUE(has(check.out, "problem: contacts: the first step cannot be done") && has(check.out, "25000") &&
              has(check.out, "max_contacts"))
      << check.out;
  const std::string report_file = temporary("report.json");
  const Outcome run = run_program({"run", file, "--report", report_file});
  EXPECT_EQ(run.exit_status, 1);
  EXPECT_TRUE(has(run.err, "crowded") && has(run.err, "25000")) << run.err;
  EXPECT_EQ(Json::parse(read_text(report_file))["status"], "crowded");
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  EXPECT_LT(seconds.count(), 20);  // below one second, alone
}

TEST(RobustThreadsProgram, TheirNumberIsBounded) {
  const Outcome outcome = run_program({"run", "stack", "--threads", "1000000", "--steps", "1"});
  EXPECT_EQ(outcome.exit_status, 2);
  EXPECT_TRUE(has(outcome.err, "threads") && has(outcome.err, "1024")) << outcome.err;
}

/// As a user who may have 20 processes, threads with them; 0 if all is as it should be, 77 if that cannot be
/// had here.  Root has no such limit.
int run_with_few_processes() {
  constexpr uid_t kNobody = 65534;
  if (setgid(kNobody) != 0 || setuid(kNobody) != 0) return 77;
  const std::string many_file = temporary("many.json"), alone_file = temporary("alone.json");
  const testing::ResourceLimit limit(RLIMIT_NPROC, 20);
  Outcome alone, many;
  try {
    alone =
        run_program({"run", "stack", "--steps", "5", "--quiet", "--threads", "1", "--report", alone_file});
  } catch (const std::exception&) {
    return 77;
  }
  if (alone.exit_status == 127) return 77;  // it may not be read
  many = run_program({"run", "stack", "--steps", "5", "--quiet", "--threads", "64", "--report", many_file});
  std::cerr << alone.err << many.err;
  if (alone.exit_status != 0 || many.exit_status != 0) return 1;
  const std::string said = "of the threads could not be started";
  if (many.err.find(said) == std::string::npos || many.err.find(said) != many.err.rfind(said)) return 2;
  const Json few = Json::parse(read_text(many_file)), one = Json::parse(read_text(alone_file));
  if (few["missing_threads"] < 40 || one["missing_threads"] != 0) return 3;
  return few["final_state_fingerprint"] == one["final_state_fingerprint"] ? 0 : 4;
}

TEST(RobustThreadsProgram, ThreadsThatCannotBeStartedAreDoneWithoutAndSaidOnce) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can become a user who has no other processes";
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) std::exit(run_with_few_processes());
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  if (WEXITSTATUS(status) == 77) GTEST_SKIP() << "that user cannot run the program";
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace taut::robust_collision_program_test
