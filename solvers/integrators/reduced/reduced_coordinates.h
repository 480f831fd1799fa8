#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "core/world/world.h"
#include "solvers/common/settings.h"
#include "solvers/common/step_report.h"
#include "solvers/integrators/axis_flow.h"
#include "solvers/integrators/reduced/axis_modes.h"
#include "solvers/integrators/reduced/closed_tree.h"
#include "solvers/integrators/runge_kutta.h"
#include "solvers/integrators/scheme.h"
#include "solvers/system/constraint_system.h"
#include "solvers/system/inverse_mass_root.h"

namespace taut {

/// Reduced coordinates: accelerations by recursion or by Lagrange's equations, with multipliers for what
/// closes loops (ClosedTree), integrated by the classical Runge–Kutta method or the implicit midpoint rule.
/// The state is that of the bodies; each step ends with all joints closed, from the roots to the leaves or
/// together, which moves bodies by no more than the error of the step.
/// (solvers/integrators, "Reduced coordinates")
class ReducedCoordinates final : public Scheme {
 public:
  ReducedCoordinates(const World& world, ConstraintSystem& system, const Settings& settings);

  void start(const State& state, Velocities velocities, SubstepReport& report) override;
  void begin(double dt) override;
  /// One step of h > 0: kDone; with the old state kImpact, if what an axis does ends within it; kStalled, if
  /// joints cannot be closed, the iteration of the midpoint rule does not contract or laws are not met; or
  /// kNotFinite.
  [[nodiscard]] Outcome advance(double h, SubstepReport& report) override;
  /// No body turns by more than Settings::max_rotation, and with TensionPolicy::kSubstep ω h of the fastest
  /// transverse frequency stays below max_tension_number.
  double step_limit() const override;
  double time_to_event() const override { return course_.event; }

  void set_time(double time) override { state_.time = time; }
  const State& state() const override { return state_; }
  BodyId not_finite() const override { return {not_finite_}; }
  std::string stall_reason() const override;
  std::span<const Wrench> momenta() const override;
  /// Of joints and axes since begin(), by the weights of the stages.
  std::span<const double> impulses() const override { return impulses_; }
  /// Forces of joints and axes at state(), by the recursion.
  std::span<const double> present_forces() override;
  const std::vector<AxisReport>& axis_reports() const override { return flow_.reports(); }

  void transfer(Archive& archive) override;

 private:
  enum class Stall { kNone, kJoints, kIteration, kTension, kLaws, kNotFinite };

  /// Of a step so far.
  struct Course {
    double length = 0, start = 0;         // dt, and the time when it began
    double event = 0;                     // where the next advance ends because an axis does something else
    int events = 0;                       // that were found
    bool settled = false;                 // modes are those of state_
    double axis_work = 0, kinetic = NAN;  // of axes and bodies, up to where works were closed last
  };
  /// Laws of the rows beyond the tree, and the segments that they are on.
  struct BeyondLaws {
    std::vector<RowLaw> laws;
    std::vector<int> segments;
    /// Of cut rows, and of axes behind them, all on the vertical segments of their laws.
    void set(int cuts, std::span<const RowLaw> of_axes);
  };

  bool make_step(double h, SubstepReport& report);
  Outcome give_up();
  bool begin_trial(SubstepReport& report);
  double end_trial(double h, double expected, SubstepReport& report);
  // Events.
  double margin_of_next(SubstepReport& report);
  void locate_event(double h, double margin, SubstepReport& report);
  bool settle(State& state, SubstepReport& report);
  void strike(State& state);
  bool choose_modes(State& state, SubstepReport& report);
  void read_axes(const State& state);
  bool runge_kutta(double h, SubstepReport& report);
  bool midpoint(double h, SubstepReport& report);
  bool solve_midpoint(double h, SubstepReport& report);
  double midpoint_error(double h);
  bool shift(const State& from, std::span<const Twist> accelerations, double h, State& to,
             SubstepReport& report);
  bool close(State& state, SubstepReport& report);
  void accelerate(const State& state, SubstepReport& report, std::span<Twist> accelerations);
  void find_forces(const State& state, SubstepReport& report, std::span<Twist> accelerations);
  void find_acting(const State& state, SubstepReport& report);
  void add_axis_forces(const State& state);
  void accumulate_work(const State& stage, double time, SubstepReport& report);
  bool is_finite(const State& state);
  double tension_of(const State& state);
  bool is_unstable(double h, double omega);
  void close_works(StepWorks& works);

  const World& world_;
  ConstraintSystem& system_;
  const Settings& settings_;
  ClosedTree tree_;
  ClosedTree::Method method_;
  AxisFlow flow_;
  AxisModes modes_;
  RungeKutta runge_kutta_;
  State state_, next_, middle_, back_;
  Stall stall_ = Stall::kNone;
  int not_finite_ = 0;
  bool follows_time_ = false;
  double omega_ = 0;  // the fastest transverse frequency [rad/s]
  Course course_;
  std::vector<StiffnessBlocks> stiffness_;
  std::vector<InverseMassRoot> roots_;
  std::vector<Wrench> forces_, dissipative_, axis_wrenches_;
  mutable std::vector<Wrench> momenta_;  // made when they are asked for
  std::vector<Twist> acceleration_, moves_, changes_;
  BeyondLaws laws_;
  std::vector<double> lambda_, impulses_, impulses_before_, theta_, rates_, tau_, driven_;
};

}  // namespace taut
