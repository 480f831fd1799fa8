#include <gtest/gtest.h>

#include "tests/run_program.h"
#include "tests/source_dir.h"
#include "tests/temporary.h"

/// What the program says where something is misspelt.
namespace taut::testing::suggestion_program_test {
namespace {

void expect_hint(const std::vector<std::string>& arguments, const std::string& hint) {
  const Outcome outcome = run_program(arguments);
  std::string line;
  for (const std::string& argument : arguments) line += argument + " ";
  EXPECT_EQ(outcome.exit_status, 2) << line;
  EXPECT_NE(outcome.err.find(hint), std::string::npos) << line << "\n" << outcome.err;
}

TEST(ProgramSuggestions, OfScenesAndTheirParameters) {
  for (const char* command : {"run", "check", "list"})
    expect_hint({command, "brigde"}, R"(did you mean "bridge"? (value: brigde))");
  expect_hint({"run", "bridge", "--set", "trukc=1"}, R"(did you mean "truck"? (value: trukc))");
  expect_hint({"run", "bridge.json"}, R"(there is no such file; did you mean the scene "bridge"?)");
  const std::string own = temporary("swing.json");
  write_text(own, "{}");
  const std::string stem = own.substr(0, own.size() - 5);
  expect_hint({"check", stem + ".jsn"}, "there is no such file; did you mean \"" + own + "\"?");
}

TEST(ProgramSuggestions, OfFiles) {
  const std::string examples = source_dir() + "/scenes/examples/";
  expect_hint({"run", examples + "four_bra.json"}, "did you mean \"" + examples + "four_bar.json\"?");
  expect_hint({"run", "chain", "--from", examples + "net.jsn"}, "did you mean \"" + examples + "net.json\"?");
  expect_hint({"run", temporary("nothing_like_it.json")}, "there is no such file\n");
  write_text(temporary("film.taut"), "");
  expect_hint({"replay", temporary("flim.taut")}, "did you mean \"" + temporary("film.taut") + "\"?");
  write_text(temporary("tube.obj"), "");
  const std::string scene = temporary("scene.json");
  write_text(scene, R"({"format": "taut-scene/1", "ground": {"shapes": [
    {"type": "triangle_mesh", "file": "tueb.obj"}]}})");
  expect_hint({"check", scene}, "there is no such file; did you mean \"" + temporary("tube.obj") + "\"?");
}

TEST(ProgramSuggestions, OfCommandsAndOptions) {
  expect_hint({"rnu", "bridge"}, R"(unknown command "rnu"; did you mean "run"?)");
  expect_hint({"bridge"}, R"(unknown command "bridge"; did you mean "taut run bridge"?)");
  EXPECT_EQ(run_program({"rnu"}).err.find("subcommand is required"), std::string::npos);
  expect_hint({"fly"}, "unknown command \"fly\"\n");
  expect_hint({"run", "bridge", "--tmie", "3"}, R"(there is no option --tmie; did you mean "--time"?)");
  expect_hint({"run", "bridge", "--tmie=3"}, R"(there is no option --tmie; did you mean "--time"?)");
  expect_hint({"run", "bridge", "--integrator", "ratle"}, R"(did you mean "rattle"? (value: ratle))");
  expect_hint({"run", "bridge", "--solver", "gauss_seidel"}, R"(did you mean "gauss-seidel"?)");
}

}  // namespace
}  // namespace taut::testing::suggestion_program_test
