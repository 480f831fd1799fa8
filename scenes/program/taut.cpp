/// The program: taut run | replay | check | new | schema | import | export | list | accuracy | friction |
/// bench.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <iostream>
#include <system_error>

#include "scenes/files/scene_source.h"
#include "scenes/import/import.h"
#include "scenes/program/accuracy_command.h"
#include "scenes/program/bench_command.h"
#include "scenes/program/check_command.h"
#include "scenes/program/export_command.h"
#include "scenes/program/friction_command.h"
#include "scenes/program/import_command.h"
#include "scenes/program/list_command.h"
#include "scenes/program/new_command.h"
#include "scenes/program/replay_command.h"
#include "scenes/program/run_command.h"
#include "scenes/program/version_text.h"
#include "scenes/support/output_file.h"
#include "scenes/support/printable_stream.h"
#include "scenes/support/suggestion.h"
#include "solvers/common/setting_names.h"

namespace {

/// Everything that can be asked for on the command line.
struct Arguments {
  taut::RunOptions run;
  taut::AccuracyOptions accuracy;
  taut::FrictionOptions friction;
  taut::NewOptions fresh;
  std::string list_name;
  std::string check_scene;
  bool check_all = false;
  std::string model, imported;
  std::string export_scene, exported;
  std::string recording, beside;
  taut::ExportFiles replay;
  bool replay_quietly = false;
  taut::BenchOptions bench;
  std::vector<std::string> run_assignments, check_assignments, export_assignments;
};

void add_scene(CLI::App& command, std::string& scene, std::vector<std::string>& assignments) {
  command
      .add_option("scene", scene,
                  "name of a scene (see `taut list`), a scene file, or a model: URDF, SDF, MJCF")
      ->required();
  command.add_option("--set", assignments, "a parameter of the scene, key=value; may be repeated")
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
}

template <typename Choice, std::size_t count>
void add_choice(CLI::App& command, const std::string& option, std::optional<Choice>& value,
                const std::pair<const char*, Choice> (&names)[count], const std::string& description) {
  std::string all;
  std::vector<std::string> known;
  for (const auto& [name, choice] : names) {
    all += std::string(all.empty() ? "" : "|") + name;
    known.emplace_back(name);
  }
  command
      .add_option_function<std::string>(
          option,
          [&value, &names, option, all, known](const std::string& text) {
            for (const auto& [name, choice] : names)
              if (name == text) value = choice;
            if (!value)
              throw CLI::ValidationError(option, "must be one of " + all + taut::did_you_mean(text, known) +
                                                     " (value: " + text + ")");
          },
          description)
      ->type_name(all);
}

void add_exports(CLI::App& command, taut::ExportFiles& files) {
  command.add_option("--html", files.html, "write a page that shows the simulation in any browser")
      ->type_name("FILE");
  command.add_option("--gltf", files.gltf, "write an animation for Blender and others, glTF 2.0")
      ->type_name("FILE.glb");
  command.add_option("--vtk", files.vtk_folder, "write series of surfaces and joints for ParaView")
      ->type_name("DIR");
  command.add_option("--plot", files.plot, "write energy, gap and probes over time as an image")
      ->type_name("FILE.svg");
}

void add_run(CLI::App& app, Arguments& arguments) {
  CLI::App& run = *app.add_subcommand("run", "run a scene");
  taut::RunOptions& options = arguments.run;
  add_scene(run, options.scene, arguments.run_assignments);
  run.add_option("--dt", options.dt, "length of a step [s]")->type_name("SECONDS");
  run.add_option("--time", options.time, "time to simulate [s]; rounded to whole steps")
      ->type_name("SECONDS");
  run.add_option("--steps", options.steps, "number of steps, in place of --time")->type_name("NUMBER");
  add_choice(run, "--integrator", options.integrator, taut::kIntegratorNames, "how a step is done");
  add_choice(run, "--tension", options.tension, taut::kTensionNames, "what is done where tension is stiff");
  add_choice(run, "--drift-cure", options.drift_cure, taut::kDriftCureNames,
             "what keeps the joints of a force-level integrator or of moreau-jean closed");
  for (std::size_t i = 0; i < options.numbers.size(); ++i)
    run.add_option(taut::kNumberOptions[i].option, options.numbers[i], taut::kNumberOptions[i].help)
        ->type_name("NUMBER");
  add_choice(run, "--factor", options.factor, taut::kFactorNames, "how the system matrix is factored");
  add_choice(run, "--solver", options.solver, taut::kSolverNames,
             "how impulses are found: with the factor, or one after the other, to compare with");
  run.add_option("--iterations", options.iterations, "sweeps of an iterative solver per stage, default 50")
      ->type_name("NUMBER");
  run.add_option("--threads", options.threads,
                 "for contacts and large systems, default: as many as the machine has")
      ->type_name("NUMBER");
  run.add_flag("--sleep", options.sleep, "let islands of bodies at rest sleep until something wakes them");
  run.add_flag("--merge-fixed-joints", options.merge_fixed_joints,
               "let bodies that fixed joints hold together move as one");
  run.add_flag("--locate-plastic-impacts", options.locate_plastic_impacts,
               "let impacts without restitution end a sub-step when they happen, too");
  run.add_option("--report", options.report_file, "write a JSON report")->type_name("FILE");
  run.add_option("--csv", options.csv_file, "write the probes over time, a line per step")->type_name("FILE");
  run.add_option("--poses", options.poses_file, "write the poses of all bodies over time")->type_name("FILE");
  run.add_option("--save", options.save_file, "write the state at the end and every minute, to go on from")
      ->type_name("FILE");
  run.add_option("--from", options.from_file, "start from a state that --save wrote")->type_name("FILE");
  run.add_option("--poses-interval", options.poses_interval, "time between two sets of poses; 0: every step")
      ->type_name("SECONDS");
  run.add_option("--record", options.record_file, "write a recording, for `taut replay`")->type_name("FILE");
  run.add_option("--frames-per-second", options.frames_per_second,
                 "of the recording and what is made from it, default 60; 0: every step")
      ->type_name("NUMBER");
  add_exports(run, options.exports);
  run.add_option_function<std::string>(
         "--live", [&options](const std::string& text) { options.live.port = text; },
         "show the run in a browser of this machine while it goes on: pause, step, pull bodies, turn motors; "
         "until Ctrl-C, or --time; default: any free port")
      ->expected(0, 1)
      ->default_str("0")
      ->type_name("[PORT]");
  run.add_option_function<std::string>(
         "--live-address", [&options](const std::string& text) { options.live.address = text; },
         "serve --live at this address, for other machines; the link that is printed has a secret token")
      ->type_name("ADDRESS");
  run.add_option("--dump-stages", options.stages_folder,
                 "write the friction problem of each step's last stages with contacts, for `taut friction`")
      ->type_name("DIR");
  CLI::Option& quiet = *run.add_flag("--quiet", options.quiet, "print nothing but errors");
  run.add_flag("--verbose", options.verbose,
               "print sizes, solver, times, counts and phases after the eight lines of the summary")
      ->excludes(&quiet);
}

/// A file, or nothing for the standard output.
void add_output(CLI::App& command, const std::string& option, std::optional<std::string>& file,
                const std::string& description) {
  command
      .add_option_function<std::string>(
          option, [&file](const std::string& text) { file = text; }, description)
      ->expected(0, 1)
      ->default_str("-")
      ->type_name("[FILE]");
}

void add_accuracy(CLI::App& app, Arguments& arguments) {
  CLI::App& accuracy = *app.add_subcommand(
      "accuracy", "compare with reference values: errors and tolerances of every quantity");
  taut::AccuracyOptions& options = arguments.accuracy;
  accuracy.add_option("--references", options.references, "folder of cases; default: tests/references")
      ->type_name("DIR");
  accuracy.add_option("--only", options.only, "cases with this in their name");
  add_choice(accuracy, "--integrator", options.integrator, taut::kIntegratorNames,
             "how steps are done; default: rattle4, or rattle with limits, motors, friction and contacts");
  add_choice(accuracy, "--factor", options.factor, taut::kFactorNames, "how the system matrix is factored");
  accuracy.add_option("--jobs", options.jobs, "cases at the same time; default: one per core");
  accuracy.add_flag("--summary", options.summary, "print a line per case, and what failed");
  add_output(accuracy, "--json", options.json, "write JSON, without FILE in place of the table");
  add_output(accuracy, "--csv", options.csv, "write CSV, without FILE in place of the table");
  CLI::Option& study =
      *accuracy
           .add_option("--study", options.study,
                       "in place of the cases: convergence of all integrators and a comparison of methods, "
                       "as tables and pictures")
           ->type_name("DIR");
  for (const char* of_cases :
       {"--only", "--integrator", "--factor", "--jobs", "--summary", "--json", "--csv"})
    study.excludes(of_cases);
  CLI::Option& contacts = *accuracy.add_flag(
      "--contacts", options.contacts,
      "in place of the cases: worlds with contact against closed forms and laws, in about ten seconds");
  for (const char* of_cases : {"--references", "--integrator", "--factor", "--study"})
    contacts.excludes(of_cases);
}

void add_friction(CLI::App& app, taut::FrictionOptions& options) {
  CLI::App& friction = *app.add_subcommand(
      "friction", "solve problems of frictional contact, w = W r + q, from files of Siconos or FCLIB");
  friction.add_option("files", options.files, "text, or HDF5; local (W, q, mu) or global (M, H, f, b, mu)")
      ->required();
  friction.add_option("--accuracy", options.accuracy, "largest residual of a solution, default 1e-8");
  add_output(friction, "--json", options.json, "write JSON, without FILE in place of the table");
  friction
      .add_option("--solution", options.solution_folder,
                  "write the impulses, a contact a line, normal first, as FILE.txt")
      ->type_name("DIR");
}

void add_bench(CLI::App& app, taut::BenchOptions& options) {
  CLI::App& bench = *app.add_subcommand(
      "bench", "the scenes in all engines that are installed, and the benchmark programs");
  bench.add_flag("--quick", options.quick, "small scenes only, less than three minutes");
  bench.add_flag(
      "--work", options.work,
      "taut alone, nets, bridges, chains and grids of all sizes: stages, fill, operations, memory");
  bench.add_flag("--contact", options.contact, "only the scenes with contact, in all engines");
  bench.add_flag("--friction", options.friction,
                 "only friction problems, in taut's solver and those of Siconos; more files after --");
  bench.add_option("--only", options.only, "scenes, or benchmark programs, with this in their name");
  bench
      .add_option("--results", options.results,
                  "folder for JSON, page and pictures; default: bench in the build")
      ->type_name("DIR");
  bench
      .add_option("--compare", options.compare, "results of an earlier run; fails if taut has become slower")
      ->type_name("OLD.json");
  bench.add_option("--limit", options.limit, "processor time of each run")->type_name("SECONDS");
  bench.add_option("--factor", options.factor, "how much slower is too slow; default 1.5")
      ->needs("--compare");
  bench.add_option("--build-dir", options.build_dir, "where they were built; default: beside the program");
  bench.add_option("arguments", options.arguments, "after --: passed to each benchmark program");
}

void add_others(CLI::App& app, Arguments& arguments) {
  CLI::App& replay = *app.add_subcommand("replay", "turn a recording into something to look at");
  replay.add_option("recording", arguments.recording, "file that `taut run --record` has written")
      ->required();
  replay.add_option("beside", arguments.beside, "another one: a page (--html) shows both side by side");
  add_exports(replay, arguments.replay);
  replay.add_option("--csv", arguments.replay.csv, "write energies, gap and probes over time")
      ->type_name("FILE");
  replay.add_flag("--quiet", arguments.replay_quietly, "print nothing but errors");
  CLI::App& check =
      *app.add_subcommand("check", "look for mistakes in a scene; count freedoms, name redundant rows");
  add_scene(check, arguments.check_scene, arguments.check_assignments);
  check.add_flag("--all", arguments.check_all, "name all redundant rows, not the first 20 only");
  CLI::App& fresh = *app.add_subcommand("new", "write a commented scene file to begin with");
  fresh.add_option("file", arguments.fresh.file, "scene file to write, .json");
  fresh.add_option("--template", arguments.fresh.name, "one of --list; default: machine")->type_name("NAME");
  fresh.add_flag("--list", arguments.fresh.list, "list the templates");
  fresh.add_flag("--force", arguments.fresh.force, "write over a file that is there");
  app.add_subcommand("schema", "print the JSON Schema of scene files, for editors");
  CLI::App& import = *app.add_subcommand(
      "import", "a model of a robot, URDF, SDF or MJCF, as a scene file; lists what has no counterpart");
  import.add_option("model", arguments.model, "a .urdf, .sdf or .xml file")->required();
  import.add_option("-o,--output", arguments.imported, "scene file to write; default: the standard output")
      ->type_name("FILE.json");
  CLI::App& as_model =
      *app.add_subcommand("export", "a scene as a model, URDF or MJCF; lists what has no counterpart");
  add_scene(as_model, arguments.export_scene, arguments.export_assignments);
  as_model.add_option("-o,--output", arguments.exported, "model to write: .urdf, or .xml for MJCF")
      ->required()
      ->type_name("FILE");
  CLI::App& list = *app.add_subcommand("list", "list the scenes with their parameters");
  list.add_option("scene", arguments.list_name, "only this one");
  add_friction(app, arguments.friction);
  add_bench(app, arguments.bench);
}

/// `program` is how it was called, and `words` what was typed after the name of the command.
int dispatch(const CLI::App& app, Arguments& arguments, const std::string& program,
             const std::vector<std::string>& words) {
  if (app.got_subcommand("run")) {
    for (const std::string& assignment : arguments.run_assignments)
      taut::add_parameter(arguments.run.parameters, assignment);
    arguments.run.program = program;
    arguments.run.words = words;
    return taut::run_command(arguments.run);
  }
  if (app.got_subcommand("replay"))
    return taut::replay_command(arguments.recording, arguments.beside, arguments.replay,
                                arguments.replay_quietly);
  const auto parameters = [](const std::vector<std::string>& assignments) {
    std::map<std::string, double> values;
    for (const std::string& assignment : assignments) taut::add_parameter(values, assignment);
    return values;
  };
  if (app.got_subcommand("check"))
    return taut::check_command(arguments.check_scene, parameters(arguments.check_assignments),
                               arguments.check_all);
  if (app.got_subcommand("export"))
    return taut::export_command(arguments.export_scene, parameters(arguments.export_assignments),
                                arguments.exported);
  if (app.got_subcommand("import")) return taut::import_command(arguments.model, arguments.imported);
  arguments.fresh.program = program;
  if (app.got_subcommand("new")) return taut::new_command(arguments.fresh);
  if (app.got_subcommand("schema")) return taut::schema_command();
  if (app.got_subcommand("list")) {
    std::cout << taut::list_scenes(arguments.list_name);
    return taut::kExitSuccess;
  }
  if (app.got_subcommand("accuracy")) return taut::accuracy_command(arguments.accuracy);
  if (app.got_subcommand("friction")) return taut::friction_command(arguments.friction);
  return taut::bench_command(arguments.bench);
}

/// Nothing, or a sentence on the command that may be meant.
std::string meant_command(const CLI::App& app, const std::string& given) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands(nullptr)) names.push_back(command->get_name());
  if (std::string meant = taut::did_you_mean(given, names); !meant.empty()) return meant;
  const bool scene = taut::is_scene_or_model_file(given) ||
                     std::ranges::any_of(taut::scene_catalogue(),
                                         [&](const taut::SceneInfo& info) { return info.name == given; });
  return scene ? "; did you mean \"taut run " + given + "\"?" : "";
}

