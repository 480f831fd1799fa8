#include "core/state/same_state.h"
#include "core/world/world.h"

// Bodies that are asleep.
namespace taut {

void World::put_to_sleep(BodyId id) {
  identity_.require_free();
  if (!moves(id)) return;
  sleep_.set_asleep(id.index, true);
  state_.twists[id.index] = {};
  ++versions_.sleep;
}

void World::wake(BodyId id) {
  identity_.require_free();
  if (sleep_.wake(bodies_.checked(id))) ++versions_.sleep;
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
  for (BodyId body : joints_[id.index].bodies()) wake(body);
}

/// Before that state is taken over.
void World::wake_moved(const State& state) {
  for (int b = 0; b < body_count() && asleep_count() > 0; ++b) {
    const Twist& V = state.twists[b];
    if (moves({b})) continue;
    if (same(state.poses[b], state_.poses[b]) && V.w.isZero(0) && V.v.isZero(0)) continue;
    bodies_.is_fixed(b) ? wake_all() : wake({b});
  }
}

}  // namespace taut
