#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/world.h"

/// Files of a state, to go on from in another run: JSON, by the names of bodies and joints.  scenes/README.md
/// describes the format.
namespace taut {

/// Time, poses and twists of all moving bodies, the values of free axes, and which joints are detached.  All
/// numbers are written so that they are read back bit for bit.
nlohmann::ordered_json state_json(const World& world);

/// Sets the world to that state.  Bodies that the text does not name, and axes, stay as they are.
/// @throws SceneFileError, naming all that is wrong with its path: syntax, unknown keys, bodies, joints and
/// axes that the world does not have, what is given twice, values that World::set_state() refuses.
void apply_state(World& world, std::string_view text, const std::string& file_name);
/// @throws SceneFileError, also if the file cannot be read.
void load_state_file(World& world, const std::filesystem::path& path);

/// Writes the file anew as a whole: a run that is killed meanwhile leaves the old one.
/// @returns false if it could not be written.
bool save_state_file(const World& world, const std::filesystem::path& path);

}  // namespace taut
