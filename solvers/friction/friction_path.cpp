#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/friction/friction_interior_point.h"
#include "solvers/friction/friction_newton.h"
#include "solvers/friction/interior_points.h"

namespace taut {
namespace {

using Vector = Eigen::VectorXd;

/// Without a unit: parts and counts; distances are those of Path::distance(), 1 at the boundary of the cones.
/// Chosen, where nothing else is said.  (solvers/friction, "Path of last resort")
struct FrictionPathTuning {
  /// Steps at most, a factorisation each: two of two random stages that 400 leave end within 1,800.
  static constexpr int kMostPathSteps = 4000;
  /// √(z_T² + smooth²) at τ = 1, as a part of √(y·z).  0: the curve has kinks, and none of six hard problems
  /// is solved; twice leaves two of five random stages inexact.
  static constexpr double kSmoothSlip = 0.1;
  /// Steps start within kOnPath of the curve, or go back to it alone, and end within kNearPath: twice
  /// leaves a random stage inexact.
  static constexpr double kOnPath = 0.5, kNearPath = 0.7;
  /// One that does not is tried again with this part of the way along the curve, after so many tries without
  /// any, and then with halves of the way back, kMostTries in all: half leaves two random stages inexact.
  static constexpr double kShorter = 0.4;
  static constexpr int kShorterTries = 5, kMostTries = 12;
  /// On the way back this part of the distance may be left.
  static constexpr double kComesBack = 0.95;
  /// Steps of log τ are no longer than a limit that doubles with each that is taken at once, and falls to
  /// what one that is not has come to: at first, at most, at least.
  static constexpr double kFirstStep = 0.7, kMostStep = 2, kLeastStep = 1e-3;
  /// From the first τ on Newton is tried, and again at each τ that is so many times less.
  static constexpr double kFirstTry = 1e-3, kTriesApart = 10;
  /// τ at the end, if Newton has not found one.
  static constexpr double kLastTau = 1e-14;
};

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
        smooth_(Tuning::kSmoothSlip * std::sqrt(centre_)),
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
    if (off < Tuning::kOnPath)
      ahead = now_.at.way(sign_ * along_y, sign_ * along_z, Tuning::kNearPath, longest_);
    for (int i = 0; i < Tuning::kMostTries; ++i) {
      OnPath next = now_;
      const double move = part * aside + sign_ * ahead;
      const Vector dy = part * back_y + move * along_y, dz = part * back_z + move * along_z;
      const double reach = next.at.way(dy, dz, InteriorPointsTuning::kBoundary, 1);
      next.at.go(reach, dy, dz);
      next.log_tau += reach * move;
      if (distance(next) <
          (ahead > 0 ? Tuning::kNearPath : std::max(Tuning::kNearPath, Tuning::kComesBack * off))) {
        now_.at.y = next.at.y;
        now_.at.z = next.at.z;
        now_.log_tau = next.log_tau;
        longest_ = i == 0 ? std::min(Tuning::kMostStep, 2 * std::max(longest_, Tuning::kLeastStep))
                          : std::max(Tuning::kLeastStep, ahead);
        if (ahead > 0) {
          last_y_ = sign_ * along_y;
          last_z_ = sign_ * along_z;
          last_sign_ = sign_;
        }
        return true;
      }
      if (ahead > 0)
        ahead = i < Tuning::kShorterTries - 1 ? Tuning::kShorter * ahead : 0;
      else
        part /= 2;
    }
    return false;
  }

 private:
  using Tuning = FrictionPathTuning;

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
  double sign_ = -1, last_sign_ = -1, longest_ = Tuning::kFirstStep;
  Vector last_y_, last_z_;
};

}  // namespace

Vector follow_path(const ScaledFriction& problem, BestImpulses& best) {
  using Tuning = FrictionPathTuning;
  if (InteriorPoints(problem).cones() == 0) return best.r();
  Path path(problem);
  Vector nearest = best.r();
  double least = std::numeric_limits<double>::infinity(), next_try = Tuning::kFirstTry;
  for (int i = 0; i < Tuning::kMostPathSteps && path.now().tau() > Tuning::kLastTau; ++i) {
    const Vector r = problem.project(path.now().at.impulses());
    if (const double off = best.offer(r); off < least) {
      least = off;
      nearest = r;
    }
    if (const double tau = path.now().tau(); tau < next_try) {
      next_try = tau / Tuning::kTriesApart;
      kNewtonOnTheWay.solve(problem, r, best);
    }
    if (best.met() || !path.step(best)) break;
  }
  return nearest;
}

}  // namespace taut
