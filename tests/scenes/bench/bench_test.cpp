#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "scenes/bench/bench_report.h"
#include "scenes/bench/work_report.h"
#include "tests/run_program.h"
#include "tests/temporary.h"

/// When `taut bench --compare` says that something has become worse.
namespace taut::testing::bench_test {
namespace {

using Json = nlohmann::ordered_json;

/// A run of 2 s, of the cost [s of processor time per simulated s] and joint error [m].
Json run_of(const char* engine, int n, double cost, double joint_error) {
  return {{"engine", engine},
          {"method", "rattle"},
          {"scene", "chain"},
          {"n", n},
          {"with", ""},
          {"rate_hz", 240.0},
          {"status", "success"},
          {"cpu_per_simulated_s", cost},
          {"max_joint_error_m", joint_error},
          {"max_joint_angle_error_rad", 0.0},
          {"energy_drift_rel", 1e-4},
          {"simulated_time_s", 2.0},
          {"duration_s", 2.0}};
}
BenchResults results(std::vector<Json> runs) { return {{"runs", std::move(runs)}}; }

TEST(BenchComparison, EqualResultsAreNotWorse) {
  const BenchResults same = results({run_of("taut", 10, 0.1, 1e-10), run_of("taut", 20, 0.3, 1e-10)});
  const BenchComparison comparison = compare_bench(same, same, 1.5);
  EXPECT_EQ(comparison.compared, 2);
  EXPECT_TRUE(comparison.worse.empty());
}

TEST(BenchComparison, OnlyWhatTakesMoreThanTheFactorIsWorse) {
  const BenchResults then = results({run_of("taut", 10, 0.1, 1e-10), run_of("taut", 20, 0.3, 1e-10)});
  const BenchResults now = results({run_of("taut", 10, 0.149, 1e-10), run_of("taut", 20, 0.46, 1e-10)});
  const BenchComparison comparison = compare_bench(now, then, 1.5);
  EXPECT_EQ(comparison.worse, std::vector<std::size_t>{1});
  EXPECT_NE(comparison.text.find("x 1.53  WORSE"), std::string::npos) << comparison.text;
  EXPECT_EQ(compare_bench(now, then, 1.4).worse.size(), 2u);
  EXPECT_EQ(compare_bench(then, now, 1.5).worse.size(), 0u);  // faster is no regression
}

TEST(BenchComparison, AnOpenedJointIsWorseThoughFaster) {
  const BenchResults then = results({run_of("taut", 10, 0.1, 1e-10)});
  EXPECT_EQ(compare_bench(results({run_of("taut", 10, 0.05, 2e-9)}), then, 1.5).worse.size(), 1u);
  // What was open before may stay so.
  EXPECT_EQ(
      compare_bench(results({run_of("taut", 10, 0.1, 3e-6)}), results({run_of("taut", 10, 0.1, 2e-6)}), 1.5)
          .worse.size(),
      0u);
}

TEST(BenchComparison, ARunThatFailsNowIsWorse) {
  const BenchResults then = results({run_of("taut", 10, 0.1, 1e-10)});
  Json stopped = run_of("taut", 10, 0.1, 1e-10), crashed = stopped;
  stopped["status"] = "diverged";
  crashed["status"] = "crashed";
  crashed.erase("cpu_per_simulated_s");
  EXPECT_EQ(compare_bench(results({stopped}), then, 1.5).worse.size(), 1u);
  EXPECT_EQ(compare_bench(results({crashed}), then, 1.5).worse.size(), 1u);
}

TEST(BenchComparison, OtherEnginesAndNewScenesDoNotCount) {
  const BenchResults then = results({run_of("taut", 10, 0.1, 1e-10), run_of("ode", 10, 0.1, 1e-3)});
  const BenchComparison comparison =
      compare_bench(results({run_of("ode", 10, 9, 1), run_of("taut", 99, 9, 1)}), then, 1.5);
  EXPECT_EQ(comparison.compared, 0);
  EXPECT_TRUE(comparison.worse.empty());
}

TEST(BenchComparison, TheFasterOfTwoMeasurementsIsTheBetterOne) {
  const Json slow = run_of("taut", 10, 0.2, 1e-10), fast = run_of("taut", 10, 0.1, 1e-10);
  Json crashed = fast;
  crashed.erase("cpu_per_simulated_s");
  EXPECT_TRUE(is_better_measurement(fast, slow));
  EXPECT_FALSE(is_better_measurement(slow, fast));
  EXPECT_FALSE(is_better_measurement(crashed, slow));
}

// Before three minutes of measuring, not after them.
TEST(BenchComparison, WhatIsNoResultIsRefusedAtOnce) {
  write_text(temporary("no_result.json"), "{\"runs\": 3}");
  for (const std::string& file : {std::string("/no/such/file.json"), temporary("no_result.json")}) {
    const Outcome outcome = run_program({"bench", "--quick", "--compare", file});
    EXPECT_EQ(outcome.exit_status, 2);
    EXPECT_NE(outcome.err.find(file), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.err.find("minutes at most"), std::string::npos) << outcome.err;
  }
}

Json contact_run(const char* engine, const char* scene, const char* quality, double cost, double joint_error,
                 double creep, double penetration) {
  Json run = run_of(engine, 10, cost, joint_error);
  run.update({{"scene", scene},
              {"quality", quality},
              {"max_motion_m", scene == std::string("stack") ? 0.04 : 0.5},
              {"creep_m", creep},
              {"max_penetration_m", 0.09},
              {"final_penetration_m", penetration},
              {"max_energy_gain_rel", 0.0}});
  run["energy_drift_rel"] = 0.9;  // lost in impacts
  return run;
}

// Joints where there are some, else penetration, and of what stands creep.
TEST(BenchPage, ContactIsComparedByWhatMustNotBe) {
  Json thief = contact_run("ode", "pile", "rests", 0.001, 0, 0, 1e-7);
  thief["max_energy_gain_rel"] = 0.2;
  Json fallen = contact_run("ode", "stack", "stands", 0.01, 0, 1e-12, 1e-12);
  fallen["max_motion_m"] = 0.06;
  const Json runs = {contact_run("taut", "stack", "stands", 0.2, 0, 1e-9, 1e-11),
                     fallen,
                     contact_run("ode", "stack", "stands", 0.1, 0, 1e-2, 1e-5),
                     contact_run("mujoco", "stack", "stands", 0.3, 0, 1e-6, 1e-4),
                     contact_run("taut", "pile", "rests", 0.2, 0, 0.3, 1e-6),
                     contact_run("bullet", "pile", "rests", 0.05, 0, 0.3, 1e-4),
                     thief,
                     contact_run("taut", "net-catch", "carries", 0.2, 1e-10, 0.3, 1e-2),
                     contact_run("bullet", "net-catch", "carries", 0.01, 1e-2, 0.3, 1e-6)};
  const BenchResults all{{"machine", Json::object()},
                         {"planned_runs", 9},
                         {"engines", Json::object()},
                         {"profiles", Json::array()},
                         {"runs", runs}};
  const std::string page = bench_page(all, "taut bench --contact");
  for (const char* line :
       {"| stack 10 | taut rattle, 240 Hz: 0.2 s/s, error 1e-09 | none | mujoco rattle, "
        "240 Hz",
        "| pile 10 | taut rattle, 240 Hz: 0.2 s/s, error 1e-06 | none | bullet rattle, 240 Hz",
        "| net-catch 10 | taut rattle, 240 Hz: 0.2 s/s, error 1e-10 | none | none |",
        "- pile 10, error ≤ 1e-03: bullet rattle, 240 Hz takes 0.25 of taut's time"})
    EXPECT_NE(page.find(line), std::string::npos) << line << '\n' << page;
  EXPECT_EQ(page.find("## Best of each"), std::string::npos);  // of joints alone
}

TEST(WorkReport, ExponentsAreThoseOfPowers) {
  EXPECT_NEAR(growth_exponent({{10, 3}, {100, 3 * std::pow(10, 1.5)}, {1000, 3000}}).value(), 1.5, 1e-12);
  EXPECT_FALSE(growth_exponent({{10, 3}}));
  EXPECT_FALSE(growth_exponent({{10, 3}, {10, 4}}));
}

TEST(WorkReport, ShowsTheNumbersOfEachProfileAndTheGrowthOfEachFamily) {
  const auto profile = [](int n, double time) {
    return Json{{"scene", "chain"},
                {"n", n},
                {"with", ""},
                {"rows", 3 * n},
                {"factor_nonzeros", 24 * n},
                {"factor_flops", 200 * n},
                {"order", "AMD"},
                {"factor_time_s", 1e-4},
                {"bare_cholmod_time_s", 2e-4},
                {"share_of_dgemm", 0.25},
                {"step_time_s", time},
                {"substeps_per_step", 2.0},
                {"max_joint_error_m", 3e-11},
                {"max_joint_angle_error_rad", 4e-11},
                {"energy_drift_rel", 5e-6},
                {"peak_memory_mb", 40},
                {"stage_times_per_substep_s",
                 {{"forces", 1},
                  {"positions", 2},
                  {"assembly", 3},
                  {"factorization", 4},
                  {"velocities", 5},
                  {"total", 20}}}};
  };
  BenchResults results{{"profiles", {profile(10, 1e-3), profile(1000, 1e-1)}}};
  const std::string text = work_tables(results);
  EXPECT_NE(
      text.find(
          "| chain 10 | 30 | 1 ms | 2 | 0.1 ms | 0.2 ms | 240 | 2e+03 | AMD | 25 % | 5, 10, 15, 20, 25 | "
          "4.0e-11 | 5.0e-06 | 40 MB |"),
      std::string::npos)
      << text;
  EXPECT_NE(text.find("| chain | 1.00 | 1.00 | 1.00 | 0.00 |"), std::string::npos) << text;
  EXPECT_EQ(text.find("## Threads"), std::string::npos);
  results["profiles"][1]["modelled_gain"] = {{"2", 1.9}, {"4", 3.5}, {"16", 6}, {"64", 6.25}};
  results["profiles"][1]["gain_of_two_threads"] = 1.75;
  EXPECT_NE(work_tables(results).find("| chain 1000 | 1.75 | 1.90 | 3.50 | 6.00 | 6.25 |"),
            std::string::npos);
  results["profiles"][1]["gain_of_two_threads"] = nullptr;  // of a machine with one core
  EXPECT_NE(work_tables(results).find("| chain 1000 | – | 1.90 |"), std::string::npos);
  results["profiles"][1] = {{"scene", "chain"}, {"n", 1000}, {"with", ""}, {"failed", "killed"}};
  EXPECT_NE(work_tables(results).find("| chain 1000 | | killed |"), std::string::npos);
  results["profiles"][1] = profile(1000, 1e-1);
  results["profiles"][1]["stage_times_per_substep_s"] = {
      {"total", nullptr}};  // as JSON says what is no number
  results["profiles"][1]["step_time_s"] = nullptr;
  EXPECT_NE(work_tables(results).find("| chain 1000 | 3000 | nan ms |"), std::string::npos);
}

/// Powers cross where they are equal.
TEST(WorkReport, CurvesCrossForGood) {
  using Points = std::vector<std::pair<double, double>>;
  const Points cubic{{2, 8}, {8, 512}, {32, 32768}}, linear{{2, 50}, {8, 200}, {32, 800}};
  EXPECT_NEAR(crossing(cubic, linear).value(), 5, 1e-12);  // n³ = 25 n
  EXPECT_FALSE(crossing(linear, cubic));
  EXPECT_EQ(crossing(cubic, {{2, 1}, {8, 1}, {32, 1}}), 0);
  EXPECT_NEAR(crossing({{1, 2}, {2, 1}, {4, 4}}, {{1, 1}, {2, 2}, {4, 2}}).value(), std::sqrt(8), 1e-12);
  EXPECT_FALSE(crossing({}, {}));
}

TEST(WorkReport, SaysFromWhichSizeOnAMethodIsFaster) {
  const auto methods = [](int n, double rattle, double recursive, const Json& lagrangian) {
    return Json{
        {"scene", "chain"},
        {"n", n},
        {"method_step_times_s", {{"rattle", rattle}, {"recursive", recursive}, {"lagrangian", lagrangian}}}};
  };
  const BenchResults results{{"profiles", Json::array()},
                             {"methods",
                              {methods(2, 50e-6, 20e-6, 8e-6), methods(8, 200e-6, 80e-6, 512e-6),
                               methods(32, 800e-6, 320e-6, nullptr)}}};
  const std::string text = work_tables(results);
  EXPECT_NE(text.find("| 8 | 0.2 ms | 0.08 ms | – | 0.512 ms | – |"), std::string::npos) << text;
  EXPECT_NE(text.find("* recursive is faster than lagrangian from some 3 links on"), std::string::npos)
      << text;
  EXPECT_NE(text.find("* rattle is not faster than recursive at the last size"), std::string::npos) << text;
}

/// Before anything runs or an earlier result is written over.
TEST(Bench, WhatWouldMeasureNothingIsRefused) {
  const std::string folder = temporary("bench_results");
  const auto refusal = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"bench", "--results", folder});
    const Outcome outcome = run_program(options);
    EXPECT_NE(outcome.exit_status, 0);
    return outcome.err;
  };
  EXPECT_NE(refusal({"--quick", "--only", "nosuch"}).find("nosuch"), std::string::npos);
  EXPECT_NE(refusal({"--quick", "--factor", "2"}).find("--factor requires --compare"), std::string::npos);
  EXPECT_NE(refusal({"--limit", "-1"}).find("--limit"), std::string::npos);
  EXPECT_NE(refusal({"--quick", "--", "--benchmark_filter=Linear"}).find("--quick"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder));
}

TEST(WorkReport, OptionsThatMeanNothingForItAreRefused) {
  const std::string folder = temporary("");
  EXPECT_NE(run_program({"bench", "--work", "--compare", folder + "/none.json"}).exit_status, 0);
  EXPECT_NE(run_program({"bench", "--work", "--only", "nosuch"}).exit_status, 0);
  EXPECT_NE(run_program({"bench", "--work", "--build-dir", folder}).exit_status, 0);
}

}  // namespace
}  // namespace taut::testing::bench_test
