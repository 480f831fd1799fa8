#pragma once

#include <string>

#include "scenes/export/exports.h"
#include "scenes/recording/film.h"

namespace taut {

/// The recording that a run makes, and what is made from it at the end.  Without a file of its own it lives
/// in a temporary one.
class RunRecording {
 public:
  /// Opens the file; what is made from it is written at the end.
  /// @param file of the recording, may be empty
  /// @param frames_per_second 0: every step
  /// @throws std::invalid_argument for a file that cannot be written or a negative rate.
  RunRecording(const Scene& scene, const std::string& file, const ExportFiles& exports,
               double frames_per_second);

  /// Takes a frame if the next instant k / frames_per_second has come (within half a microsecond).
  /// @returns what went wrong, once; "" as a rule.
  std::string sample(Simulator& simulator);
  /// Takes the last instant if no frame has it, ends the recording and writes the exports.
  ExportOutcome finish(Simulator& simulator, const std::string& status, const std::string& message);

 private:
  Film film_;
  ExportFiles exports_;
  bool failed_ = false;
};

}  // namespace taut
