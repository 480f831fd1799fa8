#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/run_program.h"
#include "tests/temporary.h"

/// What the program says of settings that do not go together, of output files it cannot have, and of a start
/// that is not what it seems.
namespace taut::testing::program_settings_test {
namespace {

using Json = nlohmann::json;

void expect_words(const std::string& text, const std::vector<std::string>& words) {
  for (const std::string& word : words)
    EXPECT_NE(text.find(word), std::string::npos) << word << " in " << text;
}

/// A file of every output option; those that must stay as they are hold a word.
struct OutputFiles {
  std::vector<std::string> options;
  std::vector<std::string> files;
  explicit OutputFiles(bool are_there) {
    for (const auto& [option, ending] : std::vector<std::pair<std::string, std::string>>{{"report", ".json"},
                                                                                         {"csv", ".csv"},
                                                                                         {"poses", ".csv"},
                                                                                         {"record", ".taut"},
                                                                                         {"html", ".html"},
                                                                                         {"gltf", ".glb"},
                                                                                         {"plot", ".svg"}}) {
      files.push_back(temporary("kept_" + option + ending));
      options.insert(options.end(), {"--" + option, files.back()});
      std::filesystem::remove(files.back());
      if (are_there) write_text(files.back(), "mine");
    }
    options.insert(options.end(), {"--vtk", temporary("kept/vtk")});
  }
  void expect_untouched(bool are_there) const {
    for (const std::string& file : files) {
      EXPECT_EQ(std::filesystem::exists(file), are_there) << file;
      EXPECT_EQ(read_text(file), are_there ? "mine" : "") << file;
    }
    EXPECT_FALSE(std::filesystem::exists(temporary("kept")));
  }
};

struct Exclusion {
  std::vector<std::string> arguments, named;
};
const Exclusion kExclusions[] = {
    {{"pendulum-ball", "--integrator", "moreau-jean", "--tension", "implicit"},
     {"--tension", "implicit", "--integrator \"moreau-jean\""}},
    {{"pendulum-ball", "--solver", "pairwise", "--integrator", "rattle4"},
     {"--integrator", "rattle4", "--solver \"pairwise\"", "\"rattle\""}},
    {{"pendulum-ball", "--solver", "propagation", "--tension", "implicit"},
     {"--tension", "implicit", "--solver \"propagation\""}},
    {{"pendulum-ball", "--integrator", "moreau-jean", "--drift-cure", "penalty"},
     {"--drift-cure", "penalty", "--integrator \"moreau-jean\"", "position-push"}},
    {{"stack", "--integrator", "rattle4"}, {"--integrator", "rattle4", "shapes"}},
    {{"suspension-bridge", "--integrator", "moreau-jean"},
     {"--integrator", "moreau-jean", "hanger_1 may break"}},
    {{"tank", "--integrator", "force-euler"}, {"--integrator", "force-euler", "joint left_"}},
};

TEST(ProgramSettings, ThatExcludeEachOtherAreNamedAndNoFileIsTouched) {
  for (const auto& [scene_and_options, named] : kExclusions)
    for (const bool are_there : {false, true}) {
      const OutputFiles outputs(are_there);
      std::vector<std::string> arguments{"run"};
      arguments.insert(arguments.end(), scene_and_options.begin(), scene_and_options.end());
      arguments.insert(arguments.end(), outputs.options.begin(), outputs.options.end());
      const Outcome run = run_program(arguments);
      EXPECT_EQ(run.exit_status, 2) << run.err;
      expect_words(run.err, named);
      outputs.expect_untouched(are_there);
    }
}

TEST(ProgramSettings, OneFileThatCannotBeWrittenLeavesTheOthersAlone) {
  for (const char* bad : {"--report", "--csv", "--poses", "--record", "--html", "--gltf", "--plot", "--vtk"})
    for (const bool are_there : {false, true}) {
      OutputFiles outputs(are_there);
      const auto at = std::find(outputs.options.begin(), outputs.options.end(), bad);
      ASSERT_NE(at, outputs.options.end());
      // No file in a file; and files that are there are asked for, not opened.
      const std::string nowhere = temporary("plain") + "/x";
      write_text(temporary("plain"), "");
      *(at + 1) = nowhere;
      std::vector<std::string> arguments{"run", "pendulum-ball", "--steps", "2"};
      arguments.insert(arguments.end(), outputs.options.begin(), outputs.options.end());
      const Outcome run = run_program(arguments);
      EXPECT_EQ(run.exit_status, 2);
      expect_words(run.err, {bad, nowhere});
      outputs.expect_untouched(are_there);
    }
}

TEST(ProgramSettings, OfAFileAreNamedByTheirPath) {
  const std::string file = temporary("settings.json");
  const auto text = [](const std::string& settings) {
    return R"({"format": "taut-scene/1", "settings": {)" + settings + R"(},
      "bodies": [{"name": "b", "mass": 1, "inertia": [1, 1, 1]}],
      "joints": [{"name": "j", "type": "ball", "a": "ground", "b": "b", "anchor": [0, 0, 1]}]})";
  };
  write_text(file, text(R"("solver": "pairwise", "tension": "implicit", "integrator": "rattle4")"));
  const Outcome both = run_program({"check", file});
  EXPECT_EQ(both.exit_status, 2);
  expect_words(both.err,
               {file + ":1:100: /settings/integrator: excludes \"solver\": \"pairwise\" of /settings/solver",
                "(value: \"rattle4\")", "/settings/tension: excludes", "(value: \"implicit\")"});
  write_text(file, text(R"("tension": "implicit")"));
  const Outcome mixed = run_program({"run", file, "--integrator", "moreau-jean"});
  EXPECT_EQ(mixed.exit_status, 2);
  expect_words(mixed.err, {file + ": /settings/tension: excludes --integrator \"moreau-jean\""});
}

