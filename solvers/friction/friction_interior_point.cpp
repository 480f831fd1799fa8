#include "solvers/friction/friction_interior_point.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/friction/interior_points.h"

namespace taut {
namespace {

using Vector = Eigen::VectorXd;

/// Without a unit: parts and counts.  Chosen, where nothing else is said.  (solvers/friction, "Rungs")
struct FrictionInteriorPointTuning {
  /// Steps at most, a factorisation each.  Half: 2.9 times the factorisations of spheres in a box.
  static constexpr int kInteriorSteps = 40;
  /// The error, as that which is to be met, at which Newton takes over: at 1e-3 it fails in 5 of 81 problems
  /// more than at 1e-6.
  static constexpr double kNear = 1e-6;
  /// A step that goes less than this part of its way is a bad one; after so many in a row the centre is aimed
  /// at, after more than the second number it ends.
  static constexpr double kShortStep = 0.1;
  static constexpr int kFewShortSteps = 2, kMostShortSteps = 8;
  /// Part of y·z that a step aims at: at least, and where the centre is aimed at.
  static constexpr double kLeastCentring = 1e-6, kStrongCentring = 0.9;
};

double cube(double x) { return x * x * x; }

}  // namespace

Vector interior_point(const ScaledFriction& problem, BestImpulses& best) {
  using Tuning = FrictionInteriorPointTuning;
  InteriorPoints at(problem);
  Vector nearest = at.impulses(), dy, dz;
  double least = std::numeric_limits<double>::infinity();
  int shorts = 0;
  for (int i = 0; i < Tuning::kInteriorSteps && at.cones() > 0 && shorts <= Tuning::kMostShortSteps; ++i) {
    const Vector r = problem.project(at.impulses()), residual = at.residual();
    if (const double off = best.offer(r); off < least) {
      least = off;
      nearest = r;
    }
    const double gap = at.gap();
    if (least <= Tuning::kNear || !std::isfinite(gap)) break;
    InteriorNewton newton(at);
    ++best.factorisations;
    if (!newton.factorize() || !newton.direction(newton.to_centre(0), residual, 1, dy, dz)) break;
    const bool steady = shorts < Tuning::kFewShortSteps;
    const double reach = at.way(dy, dz, 1, 1), left = std::max(0.0, at.gap_after(reach, dy, dz)) / gap;
    const double centring =
        steady ? std::clamp(std::max(cube(left), cube(1 - reach)), Tuning::kLeastCentring, 1.0)
               : Tuning::kStrongCentring;
    Vector to = newton.to_centre(centring * gap);
    if (steady) to -= reach * reach * newton.second_order(dy, dz);
    if (!newton.direction(to, residual, 1 - centring, dy, dz)) break;
    const double part = at.way(dy, dz, InteriorPointsTuning::kBoundary, 1);
    shorts = part < Tuning::kShortStep ? shorts + 1 : 0;
    at.go(part, dy, dz);
  }
  return nearest;
}

}  // namespace taut
