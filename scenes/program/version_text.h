#pragma once

#include <string>

namespace taut {

/// "taut 0.2.0", and a line for each part of the program that depends on what it was built with, or on what
/// is there when it runs: which library does it, or what is missing.
std::string version_text();

}  // namespace taut
