#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/friction/friction_interior_point.h"
#include "solvers/friction/friction_newton.h"
#include "solvers/friction/interior_points.h"

namespace taut {
namespace {

using Vector = Eigen::VectorXd;

/// Two of two random stages that 400 leave end within 1,800.
constexpr int kMostPathSteps = 4000;
/// √(z_T² + smooth²) at τ = 1, of √(y·z).  0: the curve has kinks, and none of six hard problems is solved.
constexpr double kSmoothSlip = 0.1;
/// Steps start within kOnPath of the curve and end within kNearPath; else they are shortened, eight times at
/// most, before the curve is returned to.
constexpr double kOnPath = 0.5, kNearPath = 0.7, kShorter = 0.4;
constexpr int kMostTries = 12, kShorterTries = 5;
constexpr double kFirstStep = 0.7, kMostStep = 2, kLeastStep = 1e-3;
/// From here on Newton is tried at each tenth of τ.
constexpr double kFirstTry = 1e-3;
/// The end, if Newton has not found one.
constexpr double kLastTau = 1e-14;

/// A point of the curve, or near it, at log τ.
struct OnPath {
  InteriorPoints at;
  double log_tau = 0;

  double tau() const { return std::exp(log_tau); }
};

/// The curve through the start.
class Path {
 public:
  explicit Path(const ScaledFriction& problem)
      : now_{InteriorPoints(problem)},
        centre_(now_.at.gap()),
        smooth_(kSmoothSlip * std::sqrt(centre_)),
        first_residual_(now_.at.residual(smooth_)) {}

  const OnPath& now() const { return now_; }

  /// One step along the curve, with the way back to it.  False at its end.
  bool step(BestImpulses& best) {
    const double tau = now_.tau();
    InteriorNewton newton(now_.at, tau * smooth_);
    ++best.factorisations;
    Vector back_y, back_z, along_y, along_z;
    if (!newton.factorize() ||
        !newton.direction(newton.to_centre(tau * centre_), residual(now_), 1, back_y, back_z) ||
        !newton.direction(newton.unit(tau * centre_), rate_of_residual(), 1, along_y, along_z))
      return false;
    const double scale = tau * centre_, length = newton.inner(along_y, along_z, along_y, along_z) / scale + 1;
    if (last_y_.size() > 0)
      sign_ = newton.inner(last_y_, last_z_, along_y, along_z) / scale + last_sign_ < 0 ? -1 : 1;
    // Back to the curve at right angles to it, and along it.
    const double aside = -newton.inner(back_y, back_z, along_y, along_z) / scale / length;
    const double off = distance(now_);
    double part = 1, ahead = 0;
    if (off < kOnPath) ahead = now_.at.way(sign_ * along_y, sign_ * along_z, kNearPath, longest_);
    for (int i = 0; i < kMostTries; ++i) {
      OnPath next = now_;
      const double move = part * aside + sign_ * ahead;
      const Vector dy = part * back_y + move * along_y, dz = part * back_z + move * along_z;
      const double reach = next.at.way(dy, dz, 0.9, 1);
      next.at.go(reach, dy, dz);
      next.log_tau += reach * move;
      if (distance(next) < (ahead > 0 ? kNearPath : std::max(kNearPath, 0.95 * off))) {
        now_.at.y = next.at.y;
        now_.at.z = next.at.z;
        now_.log_tau = next.log_tau;
        longest_ =
            i == 0 ? std::min(kMostStep, 2 * std::max(longest_, kLeastStep)) : std::max(kLeastStep, ahead);
        if (ahead > 0) {
          last_y_ = sign_ * along_y;
          last_z_ = sign_ * along_z;
          last_sign_ = sign_;
        }
        return true;
      }
      if (ahead > 0)
        ahead = i < kShorterTries - 1 ? kShorter * ahead : 0;
      else
        part /= 2;
    }
    return false;
  }

 private:
  Vector residual(const OnPath& p) const {
    return p.at.residual(p.tau() * smooth_) - p.tau() * first_residual_;
  }
  /// ∂/∂log τ of it.
  Vector rate_of_residual() const {
    const double tau = now_.tau(), s = tau * smooth_;
    Vector rate = -tau * first_residual_;
    const Vector& z = now_.at.z;
    for (const auto& [law, first, n, mu] : now_.at.problem.blocks())
      if (law == ScaledFriction::Law::kCone) rate[first] += s * s / std::hypot(z[first + 1], z[first + 2], s);
    return rate;
  }
  /// From the curve; 0 on it, 1 at the boundary of the cones.
  double distance(const OnPath& p) const {
    const double of_residual = residual(p).cwiseAbs().maxCoeff() / (p.tau() * std::sqrt(centre_));
    return std::max(p.at.off_centre(p.tau() * centre_), of_residual);
  }

  OnPath now_;
  double centre_, smooth_;
  Vector first_residual_;
  double sign_ = -1, last_sign_ = -1, longest_ = kFirstStep;
  Vector last_y_, last_z_;
};

}  // namespace

Vector follow_path(const ScaledFriction& problem, BestImpulses& best) {
  if (InteriorPoints(problem).cones() == 0) return best.r();
  Path path(problem);
  Vector nearest = best.r();
  double least = std::numeric_limits<double>::infinity(), next_try = kFirstTry;
  for (int i = 0; i < kMostPathSteps && path.now().tau() > kLastTau; ++i) {
    const Vector r = problem.project(path.now().at.impulses());
    if (const double off = best.offer(r); off < least) {
      least = off;
      nearest = r;
    }
    if (const double tau = path.now().tau(); tau < next_try) {
      next_try = tau / 10;
      FrictionNewton{.gamma = 30, .steps = 8, .memory = 10, .patience = 4}.solve(problem, r, best);
    }
    if (best.met() || !path.step(best)) break;
  }
  return nearest;
}

}  // namespace taut
