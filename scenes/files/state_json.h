#pragma once

#include <nlohmann/json.hpp>

#include "scenes/files/state_file.h"

namespace taut {

/// Time, poses and twists of all moving bodies, the values of free axes, which joints are detached, and how
/// contacts are stretched (Simulator::contact_stretches()).  All numbers are written so that they are read
/// back bit for bit.  With a checkpoint, a run that goes on from it is the run that was not interrupted.
nlohmann::ordered_json state_json(const World& world, const SavedMemory& memory = {});

}  // namespace taut
