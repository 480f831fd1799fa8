#include "solvers/simulator/step_undo.h"

namespace taut {

void StepUndo::begin() {
  has_moved_ = false;
  detached_.clear();
}

void StepUndo::move_world(const State& state) {
  if (has_moved_) return world_.set_state(state);
  before_ = state;
  world_.exchange_state(before_);
  has_moved_ = true;
}

void StepUndo::detach(JointId joint) {
  detached_.push_back(joint);
  world_.detach(joint);
  if (&source_ != &world_) source_.detach(joint);
}

void StepUndo::restore_state() {
  if (has_moved_) world_.set_state(before_);
}

void StepUndo::take_back() {
  for (JointId joint : detached_) {
    world_.attach(joint);
    if (&source_ != &world_) source_.attach(joint);
  }
  restore_state();
  has_moved_ = false;
}

}  // namespace taut
