#include "core/world/passing_loads.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/world/world.h"
#include "core/world/world_parts.h"

namespace taut {
namespace {

/// Constant wrenches, and a law beside them, which have no potential.
class BodyLoads final : public Force {
 public:
  BodyLoads(std::span<const BodyLoad> loads, std::shared_ptr<const Force> law)
      : loads_(loads.begin(), loads.end()), law_(std::move(law)) {}
  void accumulate(const State& state, std::span<Wrench> wrenches) const override {
    for (const BodyLoad& load : loads_) wrenches[load.body.index] = wrenches[load.body.index] + load.wrench;
    if (law_) law_->accumulate(state, wrenches);
  }
  std::vector<BodyId> bodies() const override {
    std::vector<BodyId> bodies = law_ ? law_->bodies() : std::vector<BodyId>();
    for (const BodyLoad& load : loads_) bodies.push_back(load.body);
    return bodies;
  }

 private:
  std::vector<BodyLoad> loads_;
  std::shared_ptr<const Force> law_;
};

}  // namespace

void PassingLoads::set(World& world, std::span<const BodyLoad> loads, std::shared_ptr<const Force> law) {
  world.parts_->identity.require_free();
  const bool any = !loads.empty() || law;
  world.parts_->forces.set_passing(any ? std::make_shared<const BodyLoads>(loads, std::move(law)) : nullptr);
  ++world.parts_->versions.state;
}

const std::vector<BodyLoad>& PassingLoads::next(const World& world) { return world.parts_->next_loads; }

void PassingLoads::set_next(World& world, std::vector<BodyLoad> loads) {
  world.parts_->identity.require_free();
  world.parts_->next_loads = std::move(loads);
}

}  // namespace taut
