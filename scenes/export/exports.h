#pragma once

#include <string>
#include <vector>

#include "scenes/recording/recording_reader.h"

namespace taut {

/// Where a recording is to be turned into something else; empty: not at all.
struct ExportFiles {
  std::string html{}, gltf{}, vtk_folder{}, plot{}, csv{};

  bool any() const { return !(html + gltf + vtk_folder + plot + csv).empty(); }
};

/// Asks whether all of it can be written, so that a long run does not fail at its end.  Nothing is touched.
/// @throws std::invalid_argument for a file or folder that cannot be written, or a page without three.js,
/// naming the option.
void check_exports(const ExportFiles& files);

/// Writes all of them.  @returns what went wrong or had to be left out, one sentence each: nothing as a rule.
/// @throws std::invalid_argument for a recording without frames.
struct ExportOutcome {
  std::vector<std::string> errors, notes;
};
ExportOutcome export_recording(RecordingReader& recording, const ExportFiles& files);

}  // namespace taut
