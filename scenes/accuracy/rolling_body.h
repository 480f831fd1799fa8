#pragma once

#include <functional>

#include "core/state/state.h"

namespace taut::reference {

/// Point of a convex surface where its outward normal is −n, from the centre of mass, body axes, and its
/// derivative by n.
struct SurfacePoint {
  Vec3 p;
  Mat3 slope;
};
/// Of an ellipsoid about `centre`: p = centre − A n/√(n·A n) with A = diag(radii²).
SurfacePoint on_ellipsoid(const Vec3& radii, const Vec3& centre, const Vec3& n);
/// Of the rim of a cylinder about z, on the side that n points away from.
SurfacePoint on_rim(double radius, double half, const Vec3& n);

/// A body that rolls without slip on the plane z = 0: three equations of Euler about the centre of mass, with
/// the contact's force eliminated, in body axes.                                   (scenes/accuracy/CONTACTS,
/// Eq. 2)
struct RollingBody {
  double mass = 1;
  Mat3 inertia = Mat3::Identity();
  double gravity = 9.81;
  std::function<SurfacePoint(const Vec3& n)> surface;
  double rolling_arm = 0;  ///< of rolling friction [m]
};

/// Its motion over `time` [s] by the classical Runge–Kutta method.  Of `start` orientation, angular velocity
/// and the position along x and y count; the rest follows.  @param watch sees each step, may be empty
struct RollingState {
  Pose pose;
  Twist twist;
};
RollingState roll(const RollingBody& body, const RollingState& start, double time, int steps,
                  const std::function<void(double t, const RollingState&)>& watch = nullptr);

}  // namespace taut::reference
