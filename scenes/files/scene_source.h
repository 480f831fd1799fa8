#pragma once

#include <map>
#include <string>

#include "scenes/builders/scene.h"

namespace taut {

/// True for anything with a '/' or that ends in .json.
bool is_scene_file(const std::string& name_or_file);

/// A scene by what the user typed: the name of a builder, or else a scene file.
/// @throws std::invalid_argument for an unknown name, a bad file, or parameters that the scene does not have.
Scene open_scene(const std::string& name_or_file, const std::map<std::string, double>& parameters = {});

/// "N=50" to ("N", 50).  Also true and false.
/// @throws std::invalid_argument if it is not key=number, or the key is there already.
void add_parameter(std::map<std::string, double>& parameters, const std::string& assignment);

}  // namespace taut