/// What may be meant by options that the command does not have, a line each.
void suggest_options(const CLI::App& app) {
  for (const CLI::App* command : app.get_subcommands()) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command->get_options())
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& given : command->remaining())
      if (given.starts_with("--"))
        if (const std::string name = given.substr(0, given.find('=')),
            meant = taut::did_you_mean(name, names);
            !meant.empty())
          std::cerr << "taut: there is no option " << name << meant << '\n';
  }
}

int run_program(int argc, char** argv) {
  CLI::App app("taut: rigid multibody systems with very many joints, solved directly", "taut");
  app.set_version_flag("--version", taut::version_text,
                       "what this program is, and what was built into it, and exit");
  app.require_subcommand(1);
  Arguments arguments;
  add_run(app, arguments);
  add_accuracy(app, arguments);
  add_others(app, arguments);
  try {
    app.parse(argc, argv);
  } catch (const CLI::RequiredError& error) {
    // CLI11 asks for a command even where one was given that it does not know.
    const bool unknown = app.get_subcommands().empty() && argc > 1 && argv[1][0] != '-';
    if (unknown) {
      std::cerr << "taut: unknown command \"" << argv[1] << '"' << meant_command(app, argv[1])
                << "\ntaut --help shows all\n";
      return taut::kExitUsage;
    }
    suggest_options(app);
    app.exit(error);
    return taut::kExitUsage;
  } catch (const CLI::ParseError& error) {
    suggest_options(app);
    return app.exit(error) == 0 ? taut::kExitSuccess : taut::kExitUsage;
  }
  try {
    return dispatch(app, arguments, argv[0], {argv + 2, argv + argc});
  } catch (const std::invalid_argument& error) {
    std::cerr << "taut: " << error.what() << '\n';
    return taut::kExitUsage;
  } catch (const std::exception& error) {
    std::cerr << "taut: " << error.what() << '\n';
    return taut::kExitFailure;
  }
}

/// What was printed must have arrived: a full disk is a failure.
int status_after_output(int status) {
  errno = 0;
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::cout && !std::ferror(stdout)) return status;
  const std::string reason = errno == 0 ? "" : ": " + std::generic_category().message(errno);
  std::cerr << "taut: cannot write to the standard output" << reason << '\n';
  return status == taut::kExitSuccess ? taut::kExitFailure : status;
}

}  // namespace

int main(int argc, char** argv) {
  taut::reserve_standard_streams();
  const taut::PrintableStream out(std::cout), err(std::cerr);
  return status_after_output(run_program(argc, argv));
}
