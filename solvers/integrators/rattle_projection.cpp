#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/common/max_abs.h"
#include "solvers/common/stopwatch.h"
#include "solvers/integrators/rattle.h"

// Positions of dependent rows: how far they are from closed, and closing what the step's own Newton cannot.
// (solvers/integrators, "Weak directions")
namespace taut {
namespace {

constexpr double kMended = 1e-13;
constexpr double kMendingShift = 1e-12;
constexpr int kMaxMends = 10;
/// Passes in a row that may widen the gap: where J itself is about to vanish the first move may be far too
/// long, and the next ones still close it.
constexpr int kOvershoots = 1;

}  // namespace

/// Diagonal of the box around all bodies, but at least 1 m.
double Rattle::system_size() const {
  Eigen::AlignedBox3d box;
  for (const Pose& pose : state_.poses) box.extend(pose.p);
  return std::max(1.0, box.diagonal().norm());
}

/// How far the bodies are from closed joints, to first order: the largest move in M⁻¹ Jᵀ S_ε⁻¹ φ [m or rad].
double Rattle::distance_to_closure(StepReport& report) {
  const Stopwatch watch(report.times.positions);
  std::copy(phi_.begin(), phi_.end(), delta_.begin());
  system_.solve_shifted(delta_);
  system_.rows().apply_transpose(system_.jacobian(), delta_, move_);
  double distance = 0;
  for (int b = 0; b < world_.body_count(); ++b) {
    const MassMatrix::Body& body = system_.mass()[b];
    if (body.fixed) continue;
    distance = std::max({distance, body.inverse_mass * move_[b].force.norm(),
                         system_.mass().angular_velocity(b, poses_[b], move_[b].torque).norm()});
  }
  return distance;
}

/// Gauss–Newton on the positions alone, q₁ ← q₁ − M⁻¹Jᵀ S⁺ φ with all of it at the iterate.  It converges
/// quadratically, also along directions that the rows hold weakly, where the fixed J(q₀) of the Newton above
/// does not: there J(q₁) − J(q₀) outweighs J itself.  (solvers/integrators, "Weak directions")
bool Rattle::project_positions(double h, StepReport& report) {
  if (!refactored_) start_jacobian_.assign(system_.jacobian().begin(), system_.jacobian().end());
  refactored_ = true;
  const Configuration end(poses_, state_.time + h, state_.axes);
  system_.set_shift(kMendingShift);
  double gap = max_abs(phi_), best = gap;
  best_poses_ = poses_;
  for (int pass = 0, in_vain = 0; pass < kMaxMends && gap > kMended && in_vain <= kOvershoots; ++pass) {
    system_.linearize(end);
    system_.set_mass(poses_);
    system_.factorize(report.times);
    ++report.counts.refactorizations;
    if (!system_.usable()) break;
    const Stopwatch watch(report.times.positions);
    for (int r = 0; r < system_.row_count(); ++r) delta_[r] = -phi_[r];
    system_.solve_shifted(delta_);
    system_.rows().apply_transpose(system_.jacobian(), delta_, move_);
    for (int b = 0; b < world_.body_count(); ++b) {
      const MassMatrix::Body& body = system_.mass()[b];
      if (body.fixed) continue;
      const Vec3 turn = system_.mass().angular_velocity(b, poses_[b], move_[b].torque);
      poses_[b].p += body.inverse_mass * move_[b].force;
      poses_[b].q = (exp_so3(turn) * poses_[b].q).normalized();
    }
    system_.rows().residual(end, phi_);
    in_vain = max_abs(phi_) < 0.9 * gap ? 0 : in_vain + 1;
    gap = max_abs(phi_);
    if (gap < best) {
      best = gap;
      best_poses_ = poses_;
    }
  }
  system_.set_shift(kSteppingTolerance.shift);
  system_.set_mass(state_.poses);  // where the kick acts
  if (!(gap <= best)) {
    std::copy(best_poses_.begin(), best_poses_.end(), poses_.begin());
    system_.rows().residual(end, phi_);
  }
  prediction_missed_ = false;
  return best <= settings_.position_tolerance;
}

}  // namespace taut
