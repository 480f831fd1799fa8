#include "scenes/program/run_command.h"

#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>

#include "core/base/check.h"
#include "core/base/clock.h"
#include "scenes/export/html_export.h"
#include "scenes/export/pose_trace.h"
#include "scenes/files/scene_source.h"
#include "scenes/files/state_file.h"
#include "scenes/import/import.h"
#include "scenes/program/interrupt.h"
#include "scenes/program/live_run.h"
#include "scenes/program/progress_bar.h"
#include "scenes/program/run_record.h"
#include "scenes/program/run_recording.h"
#include "scenes/program/run_report.h"
#include "scenes/program/run_settings.h"
#include "scenes/program/run_summary.h"
#include "scenes/program/stage_dump.h"
#include "scenes/program/start_warnings.h"
#include "scenes/recording/gap_meter.h"
#include "scenes/recording/recorder.h"
#include "scenes/support/file_ending.h"
#include "scenes/support/format.h"
#include "scenes/support/output_file.h"
#include "scenes/support/temporary_folder.h"
#include "solvers/common/setting_checks.h"
#include "solvers/common/setting_names.h"
#include "solvers/simulator/simulator.h"

namespace taut {
namespace {

constexpr double kFramesPerSecond = 60;
constexpr std::int64_t kMostSteps = 1'000'000'000'000;
/// Gaps beyond this [m or rad] are worth a warning with integrators that allow them.
constexpr double kWideOpen = 1e-3;
/// Between two saves of the state [s] of wall time.
constexpr double kSavePeriod = 60;
/// A step is finished after a signal if that takes no longer [s]; a checkpoint is made before steps that do.
constexpr double kLongStep = 0.5;

/// The files that a run writes.  All are asked for before the run, so that it cannot fail at its end for want
/// of a folder; none is touched before it is known that the run can start.
class Outputs {
 public:
  /// Asks whether all can be written; what is there stays as it is.
  /// @throws std::invalid_argument naming the option if not.
  static void check(const RunOptions& options) {
    check_distinct(options);
    require_not_negative("--poses-interval", options.poses_interval.value_or(0));
    require_not_negative("--frames-per-second", options.frames_per_second.value_or(0));
    require_ending("--report", options.report_file, FileKind::kJson);
    require_ending("--csv", options.csv_file, FileKind::kTable);
    require_ending("--poses", options.poses_file, FileKind::kTable);
    require_ending("--save", options.save_file, FileKind::kJson);
    require_ending("--record", options.record_file, FileKind::kRecording);
    require_folder_name("--dump-stages", options.stages_folder);
    require_writable("--report", options.report_file);
    require_writable("--csv", options.csv_file);
    require_writable("--poses", options.poses_file);
    require_writable("--save", options.save_file);
    require_writable("--record", options.record_file);
    require_writable_folder("--dump-stages", options.stages_folder);
    check_exports(options.exports);
    if (options.live.wanted()) (void)live_server_options(options.live), (void)find_three();
  }

  Outputs(const RunOptions& options, const Scene& scene, Simulator& simulator) {
    if (!options.csv_file.empty()) {
      csv_.emplace(options.csv_file, OutputFile::Way::kStreamed);
      if (!csv_->error().empty()) fail("--csv", "cannot write the file", csv_->error());
    }
    save_file_ = options.save_file;
    if (!options.poses_file.empty())
      poses_ = std::make_unique<PoseTrace>(options.poses_file, options.poses_interval.value_or(0));
    if (!options.record_file.empty() || options.exports.any())
      recording_ = std::make_unique<RunRecording>(scene, options.record_file, options.exports,
                                                  options.frames_per_second.value_or(kFramesPerSecond));
    if (!options.stages_folder.empty()) {
      stages_ = std::make_unique<StageDump>(options.stages_folder);
      stages_->watch(simulator);
    }
  }

