#include "core/world/material.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"

namespace taut {

void check_material(const Material& material) {
  require_not_negative("restitution", material.restitution);
  if (material.restitution > 1) fail("restitution", "must not be above 1", material.restitution);
  require_not_negative("dynamic friction", material.dynamic_friction);
  require_not_negative("static friction", material.static_friction);
  if (material.static_friction < material.dynamic_friction)
    fail("static friction", "must not be below dynamic friction", material.static_friction);
  require_not_negative("rolling friction", material.rolling_friction);
  require_not_negative("spinning friction", material.spinning_friction);
  require_not_negative("contact compliance", material.compliance);
  require_not_negative("linear rolling friction", material.rolling_friction_linear);
  require_not_negative("linear spinning friction", material.spinning_friction_linear);
}

Material combined(const Material& a, const Material& b) {
  Material both;
  both.restitution = std::min(a.restitution, b.restitution);
  both.static_friction = std::sqrt(a.static_friction * b.static_friction);
  both.dynamic_friction = std::sqrt(a.dynamic_friction * b.dynamic_friction);
  both.rolling_friction = std::max(a.rolling_friction, b.rolling_friction);
  both.spinning_friction = std::max(a.spinning_friction, b.spinning_friction);
  both.compliance = a.compliance + b.compliance;
  both.rolling_friction_linear = std::max(a.rolling_friction_linear, b.rolling_friction_linear);
  both.spinning_friction_linear = std::max(a.spinning_friction_linear, b.spinning_friction_linear);
  return both;
}

}  // namespace taut
