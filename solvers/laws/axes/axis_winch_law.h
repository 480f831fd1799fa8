#pragma once

#include <algorithm>
#include <cmath>

#include "core/axes/axis.h"
#include "solvers/laws/axes/axis_part_law.h"

namespace taut {

/// Winch on the length of a rope in a stage: the way of the rope is no longer than what is let out at the end
/// of the step, −bound ≤ λ ≤ 0.  (solvers/laws/axes, "Winches")
struct AxisWinchLaw : AxisPartLaw {
  double at = 0;          ///< the largest rate of this stage, where it pulls [m/s]
  double bound = 0;       ///< impulse in this stage; 0: none [N·s]
  double back = 0;        ///< what it gave in the first kick and may take back
  double length = 0;      ///< let out at the end of the step if its force suffices [m]
  bool slipping = false;  ///< at the end of the last step

  bool set(const AxisStage& stage);
  void release() { bound = 0; }
  void add_to(RowLaw& law, const AxisProperties&) const {
    if (bound > 0) law.add_step(at, back, -bound);
  }
  void split_beside(AxisImpulse& impulse, double& rest, double w) const {
    if (bound > 0 && !holds(w)) rest -= impulse.motor += w < at ? back : -bound;
  }
  void split_on_step(AxisImpulse& impulse, double& rest, double w) const {
    if (bound > 0 && holds(w)) rest -= impulse.motor += std::clamp(rest, -bound, back);
  }
  void report(AxisReport& report, const AxisProperties& p, double w) const {
    if (p.motor && p.motor->pulls_only) report.saturated = slips(w);
  }
  /// The rope comes off against the winch, whose force is too small.
  bool slips(double w) const { return w > at && !on_step(w, at); }
  void finish(AxisReport&, const AxisEnd& end) { slipping = slips(end.rate); }
  /// It has held the rope, or would have, in the last step.
  bool holds_rope() const { return bound > 0 && !slipping; }
  /// What is let out at the end of a step with θ there.
  double let_out(double theta) const { return theta > length + LawTuning::kTouch ? theta : length; }
  template <typename AnyArchive>
  void transfer(AnyArchive& archive) {
    archive(at, bound, back, length, slipping);
  }

 private:
  /// One without bound does whatever it has to where the rope would get longer.
  bool holds(double w) const { return on_step(w, at) || (std::isinf(bound) && w > at); }
  double wind(const AxisStage& stage);
  double rate_to_hold(const AxisStage& stage, double rate) const;
};

}  // namespace taut
