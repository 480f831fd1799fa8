#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/world.h"
#include "solvers/contact_report.h"

/// Files of a state, to go on from in another run: JSON, by the names of bodies and joints.  scenes/README.md
/// describes the format.
namespace taut {

using ContactStretches = std::vector<ContactStretch>;

/// Time, poses and twists of all moving bodies, the values of free axes, which joints are detached, and how
/// contacts are stretched (Simulator::contact_stretches()).  All numbers are written so that they are read
/// back bit for bit.
nlohmann::ordered_json state_json(const World& world, const ContactStretches& stretches = {});

/// Sets the world to that state.  Bodies that the text does not name, and axes, stay as they are.
/// @returns what is for Simulator::set_contact_stretches().
/// @throws SceneFileError, naming all that is wrong with its path: syntax, unknown keys, bodies, joints, axes
/// and shapes that the world does not have, what is given twice, values that World::set_state() refuses.
ContactStretches apply_state(World& world, std::string_view text, const std::string& file_name);
/// @throws SceneFileError, also if the file cannot be read.
ContactStretches load_state_file(World& world, const std::filesystem::path& path);

/// Writes the file anew as a whole: a run that is killed meanwhile leaves the old one.
/// @returns why it could not be written: "a.json: No space left on device"; "" if it is.
std::string save_state_file(const World& world, const ContactStretches& stretches,
                            const std::filesystem::path& path);

}  // namespace taut
