#pragma once

#include "scenes/import/robot_model.h"

namespace taut::model {

/// The same mass, seen from frame A, where L is at X_AL.
LinkInertia in_frame(const Pose& X_AL, const LinkInertia& inertia_L);
/// Both together, in the frame of both.
LinkInertia sum(const LinkInertia& a, const LinkInertia& b);
/// What is left of the whole without the part.
LinkInertia difference(const LinkInertia& whole, const LinkInertia& part);
/// Whether it can be a body: mass and principal moments positive, which obey the triangle inequality.
bool is_solid(const LinkInertia& inertia);
/// Of a uniform solid of density 1 [kg/m³], in the frame of the shape.
/// @throws std::invalid_argument if it has no volume, or none that can be computed.
LinkInertia inertia_of_shape(const Shape& shape);
/// Of `factor` times the density.
LinkInertia scaled(const LinkInertia& inertia, double factor);
/// Of the motion along an axis at the start, of its link and all that hangs from it, with its armature [kg m²
/// or kg]: the entry of the axis on the diagonal of the joint-space inertia.  None if a mass is not known, or
/// the axis is that of a ball or a screw.
std::optional<double> inertia_along(const RobotModel& model, const AxisName& name);

}  // namespace taut::model
