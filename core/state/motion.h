#pragma once

#include <array>
#include <functional>
#include <vector>

#include "core/state/axis.h"
#include "core/state/motion_point.h"
#include "core/state/state.h"

/// Prescribed motions as functions of time, for drivers.
namespace taut {

/// value + rate (t − start).
/// @throws std::invalid_argument if a number is not finite (all of these).
Motion linear_motion(double value, double rate, double start = 0);

/// mean + amplitude sin(omega t + phase), angles in rad, omega in rad/s.
Motion harmonic_motion(double mean, double amplitude, double omega, double phase = 0);

/// A cubic spline through (time, value), with straight lines before and after it.
/// @throws std::invalid_argument as CubicSpline.
Motion spline_motion(const std::vector<double>& times, const std::vector<double>& values);

/// A velocity given by points (linear between them, held beyond): `value` at the first point, then its exact
/// integral.
Motion speed_motion(const Curve& speed, double value);

/// Pose of a body relative to another, with velocity and acceleration: p, ṗ, p̈ and ω, ω̇ in the axes of the
/// other body.
struct PosePoint {
  Pose pose;
  Twist velocity, acceleration;
};
using PoseMotion = std::function<PosePoint(double time)>;

/// A turn by a changing angle [rad] about an axis fixed in the frame that the turns before it have made.
struct Turning {
  Vec3 axis = Vec3::UnitZ();
  Motion angle;
};
/// p(t) along the axes of the other body, and q(t) = exp(a₁ θ₁(t)) exp(a₂ θ₂(t)) … orientation.  A motion
/// that is null is 0.
/// @throws std::invalid_argument if an axis or the orientation is not of unit length.
PoseMotion pose_motion(std::array<Motion, 3> position, std::vector<Turning> turns,
                       const Quat& orientation = Quat::Identity());

}  // namespace taut
