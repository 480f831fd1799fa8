#include "core/joints/gear.h"

#include "core/base/check.h"

namespace taut {

Gear::Gear(const World& world, AxisId driving, AxisId driven, double ratio)
    : AxisCoupling(world, "gear", {{driving, -ratio}, {driven, 1}}) {
  if (driving == driven) fail("gear", "couples an axis to itself", world.axis_label(driving));
}

}  // namespace taut
