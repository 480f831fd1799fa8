#pragma once

#include "core/world/world.h"
#include "scenes/python/casters.h"

namespace taut::python {

/// The members of World about its present state: poses, arrays, energies.
void bind_world_state(nb::class_<World>& c);

}  // namespace taut::python
