#pragma once

#include <map>
#include <string>

namespace taut {

/// `taut check`: builds a scene, looks for mistakes, counts its freedoms and names its redundant rows.
/// Nothing moves.  `all`: names all redundant rows, not the first 20 only.
/// @returns kExitSuccess, or kExitFailure if something is wrong with the scene.  Redundant rows are not.
/// @throws std::invalid_argument for an unknown scene or parameter.
int check_command(const std::string& scene, const std::map<std::string, double>& parameters,
                  bool all = false);

}  // namespace taut
