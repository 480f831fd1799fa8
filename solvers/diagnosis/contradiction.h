#pragma once

#include <optional>
#include <span>

#include "core/world/world.h"
#include "solvers/common/step_report.h"

namespace taut {

/// The question whether all that holds a world can hold at once: when, and what counts.
struct Situation {
  const World& world;
  const State& from;                ///< poses and turns that are near to what is asked for
  double horizon = 0;               ///< [s] after `from`: where drivers and motors want to be by then
  bool bounds = true;               ///< with limits, motors and contacts; false: joints alone
  double contact_margin = 0;        ///< [m] contacts up to this gap count; 0: none do
  std::span<const JointId> gone{};  ///< joints that hold nothing any more
  /// Whose bodies contacts are named by, where `world` is a copy with merged ones
  /// (core/merging/merged_world.h).
  const World* named = nullptr;
};

/// A set that cannot hold together from there, irreducible: without any one of its members the others can.
/// Empty if all holds, or if that could not be decided.  Motors count if their force has no bound, limits
/// and contacts if they have no compliance.  Of independent contradictions one is given; sets of more than
/// 200 are given as they were found, in the order of the world.   (solvers/diagnosis, "Contradiction")
Contradiction find_contradiction(const Situation& situation);

}  // namespace taut
