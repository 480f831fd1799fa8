#pragma once

#include <array>
#include <functional>
#include <vector>

#include "core/axes/axis.h"
#include "core/math/motion_point.h"
#include "core/state/state.h"

/// Functions of time: what drivers and motors follow, and what loads are multiplied by.
namespace taut {

/// f(t) = value + rate (t − start).
/// @throws std::invalid_argument if a number is not finite.
Motion linear_motion(double value, double rate, double start = 0);

/// f(t) = mean + amplitude sin(ω t + φ), ω = `omega` [rad/s], φ = `phase` [rad]; throws if not finite.
Motion harmonic_motion(double mean, double amplitude, double omega, double phase = 0);

/// A term a sin(ω t + φ) of harmonics_motion().
struct Harmonic {
  double amplitude = 0;  ///< a
  double omega = 0;      ///< ω [rad/s]
  double phase = 0;      ///< φ [rad]
};
/// f(t) = mean + Σ aᵢ sin(ωᵢ t + φᵢ), summed in their order; throws unless all numbers are finite.
Motion harmonics_motion(double mean, std::vector<Harmonic> terms);

/// A piecewise linear function: `table` over time, held beyond its ends, or with `periodic` repeated with the
/// period from its first point to its last; if the two differ, it jumps there, to the first.  Its rate jumps
/// at the points: what a driver follows gets an impulse there, which speed_motion() spares it.
/// @throws std::invalid_argument for a periodic table of one point.
Motion table_motion(Curve table, bool periodic = false);

/// `from` until the time `start` [s], `to` from start + duration on, between them linear or, with `smooth`,
/// f(t) = from + (to − from) ½ (1 − cos π (t − start)/duration), whose rate does not jump.
/// @throws std::invalid_argument if a number is not finite or the duration not positive.
Motion ramp_motion(double from, double to, double start, double duration, bool smooth = false);

/// A gust: f(t) = peak ½ (1 − cos 2π (t − start)/duration) between start and start + duration [s], otherwise
/// 0; its integral is ½ peak · duration.  Throws unless all are finite and the duration positive.
Motion gust_motion(double peak, double start, double duration);

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
