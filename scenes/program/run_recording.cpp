#include "scenes/program/run_recording.h"

#include <exception>

#include "core/base/check.h"

namespace taut {

RunRecording::RunRecording(const Scene& scene, const std::string& file, const ExportFiles& exports,
                           double frames_per_second)
    : film_(scene, file, (require_not_negative("--frames-per-second", frames_per_second), frames_per_second)),
      exports_(exports) {}

std::string RunRecording::sample(Simulator& simulator) {
  if (failed_) return {};
  try {
    (void)film_.sample(simulator);
    return {};
  } catch (const std::exception& error) {
    failed_ = true;
    return error.what();
  }
}

ExportOutcome RunRecording::finish(Simulator& simulator, const std::string& status,
                                   const std::string& message) {
  ExportOutcome outcome;
  const auto attempt = [&](const auto& work) {
    try {
      work();
    } catch (const std::exception& error) {
      outcome.errors.push_back(error.what());
    }
  };
  if (!failed_)
    attempt([&] {
      (void)film_.sample_now(simulator);
      film_.finish(status, message);
    });
  if (!exports_.any()) return outcome;
  attempt([&] {
    RecordingReader reader(film_.file());
    ExportOutcome exported = export_recording(reader, exports_);
    outcome.errors.insert(outcome.errors.end(), exported.errors.begin(), exported.errors.end());
    outcome.notes = std::move(exported.notes);
  });
  return outcome;
}

}  // namespace taut
