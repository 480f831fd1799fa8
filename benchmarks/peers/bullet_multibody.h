#pragma once

#include "benchmarks/peers/peer.h"

namespace taut::peers {

/// Bullet's articulated-body algorithm in reduced coordinates; trees only.
std::unique_ptr<Engine> make_bullet_multibody(const System& system, const Method& method, double dt);

}  // namespace taut::peers
