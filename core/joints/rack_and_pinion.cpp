#include "core/joints/rack_and_pinion.h"

#include "core/base/check.h"

namespace taut {

RackAndPinion::RackAndPinion(const World& world, AxisId pinion, AxisId rack, double radius)
    : AxisCoupling(world, "rack and pinion", {{pinion, -radius}, {rack, 1}}) {
  if (!world.axis_info(pinion).angular)
    fail("rack and pinion", "the pinion's axis must be an angle", world.axis_label(pinion));
  if (world.axis_info(rack).angular)
    fail("rack and pinion", "the rack's axis must be a displacement", world.axis_label(rack));
}

}  // namespace taut
