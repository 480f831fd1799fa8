#include "solvers/simulator/step_loads.h"

#include <utility>

#include "core/state/archive.h"
#include "core/world/world.h"

namespace taut {

ActingLoads::ActingLoads(World& world, std::shared_ptr<const Force> law)
    : world_(world), any_(!PassingLoads::next(world).empty()), law_(std::move(law)) {
  if (any_) PassingLoads::set(world_, PassingLoads::next(world), law_);
}

ActingLoads::~ActingLoads() {
  if (any_) PassingLoads::set(world_, {}, law_);
}

void transfer_loads(Archive& archive, std::vector<BodyLoad>& loads, const World& world) {
  archive.each(loads, [&](BodyLoad& load) {
    archive(load.body, load.wrench);
    Archive::index(load.body.index, 0, world.body_count());
    Archive::require(load.wrench.force.allFinite() && load.wrench.torque.allFinite());
  });
}

}  // namespace taut
