#pragma once

#include <functional>
#include <memory>
#include <utility>

#include "core/world/world.h"
#include "scenes/python/casters.h"

/// Who may use a World from Python while a step runs, and how its arrays live on.
namespace taut::python {

/// The memory that arrays of a world's state show: the world's own until it changes, then theirs alone, as it
/// was. No array is ever stale, and one that is gone by the next step has cost no copy.
struct SharedState {
  nb::object owner;  ///< the world, while the memory is its own
  State kept;        ///< after that
};
/// What a new array of the present state must keep alive.
std::shared_ptr<SharedState> share_state(const World& world);

/// Before a question: @throws std::runtime_error while another thread steps the world.
void require_askable(const World& world);
/// Before a change: arrays of the state keep what they show.  @throws std::runtime_error while a step runs,
/// also from a callback of it.
void begin_change(World& world);

/// For the time of a call of a simulator, with or without the GIL.
class StepScope {
 public:
  /// @throws std::runtime_error as begin_change().
  explicit StepScope(World& world);
  ~StepScope();
  StepScope(const StepScope&) = delete;
  StepScope& operator=(const StepScope&) = delete;

 private:
  std::uint64_t world_;
};

/// A member of World as one of Python that changes it, or asks it.  @{
template <typename Result, typename... Args>
auto changing(Result (World::*function)(Args...)) {
  return [function](World& world, Args... args) -> Result {
    begin_change(world);
    return (world.*function)(std::forward<Args>(args)...);
  };
}
template <typename Result, typename... Args>
auto asking(Result (World::*function)(Args...) const) {
  return [function](const World& world, Args... args) -> Result {
    require_askable(world);
    return (world.*function)(std::forward<Args>(args)...);
  };
}  /// @}

}  // namespace taut::python
