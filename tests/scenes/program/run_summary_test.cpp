// What a run says at its end.
#include "scenes/program/run_summary.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "scenes/program/run_report.h"
#include "tests/run_program.h"
#include "tests/temporary.h"

namespace taut::run_summary_test {
namespace {

using Json = nlohmann::json;
using testing::run_program;

std::vector<std::string> labels(const std::string& summary) {
  std::vector<std::string> found;
  std::istringstream in(summary);
  for (std::string line; std::getline(in, line);) found.push_back(line.substr(0, line.find("  ")));
  return found;
}

/// The value of a line, behind its label and the spaces after it; empty if there is none.
std::string value_of(const std::string& label, const std::string& summary) {
  std::istringstream in(summary);
  for (std::string line; std::getline(in, line);)
    if (line.substr(0, line.find("  ")) == label)
      return line.substr(line.find_first_not_of(' ', label.size()));
  return "";
}

TEST(RunSummary, HasEightLines) {
  const std::vector<std::string> eight{"scene",  "speed",       "joint error", "what happened",
                                       "energy", "penetration", "status",      "to see it"};
  EXPECT_EQ(labels(run_summary(RunRecord(), "…")), eight);
  const testing::Outcome run = run_program({"run", "chain", "--set", "n=3", "--time", "0.1"});
  EXPECT_EQ(labels(run.out), eight) << run.out;
  const testing::Outcome all = run_program({"run", "chain", "--set", "n=3", "--time", "0.1", "--verbose"});
  EXPECT_EQ(value_of("bodies", all.out), "3") << all.out;
  EXPECT_NE(value_of("phases", all.out), "") << all.out;
  EXPECT_GT(labels(all.out).size(), 20u);
  // The work of motors and friction is no error of a run: "energy" tells what works do not account for.
  EXPECT_EQ(all.out.find("energy drift"), std::string::npos) << all.out;
  EXPECT_EQ(run_program({"run", "chain", "--quiet", "--verbose"}).exit_status, 2);
}

TEST(RunSummary, SaysWhatHappenedToWhom) {
  RunRecord record;
  record.steps = 50;
  EXPECT_EQ(value_of("what happened", run_summary(record, "")),
            "no axis at a limit, no motor saturated, no joint broken, no step inexact");
  record.axes = {{.label = "elbow angle", .limit_steps = 3, .at_limit = true},
                 {.label = "wrist angle", .limit_steps = 2},
                 {.label = "lift displacement", .saturated_steps = 7, .saturated = true},
                 {.label = "idle angle"}};
  record.breaks = {{.joint = "rope 3", .with = "", .time = 1.25}};
  record.inexact_steps = 4;
  record.max_complementarity_residual = 3e-5;
  record.worst = {0.5, 3e-5, {"contact of box and ground"}};
  record.asleep = 2;
  EXPECT_EQ(
      value_of("what happened", run_summary(record, "")),
      "at limits at the end: elbow angle; at limits before: wrist angle; motors saturated at the end: lift "
      "displacement; broken joints: rope 3 at 1.25 s; 4 of 50 steps inexact, at most 3.0e-05 at t = 0.5 s: "
      "contact of box and ground; 2 bodies asleep at the end");
}

/// Energy that a motor brings is no error.  Of the drift, which takes it for one, that cannot be said.
TEST(RunSummary, WorkOfAMotorIsNoError) {
  const std::string file = testing::temporary("motor.json"),
                    report_file = testing::temporary("motor_report.json");
  testing::write_text(file, R"({"format": "taut-scene/1", "dt": 0.001, "duration": 0.5, "gravity": [0, 0, 0],
    "bodies": [{"name": "wheel", "mass": 1, "inertia": [0.06, 0.06, 0.06]}],
    "joints": [{"name": "axle", "type": "hinge", "a": "ground", "b": "wheel", "anchor": [0, 0, 0], "axis": [0, 0, 1],
      "axes": {"angle": {"motor": {"velocity": 100, "max_force": 1},
                         "limits": {"lower": -1, "upper": 1.5}}}}]})");
  const testing::Outcome run = run_program({"run", file, "--report", report_file});
  ASSERT_EQ(run.exit_status, 0) << run.err;
  const Json report = Json::parse(testing::read_text(report_file)), energy = report["energy"];
  // At θ = 1.5 the motor has given 1.5 J, which the limit then takes; the kick that meets the limit is
  // both's.
  const double motors = energy["ledger"]["motors"].get<double>(),
               limits = energy["ledger"]["limits"].get<double>();
  EXPECT_NEAR(motors, 1.5, 1e-3);
  EXPECT_NEAR(motors + limits, 0, 1e-12);
  EXPECT_EQ(energy["works_known"], true);
  EXPECT_GT(energy["max_drift"].get<double>(), 1);  // before the limit
  EXPECT_LT(energy["max_unexplained"].get<double>(), 1e-12);
  EXPECT_LT(energy["max_unexplained_rel"].get<double>(), 1e-12);
  ASSERT_EQ(report["axes"].size(), 1u);
  EXPECT_EQ(report["axes"][0]["axis"], "axle angle");
  EXPECT_EQ(report["axes"][0]["at_limit"], true);
  EXPECT_EQ(report["axes"][0]["saturated"], true);
  EXPECT_GT(report["axes"][0]["steps_saturated"], report["axes"][0]["steps_at_limit"]);
  EXPECT_TRUE(report["worst_step"].is_null());
  EXPECT_EQ(value_of("what happened", run.out),
            "at limits at the end: axle angle; motors saturated at the end: axle angle");
  EXPECT_NE(
      value_of("energy", run.out).find("0 J to 0 J; motors 1.501 J, limits -1.501 J; not accounted for "),
      std::string::npos)
      << run.out;
}

/// The closing is that of the energies themselves: E₁ − E₀ − all works.
TEST(RunSummary, TheClosingIsTheDifferenceOfEnergiesAndWorks) {
  const std::string report_file = testing::temporary("chain_report.json");
  ASSERT_EQ(run_program({"run", "chain", "--set", "n=10", "--dt", "0.01", "--steps", "50", "--report",
                         report_file, "--quiet"})
                .exit_status,
            0);
  const Json energy = Json::parse(testing::read_text(report_file))["energy"];
  double works = 0;
  for (const char* work :
       {"motors", "drivers", "friction", "limits", "contacts", "damping", "forces", "breaking"})
    works += energy["ledger"][work].get<double>();
  const double left = energy["final"].get<double>() - energy["initial"].get<double>() - works;
  EXPECT_GT(energy["max_unexplained"].get<double>(), 1e-6);  // RATTLE's energy oscillates
  EXPECT_GE(energy["max_unexplained"].get<double>(), std::abs(left) * (1 - 1e-9));
}

TEST(RunSummary, WhereWorksAreNotKnownItSaysSo) {
  const testing::Outcome run =
      run_program({"run", "chain", "--set", "n=3", "--time", "0.1", "--integrator", "force-runge-kutta"});
  EXPECT_NE(value_of("energy", run.out).find("works not known"), std::string::npos) << run.out << run.err;
}

TEST(RunSummary, ShowsTheWayToAPicture) {
  RunOptions options;
  options.scene = "bridge";
  options.words = {"bridge", "--set", "n=5", "--report", "r.json", "--csv=a.csv", "--time", "1", "--verbose"};
  EXPECT_EQ(how_to_see(options), "taut run bridge --set n=5 --time 1 --html bridge.html");
  // The live view is another way to see it.
  options.live.port = "0";
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"--live", "bridge", "--set", "n=5"},
        {"bridge", "--live", "--set", "n=5"},
        {"bridge", "--live", "0", "--set", "n=5"},
        {"bridge", "--set", "n=5", "--live=0", "--live-address=::1"},
        {"--live-address", "127.0.0.1", "bridge", "--set", "n=5", "--live"}}) {
    options.words = words;
    EXPECT_EQ(how_to_see(options), "taut run bridge --set n=5 --html bridge.html");
  }
  options.scene = "some where/it's.json";
  options.words = {options.scene};
  EXPECT_EQ(how_to_see(options), "taut run 'some where/it'\\''s.json' --html 'it'\\''s.html'");
  options.record_file = "it.taut";
  EXPECT_EQ(how_to_see(options), "taut replay it.taut --html it.html");
  options.program = "./taut";  // as it was called
  EXPECT_EQ(how_to_see(options), "./taut replay it.taut --html it.html");
  options.exports.html = "page.html";
  EXPECT_EQ(how_to_see(options), "open page.html in a browser");
}

/// What is printed can be typed.
TEST(RunSummary, ThatWayLeadsThere) {
  const testing::Outcome run = run_program(
      {"run", "chain", "--set", "n=2", "--time", "0.05", "--report", testing::temporary("r.json")});
  // It begins with the program as it was called.
  const std::string typed = value_of("to see it", run.out),
                    rest = " run chain --set n=2 --time 0.05 --html chain.html";
  ASSERT_TRUE(typed.ends_with(rest)) << run.err;
  EXPECT_TRUE(std::filesystem::is_regular_file(typed.substr(0, typed.size() - rest.size()))) << typed;
}

}  // namespace
}  // namespace taut::run_summary_test