TEST(ProgramSettings, WithoutEffectAreWarningsInTableAndReport) {
  const std::string report_file = temporary("unused.json"), file = temporary("unused_settings.json");
  const auto warnings_of = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "run");
    arguments.insert(arguments.end(), {"--steps", "2", "--report", report_file});
    const Outcome run = run_program(arguments);
    EXPECT_EQ(run.exit_status, 0) << run.err;
    const Json warnings = Json::parse(read_text(report_file))["warnings"];
    for (const Json& warning : warnings)
      EXPECT_NE(run.out.find(warning.get<std::string>()), std::string::npos) << run.out;
    return warnings.dump();
  };
  expect_words(warnings_of({"pendulum-ball", "--theta", "0.7"}), {"--theta has no effect", "moreau-jean"});
  expect_words(warnings_of({"pendulum-ball", "--drift-cure", "none"}), {"--drift-cure has no effect"});
  expect_words(warnings_of({"pendulum-ball", "--iterations", "9", "--relaxation", "1.2"}),
               {"--iterations has no effect", "--relaxation has no effect"});
  expect_words(
      warnings_of({"pendulum-ball", "--solver", "pairwise", "--relaxation", "1.2", "--tension", "ignore"}),
      {"--relaxation has no effect", "--tension has no effect"});
  expect_words(warnings_of({"pendulum-ball", "--poses-interval", "0.1", "--frames-per-second", "30"}),
               {"--poses-interval has no effect", "--frames-per-second has no effect"});
  EXPECT_EQ(warnings_of({"pendulum-ball", "--poses-interval", "0.1", "--poses", temporary("p.csv")}), "[]");
  EXPECT_EQ(
      warnings_of({"pendulum-ball", "--integrator", "moreau-jean", "--theta", "0.7", "--drift-cure", "none"}),
      "[]");
  EXPECT_EQ(warnings_of({"pendulum-ball", "--integrator", "force-euler", "--drift-cure", "penalty",
                         "--penalty-frequency", "20", "--penalty-damping-ratio", "0.5"}),
            "[]");
  EXPECT_EQ(warnings_of({"pendulum-ball", "--integrator", "force-euler", "--erp", "0.2", "--cfm", "1e-9"}),
            "[]");
  expect_words(warnings_of({"pendulum-ball", "--integrator", "force-euler", "--drift-cure", "position-push",
                            "--cfm", "1e-9", "--penalty-frequency", "20"}),
               {"--cfm has no effect", "baumgarte", "--penalty-frequency has no effect", "penalty"});
  EXPECT_EQ(
      warnings_of({"pendulum-ball", "--solver", "gauss-seidel", "--relaxation", "1.2", "--iterations", "9"}),
      "[]");
  write_text(file,
             R"({"format": "taut-scene/1", "settings": {"theta": 0.7, "erp": 0.5, "penalty_frequency": 9}})");
  expect_words(warnings_of({file}),
               {file + ": /settings/theta has no effect", file + ": /settings/erp has no effect",
                file + ": /settings/penalty_frequency has no effect"});
  expect_words(run_program({"check", file}).out, {"warning: " + file + ": /settings/theta has no effect"});
}

