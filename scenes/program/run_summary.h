#pragma once

#include <string>
#include <vector>

#include "scenes/program/run_command.h"
#include "scenes/program/run_record.h"

namespace taut {

/// What a run has to say at its end in eight lines: what it was, how fast, how exact, what happened, where
/// the energy went, and how to see it; and lines for what cannot hold together and for each warning.
/// @param to_see the last line, from how_to_see()
std::string run_summary(const RunRecord& record, const std::string& to_see);

/// The command that shows the run that the options ask for: the run again with a page, the replay of its
/// recording, or the page that it has made.
std::string how_to_see(const RunOptions& options);

/// As a word of a shell.
std::string shell_word(const std::string& word);

}  // namespace taut
