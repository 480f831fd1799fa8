#include "scenes/program/run_recording.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"

namespace taut {
RunRecording::RunRecording(const Scene& scene, const std::string& file, const ExportFiles& exports,
                           double frames_per_second)
    : sampler_(scene), exports_(exports), file_(file) {
  require_not_negative("--frames-per-second", frames_per_second);
  interval_ = frames_per_second > 0 ? 1 / frames_per_second : 0;
  next_ = scene.world.time();
  if (file_.empty()) {
    temporary_folder_.emplace("--html and others");
    file_ = temporary_folder_->path() / "run.taut";
  }
  writer_.emplace(file_, sampler_.header(frames_per_second));
}

void RunRecording::take(Simulator& simulator) {
  last_ = simulator.world().time();
  writer_->append(sampler_.sample(simulator));
}

std::string RunRecording::sample(Simulator& simulator) {
  const double time = simulator.world().time();
  if (failed_ || time < next_ - 5e-7) return {};
  // A step may pass several instants; the frame is of the last of them.
  if (interval_ > 0) next_ += interval_ * std::max(1.0, std::floor((time + 5e-7 - next_) / interval_) + 1);
  take(simulator);
  failed_ = !writer_->error().empty();
  return writer_->error();
}

ExportOutcome RunRecording::finish(Simulator& simulator, const std::string& status,
                                   const std::string& message) {
  ExportOutcome outcome;
  if (!failed_ && simulator.world().time() > last_) take(simulator);
  if (!writer_->finish(status, message) && !failed_) outcome.errors.push_back(writer_->error());
  if (!exports_.any()) return outcome;
  try {
    RecordingReader reader(file_);
    ExportOutcome exported = export_recording(reader, exports_);
    outcome.errors.insert(outcome.errors.end(), exported.errors.begin(), exported.errors.end());
    outcome.notes = std::move(exported.notes);
  } catch (const std::exception& error) {
    outcome.errors.push_back(error.what());
  }
  return outcome;
}

}  // namespace taut
