#pragma once

#include <string>
#include <vector>

#include "benchmarks/peers/peer.h"

namespace taut::peers {

/// A system in MuJoCo's own format, with the index of its bodies: nested in the spanning tree with equality
/// constraints for the loops, or (free=1) all bodies free and every joint an equality.
struct MujocoModel {
  std::string xml;
  std::vector<std::string> body_names;  ///< by the index in the World
};
MujocoModel mujoco_model(const System& system, const Method& method, double dt);

}  // namespace taut::peers
