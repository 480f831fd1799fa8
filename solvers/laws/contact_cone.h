#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "core/math/so3.h"

namespace taut {

using Vec2 = Eigen::Vector2d;

/// The point of the disc |x| ≤ radius that is nearest to x, or this part of the way from there to x.
inline Vec2 into_disc(const Vec2& x, double radius, double part = 0) {
  const double size = std::sqrt(x[0] * x[0] + x[1] * x[1]);
  if (!(size > radius)) return x;
  const double scale = (part > 0 ? radius + part * (size - radius) : radius) / size;
  return {scale * x[0], scale * x[1]};
}

/// The point of [−radius, radius] that is nearest to x, or this part of the way from there to x.
inline double into_interval(double x, double radius, double part = 0) {
  const double nearest = std::clamp(x, -radius, radius);
  return part > 0 ? nearest + part * (x - nearest) : nearest;
}

/// The part of what is asked beyond Coulomb's bound that friction of `slope` κ, proportional to the rate,
/// gives where a row has the compliance Σ.
inline double part_of_slope(double slope, double sigma) { return slope * sigma / (1 + slope * sigma); }

/// Friction against the turn of a contact that is proportional to its rate, −Λ_n (lag + c w).
struct LinearFriction {
  double spinning = 0, rolling = 0;  ///< c of the rates w of this stage [m·s]
  double spin_lag = 0;               ///< c times rates before the step [m]
  Vec2 rolling_lag = Vec2::Zero();
};

/// Where the point of the cone |x_t| ≤ μ x_n is that is nearest to one with x_n = `normal` and |x_t| =
/// `size`: it is that one itself, the apex, or on the surface along the same tangent.
struct NearestOnCone {
  enum class Region { kWithin, kApex, kSurface } region;
  double normal = 0;  ///< x_n of a point on the surface
};
inline NearestOnCone nearest_on_cone(double normal, double size, double mu) {
  using Region = NearestOnCone::Region;
  if (normal >= 0 && size <= mu * normal) return {Region::kWithin};
  if (mu * size <= -normal) return {Region::kApex};
  return {Region::kSurface, (normal + mu * size) / (1 + mu * mu)};
}

/// The point of the cone |x_t| ≤ μ x_n that is nearest to x = (x_n, x_t).
inline Vec3 into_cone(const Vec3& x, double mu) {
  const double size = std::sqrt(x[1] * x[1] + x[2] * x[2]);
  const auto [region, on] = nearest_on_cone(x[0], size, mu);
  if (region == NearestOnCone::Region::kWithin) return x;
  if (region == NearestOnCone::Region::kApex) return Vec3::Zero();
  const double scale = mu * on / size;
  return {on, scale * x[1], scale * x[2]};
}

/// What the impulses of a contact of a stage may be, about those that the first kick gave: with the normal
/// impulse 0 ≤ Λ_n ≤ most, Coulomb's cone |Λ_t| ≤ sliding Λ_n, |spin| ≤ spinning Λ_n [m] and |roll| ≤ rolling
/// Λ_n [m], the last two beside friction proportional to the rate.
struct ContactCone {
  bool works = false, twist = false;
  bool normality = false;  ///< its slip does not open the cone (stick_search.h)
  double sliding = 0, spinning = 0, rolling = 0;
  double softness = 0, most = std::numeric_limits<double>::infinity();  ///< of the normal (NormalLaw)
  double slip_softness = 0;                                             ///< of the tangents (SlipLaw)
  double normal_given = 0, spin_given = 0;
  Vec2 sliding_given = Vec2::Zero(), rolling_given = Vec2::Zero();
  LinearFriction linear;

  /// What was given, about the middle of what friction may be with this normal impulse.
  double spin_about(double normal) const { return spin_given + linear.spin_lag * normal; }
  Vec2 rolling_about(double normal) const { return rolling_given + linear.rolling_lag * normal; }

  /// The impulses y that rows of compliance Σ answer to x, one after the other: the nearest one of the
  /// normal, and in what that allows those of the discs.  All are of the contact's 3 rows, or 6 with `twist`.
  void project(std::span<const double> x, std::span<const double> sigma, std::span<double> y) const {
    std::fill(y.begin(), y.end(), 0.0);
    if (!works) return;
    const auto in_disc = [&](int r, const Vec2& given, double bound, double part) {
      const Vec2 tau = into_disc({given[0] + x[r], given[1] + x[r + 1]}, bound, part);
      y[r] = tau[0] - given[0];
      y[r + 1] = tau[1] - given[1];
    };
    y[0] = std::min(std::max(-normal_given, x[0]), most - normal_given);
    const double normal = normal_given + y[0];
    in_disc(1, sliding_given, sliding * std::max(0.0, normal), 0);
    if (!twist) return;
    const double spin = spin_about(normal);
    y[3] = into_interval(spin + x[3], spinning * normal, part_of_slope(linear.spinning * normal, sigma[3])) -
           spin;
    in_disc(4, rolling_about(normal), rolling * normal,
            part_of_slope(linear.rolling * normal, std::max(sigma[4], sigma[5])));
  }
};

}  // namespace taut
