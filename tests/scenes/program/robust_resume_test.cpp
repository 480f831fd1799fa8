#include <gtest/gtest.h>

#include <map>
#include <sstream>

#include "core/state/same_state.h"
#include "scenes/files/scene_file.h"
#include "scenes/files/scene_source.h"
#include "solvers/simulator/simulator.h"
#include "tests/run_program.h"
#include "tests/source_dir.h"
#include "tests/temporary.h"

// A run that goes on from a checkpoint is the run that was not interrupted, to the last bit, in all that it
// knows.
namespace taut::robust_resume_test {
namespace {

using testing::Outcome;
using testing::run_program;

struct Resumed {
  const char* scene;
  std::map<std::string, double> parameters;
  int steps;         // before the checkpoint, and after it
  double dt = 0;     // 0: the scene's own
  const char* with;  // settings that differ from the scene's
};

void PrintTo(const Resumed& c, std::ostream* out) { *out << c.scene << ' ' << c.with; }

void change(Settings& settings, std::string_view with) {
  const auto has = [&](std::string_view word) { return with.find(word) != std::string_view::npos; };
  if (has("rattle4")) settings.integrator = Integrator::kRattle4;
  if (has("rattle6")) settings.integrator = Integrator::kRattle6;
  if (has("rattle8")) settings.integrator = Integrator::kRattle8;
  if (has("moreau")) settings.integrator = Integrator::kMoreauJean;
  if (has("force-euler")) settings.integrator = Integrator::kForceEuler;
  if (has("force-rk")) settings.integrator = Integrator::kForceRungeKutta;
  if (has("gauss-seidel")) settings.solver = Solver::kGaussSeidel;
  if (has("pairwise")) settings.solver = Solver::kPairwise;
  if (has("propagation")) settings.solver = Solver::kPropagation;
  if (has("implicit")) settings.tension = TensionPolicy::kImplicit;
  if (has("cholmod")) settings.factor = FactorChoice::kCholmod;
  if (has("sleep")) settings.sleep = true, settings.sleep_speed = 1e-2, settings.sleep_time = 0.1;
  if (has("merge")) settings.merge_fixed_joints = true;
}

class RobustResume : public ::testing::TestWithParam<Resumed> {
 protected:
  Scene open() const {
    Scene scene = std::string_view(GetParam().scene).ends_with(".json")
                      ? load_scene_file(testing::source_dir() + "/" + GetParam().scene)
                      : open_scene(GetParam().scene, GetParam().parameters);
    change(scene.settings, GetParam().with);
    if (GetParam().dt > 0) scene.dt = GetParam().dt;
    return scene;
  }
  static void step(Simulator& simulator, double dt, int steps) {
    for (int i = 0; i < steps; ++i) {
      const StepReport& report = simulator.step(dt);
      ASSERT_TRUE(report.ok()) << i << ": " << report.message;
    }
  }
};

TEST_P(RobustResume, TakesTheSameStepsToTheLastBit) {
  const int steps = GetParam().steps;
  Scene whole = open(), broken_off = open(), resumed = open();
  Simulator all(whole.world, whole.settings), first(broken_off.world, broken_off.settings);
  ASSERT_NO_FATAL_FAILURE(step(all, whole.dt, 2 * steps));
  ASSERT_NO_FATAL_FAILURE(step(first, whole.dt, steps));
  const Checkpoint there = first.checkpoint();
  Simulator second(resumed.world, resumed.settings);
  second.restore(Checkpoint::from_bytes(there.bytes()));
  EXPECT_TRUE(same(resumed.world.state(), broken_off.world.state()));
  EXPECT_TRUE(second.checkpoint() == there) << "what was restored is not what was saved";
  for (int i = 0; i < steps; ++i) {
    ASSERT_NO_FATAL_FAILURE(step(first, whole.dt, 1));
    ASSERT_NO_FATAL_FAILURE(step(second, whole.dt, 1));
    ASSERT_TRUE(same(resumed.world.state(), broken_off.world.state())) << "after " << i + 1 << " steps";
    ASSERT_EQ(first.report().newton_iterations, second.report().newton_iterations)
        << "after " << i + 1 << " steps";
    ASSERT_EQ(first.report().counts.factorizations, second.report().counts.factorizations)
        << "after " << i + 1 << " steps";
    ASSERT_EQ(first.report().ledger.total(), second.report().ledger.total()) << "after " << i + 1 << " steps";
  }
  EXPECT_TRUE(same(whole.world.state(), broken_off.world.state())) << "making a checkpoint changes the run";
  EXPECT_TRUE(all.checkpoint() == second.checkpoint());
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, RobustResume,
    ::testing::Values(
        Resumed{"tests/adversary/from_substeps.json", {}, 30, 0, ""},
        Resumed{"tests/adversary/from_m74.json", {}, 30, 0, ""},
        Resumed{"tests/adversary/from_fails_m200058.json", {}, 30, 0, ""},
        Resumed{"chain", {{"n", 20}}, 60, 1. / 240, ""},
        Resumed{"chain", {{"n", 20}}, 60, 1. / 240, "implicit"},
        Resumed{"chain", {{"n", 20}}, 60, 1. / 240, "cholmod"},
        Resumed{"chain", {{"n", 10}}, 30, 1. / 240, "rattle4"},
        Resumed{"chain", {{"n", 10}}, 20, 1. / 240, "rattle6"},
        Resumed{"chain", {{"n", 10}}, 20, 1. / 240, "rattle8"},
        Resumed{"chain", {{"n", 10}}, 60, 1. / 240, "moreau"},
        Resumed{"chain", {{"n", 10}}, 60, 1. / 1000, "force-euler"},
        Resumed{"chain", {{"n", 10}}, 60, 1. / 1000, "force-rk"},
        Resumed{"chain", {{"n", 10}}, 40, 1. / 240, "gauss-seidel"},
        Resumed{"chain", {{"n", 10}}, 40, 1. / 240, "pairwise"},
        Resumed{"chain", {{"n", 10}}, 40, 1. / 240, "propagation"},
        Resumed{"chain-limited", {{"n", 20}}, 60, 0, ""},
        Resumed{"chain-limited", {{"n", 20}}, 40, 0, "moreau"},
        Resumed{"chain-over-cylinder", {{"n", 8}}, 40, 0, ""},
        Resumed{"bridge-balls", {{"n", 10}}, 60, 0, ""},
        Resumed{"bridge-hinge", {{"n", 10}, {"truck", 1}}, 60, 0, "implicit"},
        Resumed{"vehicle-bridge", {{"n", 20}}, 40, 0, ""}, Resumed{"net-flag", {{"n", 6}}, 60, 0, ""},
        Resumed{"net-corners", {{"n", 6}}, 60, 0, "implicit"}, Resumed{"net-friction", {{"n", 5}}, 15, 0, ""},
        Resumed{"net-friction", {{"n", 7}}, 10, 0, ""}, Resumed{"net-catch", {{"n", 6}}, 60, 0, ""},
        Resumed{"net-drag", {{"n", 6}}, 30, 0, ""}, Resumed{"joint-grid", {{"n", 6}}, 40, 0, ""},
        Resumed{"n-four-bar", {{"n", 3}}, 60, 0, ""}, Resumed{"car", {}, 40, 0, ""},
        Resumed{"robot-arm", {}, 40, 0, ""}, Resumed{"crane", {}, 40, 0, ""},
        Resumed{"ragdoll", {}, 60, 0, ""}, Resumed{"ragdoll", {}, 40, 0, "moreau"},
        Resumed{"ragdoll-stairs", {{"n", 2}}, 80, 0, ""},
        Resumed{"ragdoll-stairs", {{"n", 2}}, 40, 0, "gauss-seidel"}, Resumed{"stack", {{"n", 8}}, 60, 0, ""},
        Resumed{"stack", {{"n", 8}}, 60, 0, "sleep"}, Resumed{"wall", {{"n", 4}}, 60, 0, ""},
        Resumed{"wall", {{"n", 4}}, 60, 0, "sleep"}, Resumed{"pile", {{"n", 15}}, 100, 0, ""},
        Resumed{"stack", {{"n", 5}}, 40, 0, "moreau"}, Resumed{"heap", {{"n", 10}}, 60, 0, "sleep"},
        Resumed{"tank", {}, 20, 0, ""}, Resumed{"suspension-bridge", {}, 30, 0, ""},
        Resumed{"suspension-bridge", {}, 30, 0, "merge"}, Resumed{"car", {}, 40, 0, "merge"},
        Resumed{"tank", {}, 15, 0, "merge"}, Resumed{"scenes/examples/governor.json", {}, 60, 0, ""},
        Resumed{"scenes/examples/marble_run.json", {}, 100, 0, ""},
        Resumed{"scenes/examples/spring_mass.json", {}, 60, 0, ""},
        Resumed{"scenes/examples/cardan_shaft.json", {}, 60, 0, ""},
        Resumed{"scenes/examples/bricard.json", {}, 60, 0, ""}));

/// Three boxes on breaking hinges; the first breaks at the step before the checkpoint.
class RobustCheckpoint : public ::testing::Test {};

TEST_F(RobustCheckpoint, OfAStepInWhichAJointBreaksGoesOnToTheSameBits) {
  const auto make = [] {
    Scene scene = open_scene("chain", {{"n", 6}});
    scene.world.set_break(JointId{3}, BreakLimits{.force = 3});
    return scene;
  };
  for (const char* with : {"", "merge", "sleep"}) {
    Scene a = make(), b = make();
    change(a.settings, with), change(b.settings, with);
    Simulator first(a.world, a.settings);
    int steps = 0;
    while (first.step(1e-3).ok() && first.report().breaks.empty()) ASSERT_LT(++steps, 5000);
    ASSERT_TRUE(first.report().exact()) << first.report().message;
    const Checkpoint there = first.checkpoint();
    Simulator second(b.world, b.settings);
    second.restore(there);
    EXPECT_FALSE(b.world.is_attached(JointId{3}));
    for (int i = 0; i < 30; ++i) {
      ASSERT_TRUE(first.step(1e-3).exact() && second.step(1e-3).exact());
      ASSERT_TRUE(same(a.world.state(), b.world.state())) << with << ", step " << i;
    }
  }
}

TEST_F(RobustCheckpoint, IsReadFromAStreamAndRefusesWhatIsDamaged) {
  Scene scene = open_scene("stack", {{"n", 3}});
  Simulator simulator(scene.world, scene.settings);
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(simulator.step(scene.dt).exact());
  const Checkpoint there = simulator.checkpoint();
  std::stringstream stream;
  stream << there << "what follows";
  Checkpoint read;
  stream >> read;
  EXPECT_TRUE(read == there);
  std::string rest;
  std::getline(stream, rest);
  EXPECT_EQ(rest, "what follows");

  for (std::size_t at = 0; at < there.bytes().size(); at += 1 + there.bytes().size() / 97) {
    std::string bytes = there.bytes();
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
    EXPECT_THROW(Checkpoint::from_bytes(bytes), std::invalid_argument) << at;
    EXPECT_THROW(Checkpoint::from_bytes(there.bytes().substr(0, at)), std::invalid_argument) << at;
  }
  EXPECT_THROW(simulator.restore(Checkpoint()), std::invalid_argument);
}

TEST_F(RobustCheckpoint, OfAnotherWorldOrMethodIsRefusedAndChangesNothing) {
  Scene scene = open_scene("stack", {{"n", 3}}), other = open_scene("stack", {{"n", 4}});
  Simulator simulator(scene.world, scene.settings), of_other(other.world, other.settings);
  for (int i = 0; i < 5; ++i)
    ASSERT_TRUE(simulator.step(scene.dt).exact() && of_other.step(other.dt).exact());
  const State before = scene.world.state();
  EXPECT_THROW(simulator.restore(of_other.checkpoint()), std::invalid_argument);
  Settings moreau = scene.settings;
  moreau.integrator = Integrator::kMoreauJean;
  World copy = scene.world;
  Simulator by_moreau(copy, moreau);
  EXPECT_THROW(by_moreau.restore(simulator.checkpoint()), std::invalid_argument);
  EXPECT_TRUE(same(scene.world.state(), before));
  EXPECT_TRUE(same(copy.state(), before));
}

/// By the program, as a user goes on from a file, with probes, reactions and reports asked for.
class RobustProgramResume : public ::testing::TestWithParam<std::pair<std::string, std::string>> {};

TEST_P(RobustProgramResume, SavesTheSameFile) {
  const auto [scene, options] = GetParam();
  const auto run = [&, scene = scene, options = options](std::vector<std::string> more) {
    std::vector<std::string> arguments = {
        "run", scene.ends_with(".json") ? testing::source_dir() + "/" + scene : scene};
    std::istringstream words(options);
    for (std::string word; words >> word;) arguments.push_back(word);
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_program(arguments);
    EXPECT_EQ(outcome.exit_status, 0) << outcome.err;
    EXPECT_EQ(outcome.err.find("--from goes on from the state alone"), std::string::npos) << outcome.err;
  };
  run({"--quiet", "--steps", "40", "--save", testing::temporary("whole.json")});
  run({"--quiet", "--steps", "20", "--save", testing::temporary("half.json")});
  run({"--quiet", "--steps", "20", "--from", testing::temporary("half.json"), "--save",
       testing::temporary("resumed.json"), "--csv", testing::temporary("probes.csv")});
  EXPECT_EQ(testing::read_text(testing::temporary("whole.json")),
            testing::read_text(testing::temporary("resumed.json")));
}

INSTANTIATE_TEST_SUITE_P(Scenes, RobustProgramResume,
                         ::testing::Values(std::pair("tests/adversary/from_substeps.json", ""),
                                           std::pair("pile", "--set n=10"), std::pair("bridge", "--set n=20"),
                                           std::pair("ragdoll-stairs", ""), std::pair("crane", ""),
                                           std::pair("stack", "--set n=4 --sleep"), std::pair("car", "")));

}  // namespace
}  // namespace taut::robust_resume_test
