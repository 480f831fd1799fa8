#pragma once

#include <string>

namespace taut::testing {

/// A name in a fresh folder of this process, so of one test where ctest runs each in its own; the folder is
/// removed with all in it when the process ends.
std::string temporary(const std::string& name);
std::string read_text(const std::string& file);
void write_text(const std::string& file, const std::string& text);

}  // namespace taut::testing
