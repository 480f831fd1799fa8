#include "scenes/python/access.h"

#include <stdexcept>
#include <thread>
#include <unordered_map>

namespace taut::python {
namespace {

/// What is known of a world that is stepped, or whose state an array shows.  Under the GIL.
struct Use {
  bool stepped = false;
  std::thread::id by;
  std::weak_ptr<SharedState> shared;
};

/// By World::identity(), which no other world ever has.
std::unordered_map<std::uint64_t, Use>& uses() {
  static auto* const table = new std::unordered_map<std::uint64_t, Use>;  // arrays may outlive static objects
  return *table;
}

void forget_if_unused(std::uint64_t world) {
  const auto use = uses().find(world);
  if (use != uses().end() && !use->second.stepped && use->second.shared.expired()) uses().erase(use);
}

}  // namespace

std::shared_ptr<SharedState> share_state(const World& world) {
  Use& use = uses()[world.identity()];
  if (auto shared = use.shared.lock()) return shared;
  std::shared_ptr<SharedState> shared(new SharedState{nb::find(world), {}},
                                      [id = world.identity()](SharedState* s) {
                                        delete s;
                                        forget_if_unused(id);
                                      });
  use.shared = shared;
  return shared;
}

void require_askable(const World& world) {
  const auto use = uses().find(world.identity());
  if (use != uses().end() && use->second.stepped && use->second.by != std::this_thread::get_id())
    throw std::runtime_error("the world is being stepped by another thread");
}

void begin_change(World& world) {
  const auto use = uses().find(world.identity());
  if (use == uses().end()) return;
  if (use->second.stepped)
    throw std::runtime_error(use->second.by == std::this_thread::get_id()
                                 ? "the world cannot be changed or stepped by what a step of it calls"
                                 : "the world is being stepped by another thread");
  const auto shared = use->second.shared.lock();
  if (!shared) return;
  // The arrays keep the memory that they show; the world goes on in a copy.  Its values are the same bits, so
  // that this is no change of the world, and its versions stay.
  shared->kept = world.state();
  std::swap(shared->kept, const_cast<State&>(world.state()));
  use->second.shared.reset();
  shared->owner.reset();
}

StepScope::StepScope(World& world) : world_(world.identity()) {
  begin_change(world);
  Use& use = uses()[world_];
  use.stepped = true;
  use.by = std::this_thread::get_id();
}

StepScope::~StepScope() {
  uses()[world_].stepped = false;
  forget_if_unused(world_);
}

}  // namespace taut::python