/// A pendulum of one rod about the origin, 0.5 m to its centre, with that velocity of it.
std::string thrown_rod(const std::string& more) {
  return R"({"format": "taut-scene/1", "name": "rod", "duration": 0.01, "dt": 0.001,
    "bodies": [{"name": "rod", "mass": 2, "inertia": [0.1, 0.5, 0.5], "position": [0.5, 0, 0], )" +
         more + R"(}],
    "joints": [{"name": "pivot", "type": "ball", "a": "ground", "b": "rod", "anchor": [0, 0, 0]}]})";
}

/// Each number is the same as an option and in a scene file, and does something.
TEST(ProgramSettings, NumbersOfDriftCuresAreOptions) {
  const std::string report_file = temporary("cures.json"), file = temporary("cures_scene.json");
  const auto run_to_end = [&](const std::string& scene, std::vector<std::string> options) {
    options.insert(options.begin(), {"run", scene, "--steps", "20", "--report", report_file});
    const Outcome run = run_program(options);
    EXPECT_EQ(run.exit_status, 0) << run.err;
    return Json::parse(read_text(report_file))["final_state_fingerprint"].get<std::string>();
  };
  const std::vector<std::array<std::string, 4>> cases{
      {"baumgarte", "erp", "--erp", "0.3"},
      {"baumgarte", "cfm", "--cfm", "1e-6"},
      {"velocity-impulse", "erp", "--erp", "0.3"},
      {"position-push", "erp", "--erp", "0.3"},
      {"penalty", "penalty_frequency", "--penalty-frequency", "20"},
      {"penalty", "penalty_damping_ratio", "--penalty-damping-ratio", "0.4"}};
  for (const auto& [cure, key, option, value] : cases) {
    const auto scene_with = [&](const std::string& more) {
      write_text(file, thrown_rod(R"("fixed": false)")
                           .replace(1, 0,
                                    R"("settings": {"integrator": "force-euler", "drift_cure": ")" + cure +
                                        "\"" + more + "}, "));
      return file;
    };
    const std::string by_option = run_to_end(scene_with(""), {option, value});
    EXPECT_EQ(by_option, run_to_end(scene_with(", \"" + key + "\": " + value), {})) << cure << ' ' << option;
    EXPECT_NE(by_option, run_to_end(scene_with(""), {})) << cure << ' ' << option;
  }
  for (const char* option : {"--erp", "--cfm", "--penalty-frequency", "--penalty-damping-ratio"}) {
    const Outcome run = run_program({"run", file, option, "-1"});
    EXPECT_EQ(run.exit_status, 2) << option;
  }
}

TEST(ProgramStart, BodiesInEachOtherAreNamed) {
  const std::string file = temporary("overlap.json");
  write_text(file, R"({"format": "taut-scene/1", "ground": {"shapes": [{"type": "half_space"}]}, "bodies": [
    {"name": "low", "density": 1000, "position": [0, 0, 0.5], "shapes": [{"type": "box", "size": [1, 1, 1]}]},
    {"name": "high", "density": 1000, "position": [0, 0, 1.25], "shapes": [{"type": "box", "size": [1, 1, 1]}]}]})");
  const Outcome check = run_program({"check", file});
  EXPECT_EQ(check.exit_status, 0);
  expect_words(check.out, {"warning: bodies are in each other at the start, by up to 0.25 m: low and high",
                           R"("pairs": [{"a": "low", "b": "high", "collide": false}])"});
  const Outcome run = run_program({"run", file, "--time", "1"});
  EXPECT_EQ(run.exit_status, 0) << run.err;
  expect_words(run.out + run.err, {"low and high (0.25)", "at most 2.4"});
}

/// v = (0, 3, 0), ω = 0: with an impulse P along y at the pivot v = 3 + P/2 and ω = −0.5 P/0.5, and there 0 =
/// v − ω/2 = 3 + P. So P = −3 changes v by 1.5 m/s and ω by 3 rad/s.
TEST(ProgramStart, ForbiddenVelocitiesAreNamed) {
  const std::string file = temporary("thrown.json"), report_file = temporary("thrown_report.json");
  write_text(file, thrown_rod(R"("velocity": [0, 3, 0])"));
  const std::vector<std::string> words{"1.5 m/s", "3 rad/s", "ball pivot"};
  const Outcome check = run_program({"check", file});
  EXPECT_EQ(check.exit_status, 0);
  expect_words(check.out, words);
  expect_words(check.out, {"warning: joints forbid velocities at the start"});
  const Outcome run = run_program({"run", file, "--report", report_file});
  EXPECT_EQ(run.exit_status, 0);
  expect_words(run.out, words);
  expect_words(Json::parse(read_text(report_file))["warnings"].dump(), words);
  // Velocities that fit, to the six digits of a file, and none at all are nothing to speak of.
  for (const char* fitting :
       {R"("velocity": [0, 3.0000005, 0], "angular_velocity": [0, 0, 6])", R"("fixed": false)"}) {
    write_text(file, thrown_rod(fitting));
    EXPECT_EQ(run_program({"check", file}).out.find("warning"), std::string::npos) << fitting;
  }
}

