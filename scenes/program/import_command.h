#pragma once

#include <string>

namespace taut {

/// `taut import`: a model of a robot as a scene file, to the standard output if no file is named.  What the
/// scene lacks is listed on the standard error.  @returns the exit status.
int import_command(const std::string& model, const std::string& output);

}  // namespace taut
