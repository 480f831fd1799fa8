#pragma once

#include <map>
#include <optional>
#include <span>
#include <vector>

#include "core/constraints/rows.h"
#include "core/world/diagnostics.h"
#include "core/world/world.h"
#include "solvers/common/axis_report.h"
#include "solvers/laws/axes/axis_effective_mass.h"
#include "solvers/laws/axes/axis_impacts.h"
#include "solvers/laws/axes/axis_law.h"
#include "solvers/laws/axes/axis_loads.h"
#include "solvers/laws/axes/axis_swings.h"
#include "solvers/laws/axes/axis_table.h"
#include "solvers/laws/axes/axis_work.h"
#include "solvers/laws/row_law.h"

namespace taut {

class Archive;

class ConstraintSystem;

/// Limits, motors, friction and springs of the free axes as laws of their rows (row_law.h) for the two stages
/// of a RATTLE step, or the one of Moreau–Jean, and what they remember from step to step.
/// (solvers/laws, "Axes")
///
///   position stage   w = (θ(q₁) − θ₀)/h, λ the impulse of the first kick
///   velocity stage   w = θ̇(q₁), λ the impulse of the second
///
/// Values `theta`, `rates`, `lambda` and `w` have one entry a row.
class AxisForces {
 public:
  /// `locates_plastic`: impacts without restitution are located as well.
  AxisForces(const World& world, const Rows& rows, bool locates_plastic = false);
  AxisForces(const AxisForces&) = delete;
  AxisForces& operator=(const AxisForces&) = delete;

  bool empty() const { return axes_.empty(); }
  /// No row but those of springs between bodies, whose forces follow from the state.
  bool only_springs() const;
  /// The present force of each such row, in place of its entry.
  void spring_forces(std::span<const double> theta, std::span<const double> rates,
                     std::span<double> lambda) const;
  /// Friction does not pull an axis back that is no further than this from where it holds it; 0 at first.
  void set_slack(double slack) { slack_ = slack; }
  /// A new start: friction of axes at rest holds them where they are.
  void start(std::span<const double> theta, std::span<const double> rates);
  /// A step of h from a time with θ₀ and θ̇₀.  `effective_mass`: 1 / S_rr of each row; `let_out`: what winches
  /// have let out, as in State::axes.
  void begin(double time, double h, std::span<const double> theta, std::span<const double> rates,
             std::span<const double> effective_mass, std::span<const double> let_out);
  /// After begin(), with the system where its impulses act: springs that the step does not resolve, and for
  /// one of Moreau–Jean, `single_kick`, whether there are any that need the end of it (ϑ = 1).
  bool find_unresolved(ConstraintSystem& system, bool single_kick = false);
  /// After begin(), with the system where its impulses act: how heavy axes are whose motors have to know, for
  /// 1/S_rr of each row.
  void find_effective_masses(ConstraintSystem& system, std::span<const double> alone);
  /// False if a motor's trajectory is not at the end of the step; the motor is left out then.
  bool finite() const { return !not_finite_; }
  /// The axis of that motor.
  const std::optional<AxisId>& not_finite() const { return not_finite_; }
  /// Back to the start of the step.
  void roll_back();
  /// All that is known of axes of joints, also of those without rows here.
  using Memory = std::map<AxisId, AxisLaw>;
  Memory memory() const;
  /// Friction of axes that an old system had too holds where it held; what is known of axes that have no rows
  /// now, because their bodies sleep, is kept.
  void inherit(Memory memory);
  /// Nothing is known of axes of bodies that were moved.
  void forget(std::span<const char> moved);
  /// The axes and softened rows of a joint give no force any more.
  void release(JointId joint) { table_.release(joint); }

