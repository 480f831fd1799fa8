#pragma once

#include <vector>

#include "core/world/world.h"

namespace taut {

/// Takes a world back to where it was before a step or a question moved it: its state, and the joints that
/// broke.
class StepUndo {
 public:
  /// `world` is stepped for the user's `source`, or is that itself.
  StepUndo(World& world, World& source) : world_(world), source_(source) {}

  /// Where the world is now is what it is taken back to.
  void begin();
  /// Gives the world a new state.
  void move_world(const State& state);
  /// Takes a joint out of both worlds.
  void detach(JointId joint);
  /// The state from before.
  void restore_state();
  /// All that was done since begin() is undone.
  void take_back();

 private:
  World &world_, &source_;
  State before_;  // of world_, if it has moved
  bool has_moved_ = false;
  std::vector<JointId> detached_;
};

}  // namespace taut
