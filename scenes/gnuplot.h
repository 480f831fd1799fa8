#pragma once

#include <filesystem>
#include <string>

namespace taut {

/// Draws what a script says.  Without gnuplot there are no pictures, which `command` says on the standard
/// error.  @throws std::invalid_argument if the script cannot be written into `folder`, where it is for as
/// long as it runs.
void draw(const std::string& script, const std::filesystem::path& folder, const std::string& command);

}  // namespace taut
