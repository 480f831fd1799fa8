#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <vector>

#include "core/constraints/rows.h"
#include "core/world/diagnostics.h"
#include "core/world/swing_properties.h"
#include "core/world/world.h"
#include "solvers/common/axis_report.h"
#include "solvers/laws/row_law.h"

namespace taut {

class Archive;

class ConstraintSystem;

/// Limits, motors, friction and springs of the free axes as laws of their rows (row_law.h) for the two stages
/// of a RATTLE step, and the memory that they need: where friction holds, how fast a limit was approached.
/// (solvers/laws, "Axes")
///
///   position stage   w = (θ(q₁) − θ₀)/h, λ the impulse of the first kick
///   velocity stage   w = θ̇(q₁), λ the impulse of the second
class AxisForces {
 public:
  AxisForces(const World& world, const Rows& rows);

  bool empty() const { return axes_.empty(); }
  /// No row but those of springs between bodies, whose forces follow from the state.
  bool only_springs() const {
    return std::all_of(rows_.begin(), rows_.end(), [](const auto& row) { return row.spring.index >= 0; });
  }
  /// The present force of each such row, in place of its entry.
  void spring_forces(std::span<const double> theta, std::span<const double> rates,
                     std::span<double> lambda) const;
  /// Friction does not pull an axis back that is no further than this from where it holds it; 0 at first.
  void set_slack(double slack) { slack_ = slack; }
  /// A new start: friction of axes at rest holds them where they are.  `theta` and `rates` have one entry a
  /// row, as in all functions below.
  void start(std::span<const double> theta, std::span<const double> rates);
  /// A step of h from a time with θ₀ and θ̇₀.  `inertia`: 1 / S_rr of each row.
  void begin(double time, double h, std::span<const double> theta, std::span<const double> rates,
             std::span<const double> inertia);
  /// After begin(), with the system where its impulses act: springs that the step does not resolve, and for
  /// one of Moreau–Jean, `single_kick`, whether there are any that need the end of it (ϑ = 1).
  bool find_unresolved(ConstraintSystem& system, bool single_kick = false);
  /// False if a motor's trajectory is not at the end of the step; the motor is left out then.
  bool finite() const { return not_finite_ < 0; }
  /// The axis of that motor.
  AxisId not_finite() const { return rows_[not_finite_].axis; }
  /// Back to the start of the step.
  void roll_back();
  /// Friction of axes that an old system had too holds where it held; what is known of axes that have no rows
  /// now, because their bodies sleep, is kept.
  void inherit(const AxisForces& old);
  /// Nothing is known of axes of bodies that were moved.
  void forget(std::span<const char> moved);
  /// The axes and softened rows of a joint give no force any more.
  void release(JointId joint);
  /// Loads by which friction grows, from the impulses of a stage; true if a bound has changed by more than
  /// the tolerance of impulses, so that the stage must be solved again.
  bool update_loads(const Rows& rows, std::span<const double> jacobian, std::span<const double> lambda);
  /// Axes, in the order of Rows::axis_rows(), whose bounds the last of these calls has changed so, and by no
  /// less than the one before.
  std::span<const char> growing() const { return growing_; }

  /// Laws of the axis rows for the first kick; those of other rows stay.  `mean_rates`: the best estimate, by
  /// which torque–speed curves are read.
  void position_laws(std::span<const double> mean_rates, std::span<RowLaw> laws);
  /// Laws for the second kick, with θ(q₁).
  void velocity_laws(std::span<const double> theta, std::span<RowLaw> laws);
  /// Laws of a step of Moreau–Jean, whose impulses λ act at once on the rates w = θ̇ after it, between begin()
  /// with the rates before it and break_away(): springs and dampers at (1 − ϑ) of the start and ϑ of the end,
  /// limits that are passed at `theta`, in the middle of the step, w ≥ −e θ̇₀.
  /// (solvers/integrators, "Moreau–Jean")
  void impulse_laws(double weight, std::span<const double> theta, std::span<RowLaw> laws);
  /// Springs and dampers given by tables, which a law has as tangents: true if the rates of this solution of
  /// a stage are elsewhere, and it must be solved again with the tangents there.
  bool relinearize_tables(std::span<const double> w, double rate_tolerance);
  /// Friction of joints whose swing is straight has another direction than in this solution.
  bool turn_swings(std::span<const double> lambda, std::span<const double> w);
  /// Axes that static friction held and that have broken away at this solution of a stage: their bound is now
  /// that of dynamic friction, and the stage must be solved again.
  bool break_away(std::span<const double> w, double rate_tolerance);
  /// Friction has let go of an axis in this step.
  bool any_broken() const;
  bool has_unbounded_motor(std::size_t i) const;
  /// Zeroes the entries of rows that friction does not hold, one a row.
  void clear_loose(std::span<char> rows) const;

