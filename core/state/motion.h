#pragma once

#include <array>
#include <functional>
#include <vector>

#include "core/state/axis.h"
#include "core/state/motion_point.h"
#include "core/state/state.h"

/// Prescribed motions as functions of time, for drivers.
namespace taut {

/// f(t) = value + rate (t − start).
/// @throws std::invalid_argument if a number is not finite.
Motion linear_motion(double value, double rate, double start = 0);

/// f(t) = mean + amplitude sin(ω t + φ), ω = `omega` [rad/s], φ = `phase` [rad]; throws as linear_motion().
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
  Pose pose;                     ///< q and p [m]
  Twist velocity, acceleration;  ///< (ω, ṗ), or (ω̇, p̈)
};
using PoseMotion = std::function<PosePoint(double time)>;  ///< a pose over time [s]

/// A turn by a changing angle [rad] about an axis fixed in the frame that the turns before it have made.
struct Turning {
  Vec3 axis = Vec3::UnitZ();  ///< of unit length
  Motion angle;               ///< [rad]
};
/// p(t) along the axes of the other body, and q(t) = exp(a₁ θ₁(t)) exp(a₂ θ₂(t)) … orientation.  A motion
/// that is null is 0.
/// @throws std::invalid_argument if an axis or the orientation is not of unit length.
PoseMotion pose_motion(std::array<Motion, 3> position, std::vector<Turning> turns,
                       const Quat& orientation = Quat::Identity());

}  // namespace taut
