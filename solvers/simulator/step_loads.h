#pragma once

#include <memory>
#include <vector>

#include "core/world/passing_loads.h"

namespace taut {

class Archive;

/// What Simulator::apply_force() has been told for the next step.
class StepLoads {
 public:
  /// Adds to what acts on the body, and wakes it.
  /// @throws std::invalid_argument, with its name, if that is not finite; nothing has changed then.
  void add(World& world, BodyId body, const Wrench& wrench);
  void clear() { loads_.clear(); }
  bool empty() const { return loads_.empty(); }
  /// To or from bytes, for bodies of this world.
  void transfer(Archive& archive, const World& world);

  /// The loads act on a world while this lives.
  class Acting {
   public:
    /// With a law that acts beside them, and before and after; null: none.
    Acting(World& world, const StepLoads& loads, std::shared_ptr<const Force> law);
    ~Acting();
    Acting(const Acting&) = delete;
    Acting& operator=(const Acting&) = delete;

   private:
    World& world_;
    bool any_;
    std::shared_ptr<const Force> law_;
  };

 private:
  std::vector<BodyLoad> loads_;  // one a body at most
};

}  // namespace taut
