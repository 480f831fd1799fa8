#pragma once

#include "benchmarks/peers/peer.h"
#include "benchmarks/peers/plain_system.h"

namespace taut::peers {

PlainSystem plain(const System& system);

/// Poses and twists of all bodies but the ground.
void set_motion(const std::vector<PlainMotion>& bodies, State& state);

}  // namespace taut::peers
