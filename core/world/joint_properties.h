#pragma once

#include <string_view>

#include "core/axes/axis.h"

/// What a joint as a whole can have besides its type: limits of strength, and elasticity.
namespace taut {

/// The joint leaves when the force or the torque (about its anchor on B) of its reaction on B exceeds one of
/// these, on the mean over a sub-step.                                          (solvers/laws, "Breaking")
struct BreakLimits {
  double force = kUnlimited;   ///< [N]
  double torque = kUnlimited;  ///< [N·m]
};

/// The rows of the joint give way as springs and dampers, λ = −φ/compliance − damping φ̇ each; λ and φ of
/// points are in axes of A then.                                              (solvers/laws, "Axes")
struct JointCompliance {
  double translation = 0;          ///< of rows in metres [m/N]; 0: rigid, infinite: damper only
  double rotation = 0;             ///< of rows in radians [rad/(N·m)]; 0: rigid, infinite: damper only
  double translation_damping = 0;  ///< [N·s/m]; without effect on rigid rows
  double rotation_damping = 0;     ///< [N·m·s/rad]; without effect on rigid rows
};

/// A spring of stiffness k = 1/compliance and a damper c.
struct ComplianceDamping {
  double compliance = 0, damping = 0;  ///< 1/k [m/N or rad/(N·m)], or c [N·s/m or N·m·s/rad]
};
/// The spring k and damper c that error reduction `erp` and constraint force mixing `cfm` [rate per force]
/// stand for at a step of dt:   erp = h k/(h k + c),  cfm = 1/(h k + c)   ⇔   k = erp/(h cfm),
/// c = (1 − erp)/cfm.
/// @throws std::invalid_argument if erp is not from 0 to 1, or cfm or dt not finite and positive.
ComplianceDamping from_erp_cfm(double erp, double cfm, double dt);
/// Error reduction and constraint force mixing by which a step of dt imitates a spring and damper.
struct ErpCfm {
  double erp = 0, cfm = 0;  ///< as in from_erp_cfm()
};
/// Inverse of from_erp_cfm().  @throws std::invalid_argument unless compliance > 0, damping ≥ 0 and dt > 0.
ErpCfm to_erp_cfm(const ComplianceDamping& spring, double dt);

/// @throws std::invalid_argument naming the joint and the value: limits that are not positive, compliance or
/// damping that is negative or not a number, an infinite compliance without damping.  @{
void check_joint(std::string_view joint, const BreakLimits& limits);
void check_joint(std::string_view joint, const JointCompliance& compliance);  /// @}

}  // namespace taut
