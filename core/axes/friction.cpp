#include "core/axes/friction.h"

#include "core/base/check.h"

namespace taut {

void AxisFriction::check(std::string_view axis) const {
  if (dynamic_friction > static_friction)
    fail(detail::of_axis("dynamic friction", axis),
         "must not exceed the static friction " + std::to_string(static_friction), dynamic_friction);
}

}  // namespace taut
