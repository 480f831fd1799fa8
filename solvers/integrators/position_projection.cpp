#include "solvers/integrators/position_projection.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "solvers/common/max_abs.h"
#include "solvers/common/stopwatch.h"

namespace taut {
namespace {

constexpr double kMended = 1e-13;
constexpr double kMendingShift = 1e-12;
constexpr int kMaxMends = 10;
/// Passes in a row that may widen the gap: where J itself is about to vanish the first move may be far too
/// long, and the next ones still close it.
constexpr int kOvershoots = 1;

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
      best_(phase.kicked.size()) {}

double PositionProjection::distance_to_closure(StepReport& report) {
  const Stopwatch watch(report.times.positions);
  std::copy(values_.phi.begin(), values_.phi.end(), values_.delta.begin());
  system_.solve_shifted(values_.delta);
  system_.rows().apply_transpose(system_.jacobian(), values_.delta, move_);
  double distance = 0;
  for (int b = 0; b < std::ssize(move_); ++b) {
    const MassMatrix::Body& body = system_.mass()[b];
    if (body.fixed) continue;
    distance = std::max({distance, body.inverse_mass * move_[b].force.norm(),
                         system_.mass().angular_velocity(b, phase_.poses[b], move_[b].torque).norm()});
  }
  return distance;
}

bool PositionProjection::close(double h, StepReport& report) {
  start_.keep();
  std::vector<Pose>& poses = phase_.poses;
  std::vector<double>&phi = values_.phi, &delta = values_.delta;
  const Configuration end(poses, phase_.state.time + h, phase_.state.axes);
  system_.set_shift(kMendingShift);
  double gap = max_abs(phi), best = gap;
  best_ = poses;
  for (int pass = 0, in_vain = 0; pass < kMaxMends && gap > kMended && in_vain <= kOvershoots; ++pass) {
    system_.linearize(end);
    system_.set_mass(poses);
    system_.factorize(report.times);
    ++report.counts.refactorizations;
    if (!system_.usable()) break;
    const Stopwatch watch(report.times.positions);
    for (int r = 0; r < system_.row_count(); ++r) delta[r] = -phi[r];
    system_.solve_shifted(delta);
    move_bodies();
    system_.rows().residual(end, phi);
    in_vain = max_abs(phi) < 0.9 * gap ? 0 : in_vain + 1;
    gap = max_abs(phi);
    if (gap < best) {
      best = gap;
      best_ = poses;
    }
  }
  system_.set_shift(kSteppingTolerance.shift);
  system_.set_mass(phase_.state.poses);  // where the kick acts
  if (!(gap <= best)) {
    std::copy(best_.begin(), best_.end(), poses.begin());
    system_.rows().residual(end, phi);
  }
  return best <= settings_.position_tolerance;
}

/// By M⁻¹Jᵀ δ.
void PositionProjection::move_bodies() {
  system_.rows().apply_transpose(system_.jacobian(), values_.delta, move_);
  for (int b = 0; b < std::ssize(move_); ++b) {
    const MassMatrix::Body& body = system_.mass()[b];
    if (body.fixed) continue;
    Pose& pose = phase_.poses[b];
    const Vec3 turn = system_.mass().angular_velocity(b, pose, move_[b].torque);
    pose.p += body.inverse_mass * move_[b].force;
    pose.q = (exp_so3(turn) * pose.q).normalized();
  }
}

}  // namespace taut
