#pragma once

#include <memory>
#include <vector>

#include "core/world/passing_loads.h"

namespace taut {

class Archive;

/// What apply_force() has been told for the next step acts on a world while this lives.
class ActingLoads {
 public:
  /// With a law that acts beside them, and before and after; null: none.
  ActingLoads(World& world, std::shared_ptr<const Force> law);
  ~ActingLoads();
  ActingLoads(const ActingLoads&) = delete;
  ActingLoads& operator=(const ActingLoads&) = delete;

 private:
  World& world_;
  bool any_;
  std::shared_ptr<const Force> law_;
};

/// Loads for the next step to or from bytes, for bodies of this world.
void transfer_loads(Archive& archive, std::vector<BodyLoad>& loads, const World& world);

}  // namespace taut
