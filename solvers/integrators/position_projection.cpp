#include "solvers/integrators/position_projection.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "solvers/common/max_abs.h"
#include "solvers/common/stopwatch.h"
#include "solvers/integrators/gauss_newton.h"
#include "solvers/integrators/rattle_tuning.h"

namespace taut {
namespace {

/// Without a unit: parts and counts.  Chosen, where nothing else is said.  (solvers/integrators, "Weak
/// directions")
struct PositionProjectionTuning {
  /// ε of S_ε, of the factor that sees directions which masses make weak: between the round-off of S and the
  /// 1e-8 of the factor for stepping, which does not.
  static constexpr double kMendingShift = 1e-12;
  /// Longest move, in gaps, that closes joints which masses alone hold weakly: it is about as long as they.
  /// One of a direction that is weak by the places of the joints is gap/√σ, 1e4 gaps and more.
  static constexpr double kLongWay = 30;

  // Moves without impulses.
  /// Gaps [m or rad] that are closed: the round-off of poses a few hundred metres from the origin.
  static constexpr double kMended = 1e-13;
  /// Passes at most; they converge quadratically.
  static constexpr int kMaxMends = 10;
  /// Passes in a row that may leave more than the second, which is a part of the gap: where J itself is about
  /// to vanish the first move may be far too long, and the next ones still close it.
  /// kInVain: half fails where a body of 5 t hangs on one of 1e-7 kg.
  static constexpr int kOvershoots = 1;
  static constexpr double kInVain = 0.9;
};

}  // namespace

double system_size(std::span<const Pose> poses) {
  Eigen::AlignedBox3d box;
  for (const Pose& pose : poses) box.extend(pose.p);
  return std::max(1.0, box.diagonal().norm());
}

PositionProjection::PositionProjection(ConstraintSystem& system, const Settings& settings,
                                       StartJacobian& start, Phase& phase, RowValues& values)
    : system_(system),
      settings_(settings),
      start_(start),
      phase_(phase),
      values_(values),
      move_(phase.kicked.size()),
      best_(phase.kicked.size()),
      lambda_(values.lambda.size()) {}

double PositionProjection::distance_to_closure(std::span<double> correction, SubstepReport& report) {
  const Stopwatch watch(report.times.positions);
  std::copy(values_.phi.begin(), values_.phi.end(), correction.begin());
  system_.solve_shifted(correction);
  system_.rows().apply_transpose(system_.jacobian(), correction, move_);
  const MassMatrix& mass = system_.mass();
  return std::max(largest_displacement(mass, move_), largest_turn(mass, move_, phase_.trial_poses));
}

bool PositionProjection::close(double h, double far, const std::function<void()>& drift,
                               SubstepReport& report) {
  (void)start_.keep();  // so that the step has its factor made again
  return close_light_bodies(h, far, drift, report) || close_by_moves(h, report);
}

/// Rows that light bodies between heavy ones make weak hide no long way behind their gaps: they are closed by
/// impulses as others are, with a factor that sees them.  Unlike moves these keep the angular momentum.
/// @returns false, with λ as it was, where a gap hides a long way, or stays.
bool PositionProjection::close_light_bodies(double h, double far, const std::function<void()>& drift,
                                            SubstepReport& report) {
  double gap = max_abs(values_.phi);
  if (gap <= settings_.position_tolerance) return false;  // what is open are long ways alone
  std::vector<double>& correction = values_.correction;
  lambda_ = values_.lambda;
  factorize_finely(report);
  for (double last = 2 * gap; system_.usable() && gap <= RattleTuning::kSlowNewton * last;) {
    const double way = distance_to_closure(correction, report);
    if (gap <= settings_.position_tolerance && way <= far) return true;
    if (!(way <= PositionProjectionTuning::kLongWay * gap)) break;
    system_.project(correction);
    for (int r = 0; r < system_.row_count(); ++r) values_.lambda[r] -= correction[r] / h;
    drift();
    last = std::exchange(gap, max_abs(values_.phi));
    ++report.newton_iterations;
  }
  values_.lambda = lambda_;
  drift();
  return false;
}

void PositionProjection::factorize_finely(SubstepReport& report) {
  system_.set_shift(PositionProjectionTuning::kMendingShift);
  system_.factorize(report.times);
  system_.set_shift(RankTuning::kStepping.shift);
  ++report.counts.refactorizations;
}

/// Gauss–Newton on the poses at the end: there J(q₁) − J(q₀) outweighs J itself along weak directions.
bool PositionProjection::close_by_moves(double h, SubstepReport& report) {
  std::vector<Pose>& poses = phase_.trial_poses;
  std::vector<double>& phi = values_.phi;
  const Configuration end(poses, phase_.state.time + h, phase_.state.axes);
  double gap = max_abs(phi), best = gap;
  best_ = poses;
  int pass = 0, in_vain = 0;
  const auto ask = [&](std::span<double> delta) {
    if (pass++ > 0) {
      const Stopwatch watch(report.times.positions);
      system_.rows().residual(end, phi);
      in_vain = max_abs(phi) < PositionProjectionTuning::kInVain * gap ? 0 : in_vain + 1;
      gap = max_abs(phi);
      if (gap < best) {
        best = gap;
        best_ = poses;
      }
    }
    for (std::size_t r = 0; r < delta.size(); ++r) delta[r] = -phi[r];
    return pass <= PositionProjectionTuning::kMaxMends && gap > PositionProjectionTuning::kMended &&
           in_vain <= PositionProjectionTuning::kOvershoots;
  };
  const auto factorize = [&] {
    factorize_finely(report);
    return system_.usable();
  };
  const auto solve = [&](std::span<double> delta) {
    const Stopwatch watch(report.times.positions);
    system_.solve_shifted(delta);
  };
  gauss_newton(system_, end, poses, INFINITY, values_.correction, move_, ask, factorize, solve);
  system_.set_mass(phase_.state.poses);  // where the kick acts
  if (!(gap <= best)) {
    std::copy(best_.begin(), best_.end(), poses.begin());
    system_.rows().residual(end, phi);
  }
  return best <= settings_.position_tolerance;
}

}  // namespace taut
