#pragma once

#include <string>

#include "scenes/export/exports.h"

namespace taut {

/// Turns a recording into the files asked for; without any, prints what it holds.
/// @param beside another recording, "" for none: a page shows both side by side
/// @returns kExitSuccess, or kExitFailure if a recording is damaged or cut short (what is readable is
/// written all the same) or an output could not be written.
/// @throws std::invalid_argument for a file that is no recording, or without frames, and for outputs of two
/// recordings other than a page.
int replay_command(const std::string& file, const std::string& beside, const ExportFiles& exports,
                   bool quiet);

}  // namespace taut
