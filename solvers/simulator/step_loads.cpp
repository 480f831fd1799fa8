#include "solvers/simulator/step_loads.h"

#include <algorithm>
#include <string>
#include <utility>

#include "core/base/check.h"
#include "core/state/archive.h"
#include "core/world/world.h"

namespace taut {

void StepLoads::add(World& world, BodyId body, const Wrench& wrench) {
  const std::string name = "apply_force on " + world.name(body);  // throws for an id that is not there
  require_all_finite(name + ": force", wrench.force);
  require_all_finite(name + ": torque", wrench.torque);
  const auto place =
      std::find_if(loads_.begin(), loads_.end(), [&](const BodyLoad& load) { return load.body == body; });
  const Wrench sum = place == loads_.end() ? wrench : place->wrench + wrench;
  require_all_finite(name + ": sum of forces", sum.force);
  require_all_finite(name + ": sum of torques", sum.torque);
  if (!world.is_fixed(body)) world.wake(body);
  if (place == loads_.end())
    loads_.push_back({body, sum});
  else
    place->wrench = sum;
}

void StepLoads::transfer(Archive& archive, const World& world) {
  archive.each(loads_, [&](BodyLoad& load) {
    archive(load.body, load.wrench);
    Archive::index(load.body.index, 0, world.body_count());
    Archive::require(load.wrench.force.allFinite() && load.wrench.torque.allFinite());
  });
}

StepLoads::Acting::Acting(World& world, const StepLoads& loads, std::shared_ptr<const Force> law)
    : world_(world), any_(!loads.empty()), law_(std::move(law)) {
  if (any_) PassingLoads::set(world_, loads.loads_, law_);
}

StepLoads::Acting::~Acting() {
  if (any_) PassingLoads::set(world_, {}, law_);
}

}  // namespace taut
