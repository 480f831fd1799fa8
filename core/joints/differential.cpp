#include "core/joints/differential.h"

#include "core/base/check.h"

namespace taut {

Differential::Differential(const World& world, AxisId input, AxisId left, AxisId right)
    : AxisCoupling(world, "differential", {{input, -2}, {left, 1}, {right, 1}}) {
  for (AxisId axis : {input, left, right})
    if (!world.axis_info(axis).angular)
      fail("differential", "its axes must be angles", world.axis_label(axis));
  for (const auto& [first, second] : {std::pair(input, left), {input, right}, {left, right}})
    if (first == second) fail("differential", "has the same axis twice", world.axis_label(first));
}

}  // namespace taut
