#pragma once

#include <filesystem>
#include <string>

#include "scenes/recording/recording_reader.h"

namespace taut {

/// Where find_three() looks before other places, for those who bring it along.
void set_three_folder(std::filesystem::path folder);
/// The folder of the package three.js: $TAUT_THREE, or where the build or the installation has put it.
/// @throws std::invalid_argument if it is nowhere, saying how to get it.
std::filesystem::path find_three();

/// A page, whole.
struct HtmlPage {
  std::string text;  ///< HTML
  std::string note;  ///< what was left out, or ""
};

/// One self-contained page that shows the recording: viewer, three.js and data inlined and compressed.
/// @param beside another one, shown beside it: same time, camera and scales
/// @throws std::invalid_argument if three.js is missing.
HtmlPage html_page(RecordingReader& recording, RecordingReader* beside = nullptr);

}  // namespace taut