/// ω = √(1e6 (1 + ½)) = 1225 /s, at 5 ms: 6.1.
TEST(ProgramStart, SpringsThatAnIntegratorCannotFollowAreNamed) {
  const std::string file = temporary("stiff.json");
  write_text(file, R"({"format": "taut-scene/1", "gravity": [0, 0, 0], "dt": 0.005, "duration": 0.05,
    "bodies": [{"name": "left", "mass": 1, "inertia": [0.1, 0.1, 0.1]},
               {"name": "right", "mass": 2, "inertia": [0.1, 0.1, 0.1], "position": [1, 0, 0]}],
    "forces": [{"type": "spring-damper", "a": "left", "b": "right", "frame": "body", "anchor_a": [0, 0, 0],
                "anchor_b": [0, 0, 0], "stiffness": 1e6, "rest_length": 0.9}]})");
  for (const char* integrator : {"rattle4", "force-euler", "force-runge-kutta"})
    expect_words(run_program({"run", file, "--integrator", integrator}).out,
                 {"warning", "too stiff", integrator, "left to right (6.12)"});
  for (const char* integrator : {"rattle", "moreau-jean"})
    EXPECT_EQ(run_program({"run", file, "--integrator", integrator}).out.find("too stiff"),
              std::string::npos);
  EXPECT_EQ(run_program({"run", file, "--integrator", "rattle4", "--dt", "0.001"}).out.find("too stiff"),
            std::string::npos);
}

/// A driver that starts at once takes nothing away; one against a velocity does.
TEST(ProgramStart, OfADriverFromRestIsNoForbiddenVelocity) {
  const std::string file = temporary("driven.json");
  for (const bool turns : {false, true}) {
    write_text(file, R"({"format": "taut-scene/1", "bodies": [{"name": "w", "mass": 1, "inertia": [1, 1, 1],
        "angular_velocity": [0, 0, )" +
                         std::string(turns ? "0.25" : "0") +
                         R"(]}, {"name": "free", "mass": 1, "inertia": [1, 1, 1],
        "velocity": [0, 0, 1]}],
      "joints": [{"name": "axle", "type": "hinge", "a": "ground", "b": "w", "anchor": [0, 0, 0], "axis": [0, 0, 1]},
        {"name": "crank", "type": "driver", "of": {"joint": "axle", "axis": "angle"}, "motion": {"linear": {"rate": 1}}}]})");
    const std::string out = run_program({"check", file}).out;
    EXPECT_EQ(out.find("0.75 rad/s") != std::string::npos, turns) << out;
    EXPECT_EQ(out.find("driver crank\n") != std::string::npos, turns) << out;
  }
}

/// 1.7e7 m away numbers are 1.9e-9 m apart: the joints cannot be closed to 1e-10 m, and the gap is not 0.
TEST(ProgramStart, FarFromTheOriginIsSaidAndItsGapReported) {
  const std::string file = temporary("far.json"), report_file = temporary("far_report.json");
  for (const bool far : {false, true}) {
    const std::string at = far ? "12345678.9" : "1.9";
    write_text(
        file,
        R"({"format": "taut-scene/1", "duration": 0.01, "generate": [{"builder": "chain", "prefix": "c/",
      "parameters": {"n": 5}, "position": [)" +
            at + ", " + at + ", " + at + R"(], "orientation": {"rpy_deg": [10, 20, 30]}}]})");
    expect_words(run_program({"check", file}).out,
                 {far ? "warning: bodies are so far from the origin" : "fine"});
    const Outcome run = run_program({"run", file, "--report", report_file});
    const Json report = Json::parse(read_text(report_file));
    EXPECT_EQ(report["status"] == "success", !far) << report["message"];
    EXPECT_EQ(report["warnings"].size(), far ? 1u : 0u);
    const double gap = report["max_joint_error_m"].get<double>();
    if (far) {
      EXPECT_GT(gap, 1e-10);
      EXPECT_LT(gap, 1e-8);
      expect_words(report["message"], {"ball c/"});
    } else {
      EXPECT_LT(gap, 1.5e-10);
    }
  }
}

}  // namespace
}  // namespace taut::testing::program_settings_test
