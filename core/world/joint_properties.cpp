#include "core/world/joint_properties.h"

#include <cmath>
#include <string>

#include "core/base/check.h"

namespace taut {
namespace {

void check_pair(const std::string& name, double compliance, double damping) {
  if (!(compliance >= 0)) fail(name + " compliance", "must not be negative", compliance);
  require_not_negative(name + " damping", damping);
  if (std::isinf(compliance) && damping == 0)
    fail(name + " compliance", "must be finite without damping", compliance);
}

}  // namespace

ComplianceDamping from_erp_cfm(double erp, double cfm, double dt) {
  if (!(erp >= 0 && erp <= 1)) fail("erp", "must be from 0 to 1", erp);
  require_positive("cfm", cfm);
  require_positive("dt", dt);
  return {dt * cfm / erp, (1 - erp) / cfm};  // infinite for erp = 0: a damper
}

ErpCfm to_erp_cfm(const ComplianceDamping& spring, double dt) {
  if (!(spring.compliance > 0)) fail("compliance", "must be positive", spring.compliance);
  require_not_negative("damping", spring.damping);
  require_positive("dt", dt);
  const double sum = dt / spring.compliance + spring.damping;
  return {dt / spring.compliance / sum, 1 / sum};
}

void check_joint(std::string_view joint, const BreakLimits& limits) {
  const std::string of = " of " + std::string(joint);
  if (!(limits.force > 0)) fail("break force" + of, "must be positive", limits.force);
  if (!(limits.torque > 0)) fail("break torque" + of, "must be positive", limits.torque);
}

void check_joint(std::string_view joint, const JointCompliance& c) {
  check_pair(std::string(joint) + " translation", c.translation, c.translation_damping);
  check_pair(std::string(joint) + " rotation", c.rotation, c.rotation_damping);
}

}  // namespace taut