  /// True if a solution of the position stage stops an axis in free flight at a limit with restitution.  From
  /// then on that limit is left out: solved again, the stage shows when the axis crosses it.
  bool seek_impacts(std::span<const double> w);
  /// The time from the start of the step, in (0, h], at which the first of these axes reaches its limit, on
  /// the parabola through θ₀ with θ̇₀ to the free end; h if none does.
  double first_impact(std::span<const double> w) const;
  /// Of the impacts sought, those up to this time are due at the end of the next sub-step, which is to end
  /// then; the others come later.
  void take_impacts(double until, std::span<const double> w);
  /// Impacts that were found are not wanted any more.  `for_good`: nor looked for again in this step.
  void forget_impacts(bool for_good);
  /// An impact ended the last sub-step.
  bool struck() const { return struck_; }

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

  /// How an impulse of a stage is made up.
  AxisImpulse share(int axis, double lambda, double w) const;
  /// Takes over the first kick: what springs and dampers gave is given again in the second.
  void finish_positions(std::span<const double> w);
  /// Takes over the second, at its time: which axes are held from here on.
  void finish_velocities(std::span<const double> theta, std::span<const double> w, double time);
  /// Impulses of the first kick, during which the axes moved with `rates` on the mean: to be called before
  /// velocity_laws(), booked with the second.
  void record_first_kick(std::span<const double> lambda, std::span<const double> w,
                         std::span<const double> rates);
  /// Books both kicks.
  void accumulate_work(std::span<const double> lambda, std::span<const double> w,
                       std::span<const double> rates);

  /// Sums over the sub-steps since clear_reports(), with impulses in place of mean forces; in the order of
  /// Rows::axis_rows().
  std::span<const AxisReport> reports() const { return reports_; }
  void clear_reports();

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive);

 private:
  /// A step of a law that no rate comes to.
  static constexpr double kNever = 1e12;
  /// A limit is touched within this distance [m or rad]; positions are closed to less.
  static constexpr double kTouch = 1e-9;
  /// Rates this near to a step of the law are on it, relative to 1 + |w|.
  static constexpr double kOnStep = 1e-9;
  static bool on_step(double w, double at) { return std::abs(w - at) <= kOnStep * (1 + std::abs(w)); }

  /// Memory of an axis; a copy of all of them is a way back.
  struct Axis {
    double anchor = 0;    // where friction holds it
    bool stuck = false;   // friction held it at the end of the last step
    bool broken = false;  // … but not in this one
    bool known = true;    // no body was moved
    double theta0 = 0, rate0 = 0;
    double inertia = 0;
    double excess = 0;                      // slope beyond h²k/4 of a spring that is not resolved
    double limit_excess = 0;                // the same of a limit with compliance
    bool beyond = false;                    // such a limit, at q₁
    double spring = 0, damping = 0;         // given by the first kick: they are given again
    bool implicit_damping = false;          // stiff dampers act on θ̇(q₁) instead
    double linear_damping = 0;              // slope of all dampers without a table
    double tangent_at = 0;                  // rate at which tables are linear in this stage
    double root_above = 0, root_below = 0;  // known of the rate that they lead to
    double soft_limit = 0;                  // of a limit with compliance, given by the first kick
    double limit_level = 0, limit_slope = 0;
    double load = 0;         // impulse of the joint's force in this stage
    double load_change = 0;  // by the last solve, 0: not yet known
    // The steps of the present law.
    double motor_at = 0, motor_force = 0, friction_at = 0, friction_force = 0, lower_at = 0, upper_at = 0;
    double lower_back = 0, upper_back = 0;  // what limits gave in the first kick and may take back
    double spring_level = 0, damping_level = 0, spring_slope = 0, damping_slope = 0;
  };

  /// The impact of an axis, between its discovery and the end of the sub-step.
  struct Impact {
    enum class Stage { kNone, kSought, kDue } stage = Stage::kNone;
    bool at_lower = false;
    double rate = 0;     // just before it
    bool spent = false;  // no more in this step
  };

