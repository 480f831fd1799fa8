#include "core/world/applied_force.h"

#include <algorithm>
#include <string>
#include <vector>

#include "core/base/check.h"
#include "core/world/passing_loads.h"
#include "core/world/world.h"

namespace taut {

void apply_force(World& world, BodyId body, const Wrench& wrench) {
  const std::string name = "apply_force on " + world.name(body);  // throws for an id that is not there
  require_all_finite(name + ": force", wrench.force);
  require_all_finite(name + ": torque", wrench.torque);
  std::vector<BodyLoad> loads = PassingLoads::next(world);
  const auto place =
      std::find_if(loads.begin(), loads.end(), [&](const BodyLoad& load) { return load.body == body; });
  const Wrench sum = place == loads.end() ? wrench : place->wrench + wrench;
  require_all_finite(name + ": sum of forces", sum.force);
  require_all_finite(name + ": sum of torques", sum.torque);
  if (place == loads.end())
    loads.push_back({body, sum});
  else
    place->wrench = sum;
  PassingLoads::set_next(world, std::move(loads));
  if (!world.is_fixed(body)) world.wake(body);
}

void apply_force(World& world, BodyId body, const Vec3& p_BP, const Vec3& force) {
  require_all_finite("apply_force on " + world.name(body) + ": point", p_BP);
  apply_force(world, body, Wrench{(world.pose(body).q * p_BP).cross(force), force});
}

}  // namespace taut
