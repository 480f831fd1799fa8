#pragma once

#include "core/axes/axis.h"
#include "core/world/swing_properties.h"
#include "solvers/laws/axes/axis_part_law.h"
#include "solvers/laws/impulse_line.h"

namespace taut {

/// A limit that is a spring beyond it.
inline bool has_soft_limit(const AxisProperties& p) { return p.limits && p.limits->compliance > 0; }
/// Its law has curves, which are taken by their tangents: tables and soft limits.
inline bool is_curved(const AxisProperties& p) { return !detail::is_linear(p.spring) || has_soft_limit(p); }

/// Springs and dampers of one axis, viscous friction and soft limits among them, as straight lines
/// λ = l − c w of a stage; tables and soft limits as tangents.  (solvers/laws, "Axes")
///
/// The mean force on the way of a step times that way is the change of its potential, so that tables and soft
/// limits conserve energy however stiff they are and wherever they bend; for a linear force it is the force
/// at mid-step.  RATTLE gives in the second kick what springs and dampers gave in the first; stiff dampers,
/// and what springs have in excess of the midpoint rule (axis_unresolved.h), act on θ̇(q₁) there instead.
struct AxisSpringLaw : AxisPartLaw {
  double excess = 0;                  ///< η, slope beyond h²k/4 of a spring that is not resolved
  double limit_excess = 0;            ///< the same of a soft limit
  ImpulseLine spring, damper, limit;  ///< of this stage
  /// Impulses of the first kick [N·m·s or N·s].
  double spring_given = 0, damping_given = 0, limit_given = 0;
  double linear_damping = 0;      ///< slope of all dampers without a table
  bool implicit_damping = false;  ///< dampers act on θ̇(q₁) in the second kick
  bool beyond_limit = false;      ///< a soft one, at q₁
  TangentPoint tangents;          ///< of the curves

  double slope() const { return spring.slope + damper.slope + limit.slope; }
  double level() const { return spring.level + damper.level + limit.level; }

  void begin(const AxisProperties& p, const AxisStep& step, const AxisStart& start);
  /// Gives nothing in the first kick.
  void release() {
    spring = limit = {};
    linear_damping = 0;
  }
  bool set(const AxisStage& stage);
  /// With the mean rate.
  void finish_first_kick(const AxisProperties& p, const AxisStart& start, double w);
  /// The sum of laws begins with these lines.
  void add_to(RowLaw& law, const AxisProperties&) const {
    law = RowLaw::viscous(slope());
    law.level[0] = level();
  }
  /// False if the tangents are right for the rate w of a solution of a stage; else they are to be taken
  /// nearer to it, and the lines set again.
  bool move(const AxisProperties& p, const AxisStep& step, const AxisStart& start, double w,
            double rate_tolerance);
  void split_lines(AxisImpulse& impulse, double& rest, double w) const {
    impulse.elastic_limit = limit.at(w);
    impulse.spring = spring.at(w);
    impulse.damping = damper.at(w);
    rest = rest - impulse.spring - impulse.damping - impulse.elastic_limit;
  }
  void report(AxisReport& report, const AxisProperties&, double) const {
    report.at_limit = report.at_limit || limit_given != 0;
  }
  template <typename AnyArchive>
  void transfer(AnyArchive& archive) {
    archive(excess, limit_excess, beyond_limit, spring_given, damping_given, limit_given, implicit_damping,
            linear_damping, tangents.rate, tangents.lowest, tangents.highest);
    for (ImpulseLine* line : {&spring, &damper, &limit}) archive(line->level, line->slope);
  }

 private:
  void set_first_kick(const AxisStage& stage);
  void set_second_kick(const AxisStage& stage);
  void set_single_kick(const AxisStage& stage);
  void set_damper(const AxisStage& stage);
  bool are_tangents_right(const AxisProperties& p, const AxisStep& step, const AxisStart& start, double w,
                          double rate_tolerance) const;
};

}  // namespace taut
