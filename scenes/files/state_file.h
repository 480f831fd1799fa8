#pragma once

#include <filesystem>
#include <string_view>

#include "core/world/world.h"
#include "solvers/common/contact_report.h"
#include "solvers/simulator/checkpoint.h"
#include "solvers/simulator/simulator.h"

/// Files of a state, to go on from in another run: JSON, by the names of bodies and joints.
/// scenes/files/FORMAT.md describes the format.
namespace taut {

/// Springs of compliant contacts, as Simulator::contact_stretches() gives them.
using ContactStretches = std::vector<ContactStretch>;

/// What a state file has beside the state, for a simulator.
struct SavedMemory {
  ContactStretches stretches;  ///< for Simulator::set_contact_stretches()
  Checkpoint checkpoint;       ///< for Simulator::restore(); empty if the file has none
};

/// Sets the world to that state.  Bodies that the text does not name, and axes, stay as they are.
/// @throws SceneFileError, naming all that is wrong with its path: syntax, unknown keys, bodies, joints, axes
/// and shapes that the world does not have, what is given twice, values that World::set_state() refuses.
SavedMemory apply_state(World& world, std::string_view text, const std::string& file_name);
/// @throws SceneFileError, also if the file cannot be read.
SavedMemory load_state_file(World& world, const std::filesystem::path& path);

/// Writes the file anew as a whole: a run that is killed meanwhile leaves the old one.
/// @returns why it could not be written: "a.json: No space left on device"; "" if it is.
std::string save_state_file(Simulator& simulator, const std::filesystem::path& path);

/// Has a simulator go on from a state that was loaded into its world.
/// @returns why it does so from the state alone though the file has a checkpoint: its state was changed
/// since, or the world or the integrator is another one; "" if it goes on with all that there is.
std::string go_on_from(Simulator& simulator, World& world, const SavedMemory& memory);

}  // namespace taut
