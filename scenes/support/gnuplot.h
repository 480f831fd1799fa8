#pragma once

#include <string>

namespace taut {

/// Draws what a script says.  Without gnuplot there are no pictures, which `command` says on the standard
/// error.  @throws std::invalid_argument if the script cannot be written into a temporary folder.
void draw(const std::string& script, const std::string& command);

}  // namespace taut