  void header(const Recorder& recorder) {
    if (!csv_) return;
    csv_->out() << "time";
    for (const std::string& column : recorder.columns()) csv_->out() << ',' << csv_field(column);
    csv_->out() << '\n';
  }
  /// Of a step, whatever became of it.
  void stages(std::int64_t step) {
    if (stages_) note_unwritten(stages_->write(step));
  }
  void sample(Recorder& recorder, Simulator& simulator) {
    if (poses_) poses_->record(simulator.world());
    if (!save_file_.empty() && seconds_since(last_save_) > kSavePeriod) (void)save(simulator);
    if (recording_) note_failure(recording_->sample(simulator));
    if (!csv_) return;
    csv_->out() << shortest(simulator.world().time());
    for (double value : recorder.sample(simulator)) csv_->out() << ',' << shortest(value);
    csv_->out() << '\n';
  }
  /// Ends the recording, writes the report and closes all files.  What could not be written is among
  /// errors() then.
  void finish(const RunOptions& options, Simulator& simulator, const RunRecord& record,
              const Recorder& recorder, const std::vector<double>& last) {
    if (recording_) finish_recording(simulator, record);
    if (!save_file_.empty() && !save(simulator)) save_elsewhere(simulator);
    if (csv_ && !csv_->finish()) note_unwritten(csv_->error());
    if (poses_) note_unwritten(poses_->finish());
    if (!options.report_file.empty()) {
      nlohmann::ordered_json report = run_report(record, recorder, last, simulator.world());
      for (const std::string& error : errors_) report["warnings"].push_back(error);
      note_unwritten(
          write_output(options.report_file,
                       report.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n'));
    }
  }
  const std::vector<std::string>& errors() const { return errors_; }

 private:
  bool save(Simulator& simulator) {
    last_save_ = Clock::now();
    const std::string error = save_state_file(simulator, save_file_);
    note_unwritten(error);
    return error.empty();
  }
  /// The last state is not to be lost because a disk is full.
  void save_elsewhere(Simulator& simulator) {
    std::string place;
    try {
      place = free_temporary_name("taut-save", ".json");
    } catch (const std::exception& error) {
      return note_failure(std::string("nor could the state be saved elsewhere: ") + error.what());
    }
    const std::string error = save_state_file(simulator, place);
    if (!error.empty()) std::remove(place.c_str());
    note_failure(error.empty() ? "the state is saved in " + place + " instead"
                               : "nor could the state be saved in " + error);
  }
  void note_unwritten(const std::string& error) {
    if (!error.empty()) note_failure("could not write " + error);
  }
  void note_failure(const std::string& error) {
    if (error.empty()) return;
    std::cerr << "taut: " << error << '\n';
    errors_.push_back(error);
  }
  void finish_recording(Simulator& simulator, const RunRecord& record) {
    const ExportOutcome outcome = recording_->finish(simulator, record.status, record.message);
    for (const std::string& error : outcome.errors) note_failure(error);
    for (const std::string& note : outcome.notes) std::cerr << "taut: " << note << '\n';
  }
  static void check_distinct(const RunOptions& options) {
    std::vector<NamedFile> inputs;
    if (is_scene_or_model_file(options.scene)) inputs.push_back({"the scene", options.scene});
    if (options.from_file != options.save_file) inputs.push_back({"--from", options.from_file});
    require_distinct({{"--report", options.report_file},
                      {"--csv", options.csv_file},
                      {"--poses", options.poses_file},
                      {"--save", options.save_file},
                      {"--record", options.record_file},
                      {"--html", options.exports.html},
                      {"--gltf", options.exports.gltf},
                      {"--plot", options.exports.plot},
                      {"--vtk", options.exports.vtk_folder}},
                     inputs);
  }

  std::optional<OutputFile> csv_;
  std::unique_ptr<PoseTrace> poses_;
  std::unique_ptr<RunRecording> recording_;
  std::unique_ptr<StageDump> stages_;
  std::vector<std::string> errors_;
  std::string save_file_;
  Clock::time_point last_save_ = Clock::now();
};

/// With what a state file remembers of the steps before.
std::pair<Scene, SavedMemory> prepared_scene(const RunOptions& options) {
  if (options.dt) require_positive("--dt", *options.dt);
  if (options.time) require_positive("--time", *options.time);
  std::vector<ImportNotice> notices;
  Scene scene = open_scene_or_model(options.scene, options.parameters, &notices);
  if (!notices.empty() && !options.quiet)
    std::cerr << "taut: " << notices_in_short(notices.size(), options.scene) << "`taut import` lists them\n";
  if (!is_scene_or_model_file(options.scene))
    scene.name = options.scene;  // `bridge`, not what it is short for
  SavedMemory memory;
  if (!options.from_file.empty()) memory = load_state_file(scene.world, options.from_file);
  if (options.dt) scene.dt = *options.dt;
  apply_settings(options, scene.settings);
  return {std::move(scene), std::move(memory)};
}

void note_failure(RunRecord& record, const StepReport& report, const World& world, const std::string& when) {
  record.status = to_string(report.status);
  record.message = when + ": " + report.message;
  record.contradiction = names_of(report.contradiction, world);
  record.contradiction_residual = report.contradiction.residual;
}

void note_interruption(RunRecord& record, std::int64_t steps) {
  record.status = to_string(Status::kInterrupted);
  record.message = "stopped by a signal after step " + std::to_string(steps);
}

/// What should be known before the table at the end says it.
void warn(const std::string& warning) { std::cerr << "taut: warning: " << warning << std::endl; }

/// Of a run in which no step failed.
void note_end(RunRecord& record, const World& world) {
  if (!record.ended_by.empty())
    record.message = "ended by event " + record.ended_by + " at t = " + shortest(world.time()) + " s";
  if (record.inexact_steps == 0) return;
  record.status = to_string(Status::kInexact);
  record.message += (record.message.empty() ? "in " : "; in ") + std::to_string(record.inexact_steps) +
                    " of " + std::to_string(record.steps) +
                    " steps the laws of contacts, friction and limits are met to " +
                    format("%.1e", record.max_complementarity_residual) + " of the largest impulse only";
}

/// Steps until the end, a failure or a signal.
void run_steps(RunRecord& record, Simulator& simulator, GapMeter& meter, Recorder& recorder, Outputs& outputs,
               LiveRun* live, bool quiet) {
  const World& world = simulator.world();
  ProgressBar bar(record.steps_asked, record.dt, !quiet && !live);
  Checkpoint before;  // a step that is given up takes the memory of those before it along
  for (std::int64_t i = 0; i < record.steps_asked; ++i) {
    if ((live && !live->before_step(record.dt)) || InterruptGuard::signal() != 0)
      return note_interruption(record, i);
    const auto start = Clock::now();
    const StepReport& report = simulator.step(record.dt);
    const double seconds = seconds_since(start);
    outputs.stages(i + 1);
    if (report.status == Status::kInterrupted) {
      record.add(report, seconds, {}, 0);
      if (!before.empty()) simulator.restore(before);
      return note_interruption(record, i);
    }
    const double energy =
        simulator.settings().report_energy ? report.energy() : total_energy(world, world.state());
    const Gap gap = meter.largest(world);
    record.add(report, seconds, gap, energy);
    record.note_breaks(report, world);
    const bool ended = record.note_events(report);
    record.note_inexact(report, world);
    if (report.ok()) record.note_axes(simulator);
    for (const std::string& warning : record.note_detection(report, world)) warn(warning);
    if (!report.ok()) {
      return note_failure(record, report, world,
                          "step " + std::to_string(i + 1) + " from t = " + shortest(world.time()) + " s");
    }
    outputs.sample(recorder, simulator);
    if (live) live->after_step();
    bar.update(i + 1, gap);
    if (ended) break;
    before = seconds > kLongStep ? simulator.checkpoint() : Checkpoint();
  }
  note_end(record, world);
}

/// All steps, with what is written while they go on.  What is thrown is the end of the run.
/// @returns the last values of the probes
std::vector<double> run_all(RunRecord& record, Simulator& simulator, GapMeter& meter, Recorder& recorder,
                            Outputs& outputs, LiveRun* live, bool quiet) {
  std::vector<double> last;
  try {
    outputs.header(recorder);
    outputs.sample(recorder, simulator);
    if (record.status == "success") run_steps(record, simulator, meter, recorder, outputs, live, quiet);
    record.redundant_rows = names_of(simulator.report().dependent_rows, simulator.world());
    if (simulator.report().rank) record.note_rank(*simulator.report().rank, simulator.world());
    last = recorder.sample(simulator);
    record.reactions = reactions_fingerprint(simulator);
    record.axis_forces = axis_forces_fingerprint(simulator);
  } catch (const std::exception& error) {
    if (record.status == "success") record.status = "error", record.message = error.what();
  }
  return last;
}

/// Those of the scene, of options and settings without effect, and of what makes a bad start.
std::vector<std::string> warnings_of(const RunOptions& options, const Scene& scene,
                                     const SettingSources& sources) {
  std::vector<std::string> warnings = scene.warnings;
  for (std::string& warning : settings_without_effect(scene.settings, sources))
    warnings.push_back(std::move(warning));
  if (options.poses_interval && options.poses_file.empty())
    warnings.push_back("--poses-interval has no effect without --poses");
  if (options.frames_per_second && options.record_file.empty() && !options.exports.any())
    warnings.push_back("--frames-per-second has no effect without --record, --html, --gltf, --vtk or --plot");
  for (std::string& warning : start_warnings(scene.world, scene.settings, scene.dt))
    warnings.push_back(std::move(warning));
  return warnings;
}

/// Closes joints that may be open at the start.
void assemble(Simulator& simulator, RunRecord& record) {
  const StepReport& report = simulator.assemble();
  if (!report.ok()) note_failure(record, report, simulator.world(), "closing the joints at the start");
}

void add_warnings(RunRecord& record, const World& world, const Settings& settings) {
  for (const Problem& problem : world.validate())
    record.warnings.push_back(problem.subject + ": " + problem.message);
  if (settings.solver == Solver::kDirect && record.solver.find("OpenBLAS") == std::string::npos)
    record.warnings.push_back(
        "OpenBLAS is not the BLAS in use; factorisations will be slower (install libopenblas0-pthread)");
}

/// Force-level integrators promise no closed joints.
void warn_of_open_joints(RunRecord& record, Integrator integrator) {
  if (!is_force_level(integrator) || std::max(record.max_gap.metres, record.max_gap.radians) <= kWideOpen)
    return;
  record.warnings.push_back(format(
      "joints were open by up to %.2g m and %.2g rad: the integrator solves for forces, and joints drift or "
      "are torn open",
      record.max_gap.metres, record.max_gap.radians));
}

/// It goes on until it is stopped.
bool is_endless(const RunOptions& options) {
  return options.live.wanted() && !options.steps && !options.time;
}

/// There is something that is written while the run goes on, so that it cannot go back.
bool writes_while_running(const RunOptions& options) {
  return options.exports.any() || !(options.csv_file + options.poses_file + options.save_file +
                                    options.record_file + options.stages_folder)
                                       .empty();
}

/// @param written all that was asked for
int exit_status(const RunRecord& record, bool written) {
  if (record.status == "success") return written ? kExitSuccess : kExitFailure;
  if (record.status == "interrupted") return kExitSignal + InterruptGuard::signal();
  return kExitFailure;
}

}  // namespace

std::int64_t step_count(const RunOptions& options, const Scene& scene) {
  if (options.steps && options.time) fail("--steps", "cannot be given together with --time", *options.steps);
  if (options.steps && *options.steps <= 0) fail("--steps", "must be positive", *options.steps);
  if (options.steps && *options.steps > kMostSteps) fail("--steps", "must be at most 1e12", *options.steps);
  if (options.steps) return *options.steps;
  if (is_endless(options)) return kMostSteps;
  const double time = options.time.value_or(scene.duration);
  const double steps = std::round(time / scene.dt);
  if (steps < 1) fail(options.time ? "--time" : "duration", "is shorter than half a step", time);
  if (steps > static_cast<double>(kMostSteps))
    fail(options.time ? "--time" : "duration", "takes more than 1e12 steps", time);
  return static_cast<std::int64_t>(steps);
}

int run_command(const RunOptions& options) {
  auto [scene, memory] = prepared_scene(options);
  const SettingSources sources(options, scene);
  require_compatible(scene, sources);
  RunRecord record;
  record.steps_asked = step_count(options, scene);
  GapMeter meter(scene.world);
  Simulator simulator(scene.world, scene.settings);
  simulator.set_events(scene.events);
  const std::string forgets = go_on_from(simulator, scene.world, memory);
  const bool goes_on = !memory.checkpoint.empty() && forgets.empty();
  Recorder recorder(scene.probes);
  const InterruptGuard guard;  // from before there is any output file
  simulator.set_interrupt([] { return InterruptGuard::age() > kLongStep; });
  Outputs::check(options);

  record.warnings = warnings_of(options, scene, sources);
  if (!forgets.empty()) record.warnings.push_back("--from goes on from the state alone: " + forgets);
  if (const std::string warning = passing_warning(scene.world, scene.settings); !warning.empty())
    warn(warning);
  if (scene.assemble && !goes_on) assemble(simulator, record);
  record.integrator = name_of(scene.settings.integrator, kIntegratorNames);
  record.solver = simulator.solver_description();
  record.start(scene, meter.row_count(), total_energy(scene.world, scene.world.state()));
  add_warnings(record, scene.world, scene.settings);
  std::optional<LiveRun> live;
  if (options.live.wanted()) {
    live.emplace(options.live, scene, simulator, !writes_while_running(options));
    std::cerr << "taut: live at " + live->url() + "  (Ctrl-C ends the run)\n" << std::flush;
  }
  Outputs outputs(options, scene, simulator);

  const auto start = Clock::now();
  const std::vector<double> last =
      run_all(record, simulator, meter, recorder, outputs, live ? &*live : nullptr, options.quiet);
  if (live) live->finish(record.status, record.message);
  if (is_endless(options)) record.steps_asked = record.steps;  // no number was asked for
  record.wall_time = seconds_since(start);
  if (record.steps == 0) record.max_gap = meter.largest(scene.world);  // what it could not start from

  warn_of_open_joints(record, simulator.settings().integrator);
  outputs.finish(options, simulator, record, recorder, last);
  if (!options.quiet) std::cout << run_summary(record, how_to_see(options)) << std::flush;
  if (options.verbose) std::cout << run_details(record) << std::flush;
  if (record.status != "success") std::cerr << "taut: " << record.status << ": " << record.message << '\n';
  return exit_status(record, outputs.errors().empty());
}

}  // namespace taut
