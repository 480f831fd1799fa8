#include "core/state/same_state.h"
#include "core/world/world.h"
#include "core/world/world_parts.h"

// Bodies that are asleep.
namespace taut {

void World::put_to_sleep(BodyId id) {
  parts_->identity.require_free();
  if (!moves(id)) return;
  parts_->sleep.set_asleep(id.index, true);
  state_.twists[id.index] = {};
  ++parts_->versions.sleep;
}

void World::wake(BodyId id) {
  parts_->identity.require_free();
  if (parts_->sleep.wake(parts_->bodies.checked(id))) ++parts_->versions.sleep;
}

void World::wake_all() {
  for (int b = 0; b < body_count(); ++b) wake({b});
}

/// A law that does not say on which bodies it acts may act on any.
void World::wake_or_all(const std::vector<BodyId>& bodies) {
  if (bodies.empty()) return wake_all();
  for (BodyId body : bodies) wake(body);
}

void World::wake_bodies_of(JointId id) {
  for (BodyId body : parts_->joints[id.index].bodies()) wake(body);
}

/// Before that state is taken over.
void World::wake_moved(const State& state) {
  for (int b = 0; b < body_count() && asleep_count() > 0; ++b) {
    const Twist& V = state.twists[b];
    if (moves({b})) continue;
    if (same(state.poses[b], state_.poses[b]) && V.w.isZero(0) && V.v.isZero(0)) continue;
    parts_->bodies.is_fixed(b) ? wake_all() : wake({b});
  }
}

bool World::is_asleep(BodyId id) const { return parts_->sleep.is_asleep(parts_->bodies.checked(id)); }
bool World::moves(BodyId id) const { return !is_fixed(id) && !parts_->sleep.is_asleep(id.index); }
int World::asleep_count() const { return parts_->sleep.asleep_count(); }
int World::wake_count(BodyId id) const { return parts_->sleep.wake_count(parts_->bodies.checked(id)); }

}  // namespace taut
