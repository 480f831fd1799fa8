#pragma once

#include <algorithm>
#include <cmath>

#include "core/axes/axis.h"
#include "solvers/laws/axes/axis_part_law.h"
#include "solvers/laws/impulse_line.h"

namespace taut {

/// Motor of one axis with gains: λ = level − slope w, the implicit midpoint rule of a spring and damper whose
/// rest moves with the target, held within what the motor has.  Where the step does not resolve the stiffness
/// it turns into the target itself (solvers/laws/axes, "Servos").
struct AxisServoLaw : AxisPartLaw {
  ImpulseLine line;      ///< of this stage, without the bound
  double bound = 0;      ///< impulse in this stage; 0: none [N·m·s or N·s]
  double excess = 0;     ///< η, slope beyond that of the midpoint rule
  TangentPoint tangent;  ///< where the law is taken as its line or one of its ends

  void begin(const AxisProperties&, const AxisStep&, const AxisStart& start) { tangent.start(start.rate); }
  void release() { line = {}, bound = 0; }
  bool set(const AxisStage& stage);
  void finish_first_kick(const AxisProperties& p, const AxisStart&, double w);
  void add_to(RowLaw& law, const AxisProperties&) const {
    const ImpulseLine part = at_present();
    for (int k = 0; k <= law.steps; ++k) law.level[k] += part.level;
    law.slope += part.slope;
  }
  /// To its line or to an end, as w asks.
  bool move(const AxisProperties& p, const AxisStep& step, const AxisStart& start, double w,
            double rate_tolerance);
  void split_lines(AxisImpulse& impulse, double& rest, double w) const {
    if (bound > 0) rest -= impulse.motor += at_present().at(w);
  }
  void report(AxisReport& report, const AxisProperties& p, double w) const {
    if (p.motor && p.motor->has_gains()) report.saturated = !(std::abs(line.at(w)) <= bound);
  }
  template <typename AnyArchive>
  void transfer(AnyArchive& archive) {
    archive(line.level, line.slope, bound, excess, tangent.rate, tangent.lowest, tangent.highest, given_,
            mean_);
  }

 private:
  bool set_first_kick(const AxisStage& stage);
  bool set_second_kick(const AxisStage& stage);
  bool set_single_kick(const AxisStage& stage);
  ImpulseLine at_present() const;
  double held(double w) const { return std::clamp(line.at(w), -bound, bound); }
  bool take(const ImpulseLine& whole, double available);

  double given_ = 0, mean_ = 0;  // impulse of the first kick, without the bound, and its rate
};

}  // namespace taut
