#pragma once

#include <string>

namespace taut {

/// Text of `taut list`: every builder with its parameters, defaults, ranges and units; or the one of that
/// name.
/// @throws std::invalid_argument if there is none of that name.
std::string list_scenes(const std::string& name = "");

}  // namespace taut
