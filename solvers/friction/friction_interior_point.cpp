#include "solvers/friction/friction_interior_point.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/friction/interior_points.h"

namespace taut {
namespace {

using Vector = Eigen::VectorXd;

constexpr int kInteriorSteps = 40;
/// So near Newton takes over: at 1e-3 it fails in 5 of 81 problems more than at 1e-6.
constexpr double kNear = 1e-6;
/// Part of the way to the boundary of the cones that a step goes.
constexpr double kBoundary = 0.9;
/// A step of less is a bad one: after two the centre is aimed at, after nine it ends.
constexpr double kShortStep = 0.1;
constexpr int kFewShortSteps = 2, kMostShortSteps = 8;
constexpr double kLeastCentring = 1e-6, kStrongCentring = 0.9;

double cube(double x) { return x * x * x; }

}  // namespace

Vector interior_point(const ScaledFriction& problem, BestImpulses& best) {
  InteriorPoints at(problem);
  Vector nearest = at.impulses(), dy, dz;
  double least = std::numeric_limits<double>::infinity();
  int shorts = 0;
  for (int i = 0; i < kInteriorSteps && at.cones() > 0 && shorts <= kMostShortSteps; ++i) {
    const Vector r = problem.project(at.impulses()), residual = at.residual();
    if (const double off = best.offer(r); off < least) {
      least = off;
      nearest = r;
    }
    const double gap = at.gap();
    if (least <= kNear || !std::isfinite(gap)) break;
    InteriorNewton newton(at);
    ++best.factorisations;
    if (!newton.factorize() || !newton.direction(newton.to_centre(0), residual, 1, dy, dz)) break;
    const bool steady = shorts < kFewShortSteps;
    const double reach = at.way(dy, dz, 1, 1), left = std::max(0.0, at.gap_after(reach, dy, dz)) / gap;
    const double centring =
        steady ? std::clamp(std::max(cube(left), cube(1 - reach)), kLeastCentring, 1.0) : kStrongCentring;
    Vector to = newton.to_centre(centring * gap);
    if (steady) to -= reach * reach * newton.second_order(dy, dz);
    if (!newton.direction(to, residual, 1 - centring, dy, dz)) break;
    const double part = at.way(dy, dz, kBoundary, 1);
    shorts = part < kShortStep ? shorts + 1 : 0;
    at.go(part, dy, dz);
  }
  return nearest;
}

}  // namespace taut
