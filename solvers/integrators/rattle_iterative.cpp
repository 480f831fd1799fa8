#include <algorithm>
#include <cmath>

#include "solvers/common/max_abs.h"
#include "solvers/common/stopwatch.h"
#include "solvers/integrators/rattle.h"
#include "solvers/integrators/rattle_tuning.h"

// The two stages of a step by iterative impulses, for comparison: what RATTLE calls λ is then the
// pre-stabilisation of positions of [Weinstein2006], and μ the post-stabilisation of velocities.  Neither is
// closed to a tolerance: the report says how open they are.  (solvers/complementarity, "Iterative impulses")
namespace taut {

/// λ that takes φ(q₁) towards 0 and the other rows towards their laws.
bool Rattle::stabilize_positions(double h, std::span<double> lambda, std::span<Pose> q1,
                                 SubstepReport& report) {
  const Stopwatch watch(report.times.positions);
  std::fill(absorbed_.begin(), absorbed_.end(), Wrench{});
  const StageSolver::Renew renew = [this] { renew_laws(); };
  for (int left = settings_.iterations;; left -= RattleTuning::kSweepsPerPass) {
    try_positions(h, lambda, q1, false);
    if (!std::isfinite(max_abs(values_.phi)) || !axes_.finite()) return false;
    if (left <= 0) break;
    const double tolerance = StageSolver::kRatePart * settings_.position_tolerance / h;
    const StageSolver::Stage stage{lambda, values_.rates, renew};
    if (!stages_.iterate(stage, std::min(left, RattleTuning::kSweepsPerPass), tolerance, absorbed_, report))
      return false;
    ++report.newton_iterations;
  }
  stages_.note_residual(lambda, values_.rates);
  axes_.finish_positions(values_.rates);
  prediction_missed_ = false;
  return true;
}

}  // namespace taut