  /// After begin(): a step of Moreau–Jean, whose impulses λ act at once on the rates w = θ̇ after it, springs
  /// and dampers at (1 − ϑ) of the start and ϑ of the end.  (solvers/integrators, "Moreau–Jean")
  void begin_single_kick(double vartheta);
  /// The first kick is looked for once more: its impulses were only to tell what happens in the step.
  void repeat_first_kick() { step_.kick = Kick::kFirst; }
  /// Laws of the axis rows for the present kick; those of other rows stay.  The first kick, from begin() to
  /// finish_positions(), takes `rates`, the best estimate of the mean ones, by which torque–speed curves are
  /// read; the second `theta` at q₁, and a single one that in the middle of the step.
  void set_laws(std::span<const double> theta, std::span<const double> rates, std::span<RowLaw> laws);
  /// What laws depend on beside the rates follows this solution of a stage: friction lets go or turns, tables
  /// have other tangents, loads change.  True if the stage must be solved again, with the laws renewed.
  bool laws_move(const ConstraintSystem& system, std::span<const double> lambda, std::span<const double> w,
                 double rate_tolerance);
  /// Axes, in the order of Rows::axis_rows(), whose bounds of friction the last of these calls has changed by
  /// no less than the one before, since they grow with the load.
  std::span<const char> growing() const { return loads_.growing(); }
  bool has_unbounded_motor(std::size_t i) const { return table_.has_unbounded_motor(i); }
  /// Friction has let go of an axis in this step.
  bool any_slipping() const;
  /// Zeroes the entries of rows that friction does not hold, one a row.
  void clear_loose(std::span<char> rows) const;

  /// At limits with restitution, within the step.
  AxisImpacts& impacts() { return impacts_; }
  bool struck() const { return impacts_.struck(); }

  /// A rigid limit of a row: lower ≤ θ ≤ upper.
  struct Bound {
    int row = 0;
    double lower = 0, upper = 0;
    AxisId axis{};
    /// How far θ is beyond, > 0 above and < 0 below.
    double excess(double theta) const {
      return theta > upper ? theta - upper : theta < lower ? theta - lower : 0;
    }
  };
  /// All of them, of axes that are not broken off.
  void rigid_limits(std::vector<Bound>& bounds) const;
  /// How far axes are beyond their rigid limits.
  Gap beyond_limits(std::span<const double> theta) const;

  /// Takes over the first kick: what springs and dampers gave is given again in the second.
  void finish_positions(std::span<const double> w);
  /// Takes over the second, at its time: which axes are held from here on.
  void finish_velocities(std::span<const double> theta, std::span<const double> w, double time);
  /// What winches have let out at the end of a step, into the state of then.
  void give_ropes(const Rows& rows, State& state);
  /// Impulses of the first kick, during which the axes moved with `rates` on the mean: to be called before
  /// the laws of the second, added with the second.
  void record_first_kick(std::span<const double> lambda, std::span<const double> w,
                         std::span<const double> rates) {
    work_.record_first_kick(table_, axes_, lambda, w, rates);
  }
  /// Impulses of the second kick so far: what is new of them acted while axes moved with `rates` on the mean.
  void record_second_kick(std::span<const double> mu, std::span<const double> w,
                          std::span<const double> rates) {
    work_.record_second_kick(table_, axes_, mu, w, rates);
  }
  /// A round of impacts after it: to μ and its rates impulses are to be added by which all limits that are
  /// touched obey Newton's law of impact, with this part of restitution.
  void begin_round(std::span<const double> mu, std::span<const double> rates, double restitution);
  /// Adds both kicks to the reports, with mean `rates` of what of the second is not recorded yet.
  void accumulate_work(std::span<const double> lambda, std::span<const double> w,
                       std::span<const double> rates) {
    work_.add_kicks(table_, axes_, lambda, w, rates);
  }

  /// Sums over the sub-steps since clear_reports(), with impulses in place of mean forces; in the order of
  /// Rows::axis_rows().
  const std::vector<AxisReport>& reports() const { return work_.reports(); }
  void clear_reports();

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive);

 private:
  AxisTable table_;
  AxisSwings swings_;
  std::vector<AxisLaw> axes_, before_;
  Memory resting_;  // of bodies that sleep
  AxisLoads loads_;
  AxisImpacts impacts_;
  AxisWork work_;
  AxisEffectiveMass effective_mass_;
  std::vector<AxisRound> rounds_;  // of impacts, while there are any
  std::vector<char> held_;         // rows of axes that motors or friction hold, for effective_mass_
  AxisStep step_;
  double slack_ = 0;
  std::optional<AxisId> not_finite_;
  std::vector<double> rope_ends_;
  bool any_winch_ = false;  // in this step
};

}  // namespace taut
