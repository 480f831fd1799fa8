#pragma once

#include <string>
#include <vector>

#include "scenes/recording/recording_reader.h"

namespace taut {

/// Where a recording is to be turned into something else; empty: not at all.
struct ExportFiles {
  std::string html{};        ///< a page for any browser
  std::string gltf{};        ///< an animation, binary glTF 2.0
  std::string vtk_folder{};  ///< series for ParaView
  std::string plot{};        ///< curves, SVG
  std::string csv{};         ///< the scalars of all frames

  /// There is something to write.
  bool any() const { return !(html + gltf + vtk_folder + plot + csv).empty(); }
};

/// Asks whether all of it can be written, so that a long run does not fail at its end.  Nothing is touched.
/// @throws std::invalid_argument for a file or folder that cannot be written, or whose name ends as that of
/// another kind of file, or a page without three.js, naming the option.
void check_exports(const ExportFiles& files);

/// What went wrong or had to be left out, one sentence each: nothing as a rule.
struct ExportOutcome {
  std::vector<std::string> errors;  ///< what could not be written, and why
  std::vector<std::string> notes;   ///< what was left out
};
/// Writes the files that `files` names.
/// @param beside another recording, which the page shows beside it
/// @throws std::invalid_argument for a recording without frames.
ExportOutcome export_recording(RecordingReader& recording, const ExportFiles& files,
                               RecordingReader* beside = nullptr);

}  // namespace taut
