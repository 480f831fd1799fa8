#pragma once

#include "scenes/builders/contact_worlds.h"

namespace taut::testing {

using contact_worlds::add_ball, contact_worlds::add_box, contact_worlds::add_solid, contact_worlds::rubbing;

}  // namespace taut::testing
