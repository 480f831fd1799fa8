#include "core/world/passing_loads.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/world/world.h"

namespace taut {
namespace {

/// Constant wrenches, which have no potential.
class BodyLoads final : public Force {
 public:
  explicit BodyLoads(std::span<const BodyLoad> loads) : loads_(loads.begin(), loads.end()) {}
  void accumulate(const State&, std::span<Wrench> wrenches) const override {
    for (const BodyLoad& load : loads_) wrenches[load.body.index] = wrenches[load.body.index] + load.wrench;
  }
  std::vector<BodyId> bodies() const override {
    std::vector<BodyId> bodies;
    for (const BodyLoad& load : loads_) bodies.push_back(load.body);
    return bodies;
  }

 private:
  std::vector<BodyLoad> loads_;
};

}  // namespace

void PassingLoads::set(World& world, std::span<const BodyLoad> loads) {
  world.identity_.require_free();
  world.forces_.set_passing(loads.empty() ? nullptr : std::make_shared<const BodyLoads>(loads));
  ++world.versions_.state;
}

}  // namespace taut