  /// Impulse of a kick over its rate, near a rate.
  struct Tangent {
    double level = 0, slope = 0;
    double at(double w) const { return level - slope * w; }
  };
  static Tangent tangent(double value, double slope, double w) {
    const double descent = std::max(0.0, slope);
    return {-value + descent * w, descent};
  }
  /// Of an axis in a step: forces act for `time`, at the part `weight` of the way.
  struct Stroke {
    double time = 0;
    double from = 0, to = 0;
    double per_rate = 0;  ///< ∂to/∂w
    double weight = 0.5;
  };
  Stroke way(const Axis& axis, double w) const;
  Tangent spring_tangent(const Axis& axis, const AxisSpring& spring, double w) const;
  Tangent limit_tangent(const Axis& axis, const AxisLimits& limits, double w) const;
  Tangent limit_damper_tangent(const Axis& axis, const AxisLimits& limits, double w) const;
  bool has_constant_inertia(const Rows& rows, std::size_t i) const;
  Tangent damper_tangent(const Axis& axis, const AxisSpring& spring, double w) const;
  static bool has_soft_limit(const AxisProperties& p) { return p.limits && p.limits->compliance > 0; }
  /// Its law is no straight line.
  static bool is_bent(const AxisProperties& p) { return !detail::is_linear(p.spring) || has_soft_limit(p); }
  void begin_tangents(Axis& axis, double w) const;
  void set_damping(Axis& axis, const AxisProperties& p) const;
  void add_springs(Axis& axis, const AxisProperties& p) const;
  void set_impacts(Axis& axis, const AxisLimits& limits, double theta) const;
  void set_limits(Axis& axis, const AxisLimits& limits, const Impact& impact) const;
  bool has_impact(std::span<const double> theta) const;
  bool in_flight(std::size_t i, bool at_lower) const;
  double crossing(std::size_t i, double w) const;
  double motor_force(const AxisMotor& motor, double rate) const;
  RowLaw law_of(Axis& axis, const AxisProperties& properties) const;
  void add(AxisReport& report, int axis, double lambda, double w, double rate) const;
  const AxisProperties& properties(std::size_t i) const {
    return from_own_[i] ? own_[i] : world_.axis_properties(rows_[i].axis);
  }
  bool is_rigid_limit(std::size_t i) const {
    return !released_[i] && properties(i).limits && properties(i).limits->compliance == 0;
  }
  /// A joint whose swing has friction: its rows, and how the turns share it where the swing is next to
  /// 0.
  struct Swing {
    int axis = 0;
    std::array<int, 2> turn{-1, -1};
    std::array<double, 2> share{1, 1};
    bool straight = false;
    int solves = 0;
  };
  /// Rows of a joint with a spring that acts along components of its swing.
  struct SwingSpring {
    int axis = 0;
    std::array<int, 2> component{-1, -1};
  };
  void find_swings();
  void begin_bends();
  void begin_swings();
  void share_friction(const Swing& swing);
  void read_properties();
  void read_own(std::size_t i);
  void require_finite_target(Axis& axis);

  const World& world_;
  std::vector<AxisProperties>
      own_;  // of rows that are no axes, and of swings; by row, empty if there are none
  std::vector<char> from_own_;
  std::vector<Swing> swings_;
  std::vector<SwingSpring> bends_;
  std::vector<char> released_, angular_, growing_;
  std::int64_t axis_version_ = -1;
  bool has_limits_ = false, has_loads_ = false;   // rigid limits, friction that grows with the load
  bool has_bends_ = false, has_springs_ = false;  // tables and soft limits; anything that may be stiff
  std::vector<Rows::AxisRow> rows_;
  std::vector<Axis> axes_, before_;
  std::map<AxisId, Axis> resting_;  // of bodies that sleep
  std::vector<Impact> impacts_;
  int impact_count_ = 0;  // looked for in this step
  bool struck_ = false;
  std::vector<AxisReport> reports_, reports_before_, first_kick_;
  double slack_ = 0;
  double h_ = 0, end_time_ = 0;
  double weight_ = 0;  // ϑ of a step of Moreau–Jean; 0 in RATTLE
  bool second_kick_ = false;
  int not_finite_ = -1;  // of axes_
};

}  // namespace taut
