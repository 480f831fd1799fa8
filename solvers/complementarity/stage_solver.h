#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/world/world.h"
#include "solvers/common/settings.h"
#include "solvers/common/step_report.h"
#include "solvers/complementarity/active_set.h"
#include "solvers/complementarity/contact_islands.h"
#include "solvers/complementarity/contact_solver.h"
#include "solvers/complementarity/interior_point.h"
#include "solvers/complementarity/primal_dual_active_set.h"
#include "solvers/laws/axis_forces.h"
#include "solvers/laws/contact_forces.h"
#include "solvers/system/constraint_system.h"

namespace taut {

class Archive;

/// Solves the stages of a step: impulses λ and rates w = S λ + b with a law for each row, joints as
/// equalities among them.  What the laws depend on beside the rates (static friction that lets go, loads,
/// tangents of tables, slip directions of contacts) is looked at after each solve, and the stage is solved
/// again with renewed laws until it stays.
///
/// The order of what is tried: impulses of before as they are, or with one linear solve where contacts stick;
/// the active set on the factor of S; through the bodies, Newton's method on the primal matrix, interior
/// points and sweeps (ContactIslands, PrimalDualActiveSet, InteriorPoint).  It remembers which of them worked
/// last. (solvers/complementarity, "Ladder", "Natural residual")
class StageSolver {
 public:
  /// Solves more where contacts met their laws within a tolerance of rates only.
  static constexpr int kExactSolves = 2;
  /// Recomputes laws() from the present rates and from what AxisForces and ContactForces know.
  using Renew = std::function<void()>;
  /// One stage.  `lambda`: a guess, then the result; `rates`: those that the guess gives.
  struct Stage {
    std::span<double> lambda, rates;
    const Renew& renew;
    /// Where contact rows of J(q₀) are kept beside the system's own, if they are: turned tangents turn there,
    /// too.
    std::span<double> contact_jacobian{};
    bool near = false;  ///< this stage was solved at a neighbouring state
  };

  StageSolver(const World& world, ConstraintSystem& system, AxisForces& axes, ContactForces& contacts,
              const Settings& settings);

  /// Residual up to which the laws of a stage are taken as met when Newton's method has spent its steps,
  /// which are few if the steps before were hard; 0: none beyond its own.
  void accept_inexact(double residual, bool reduced_budget) {
    inexact_ = residual;
    reduced_budget_ = reduced_budget;
  }
  /// Shapes of contacts in culprits() belong to the bodies of this world.
  void name_by(const World& world) { named_ = &world; }
  /// Rows of the system are others; row r was `from[r]`, −1: new.
  void move_rows(std::span<const int> from);
  /// The next solve starts from its guess.
  void forget_segments() { active_->reset(); }

  // What kind of system it is.
  bool iterative() const { return settings_.solver != Solver::kDirect; }
  /// Rows have laws of their own, or are to be solved one by one.
  bool bounded() const { return iterative() || !axes_.empty() || !contacts_.empty(); }
  /// So many axes rub that the bodies are the system, and nothing else.
  bool friction_dominated() const { return contacts_.empty() && system_.uses_primal_system(); }
  /// Stages ask for the factor of S, if they do, themselves.
  bool factors_on_demand() const {
    return !contacts_.empty() || system_.uses_primal_system() || primal_stages_left_ > 0;
  }

  // Before a solve.
  /// Forgets what was noted in the last advance.
  void begin_advance();
  void begin_pass() { worst_stage_residual_ = natural_ = 0; }
  /// Rates are differences of poses over h in a system of this size [m]; `twists` are looked at during the
  /// stage.
  void begin_positions(double h, double size, std::span<const Twist> twists);
  /// Rates are those of twists.
  void begin_velocities(std::span<const Twist> twists);
  void note_round_off() { contact_noise_ = rate_noise(); }
  void renew_effective_masses() { system_.effective_masses(effective_mass_); }
  std::span<const double> effective_mass() const { return effective_mass_; }  ///< 1 / S_rr
  std::vector<RowLaw>& laws() { return laws_; }
  std::span<const RowLaw> laws() const { return laws_; }
  /// Tells the system which rows will have to be factored if the segments stay what they are.
  void prepare(std::span<const double> b, std::span<const double> lambda) {
    active_->prepare(laws_, b, lambda);
  }
  /// The same, with the b of the last solve.
  void prepare(std::span<const double> lambda) { prepare(b_, lambda); }

  // Solves.
  /// Rates that are off by no more than the tolerance count as right.
  bool solve(const Stage& stage, double rate_tolerance, StepReport& report);
  /// To what round-off allows where the tolerance of velocities lets too much pass; inexactly where that may
  /// be.
  bool solve_velocities(const Stage& stage, StepReport& report);
  /// So many sweeps of the iterative solver; false if a number is not finite.  `absorbed`: momentum that
  /// bodies held fast did not take in.
  bool iterate(const Stage& stage, int sweeps, double rate_tolerance, std::span<Wrench> absorbed,
               StepReport& report);

  // After a solve.
  std::span<const double> rates() const { return w_; }
  /// The impulses of before were taken as they are.
  bool rested() const { return rested_; }
  /// Distance of the motion from the laws [m or rad] in a step of h: of verticals from their rate, of levels
  /// from their range, and of impulses from their level by how much they would move the row.
  double law_error(std::span<const double> lambda, std::span<const double> rates, double h) const;
  /// The natural residual over its tolerance; 0 if no better solution is known.
  double laws_off(std::span<const double> lambda, std::span<const double> w) const;
  /// Rates that laws may be missed by where the tolerances of positions and velocities have let too much
  /// pass.
  double exact_tolerance() const;
  /// The laws are not met any better than by this part of laws_off().  False if that is not enough for an
  /// inexact step.
  bool take_inexact(double off);
  /// A stage is done, inexactly perhaps.
  void note_inexact(std::span<const double> lambda, std::span<const double> rates);
  void note_residual(std::span<const double> lambda, std::span<const double> rates);
  void note_culprits(std::span<const double> lambda, std::span<const double> w);
  /// The largest natural residual that stages of this advance ended with.
  double natural() const { return natural_; }
  /// What the stages ended with, for a sub-step that is kept.
  void report_residuals(StepReport& report) const;

  // For diagnoses.
  /// Who jams, if a stage failed because friction grows with a load that it makes grow: the rows of that
  /// friction, and those of motors without bound and of joints that follow the time whose impulses are as
  /// large.
  std::span<const int> jammed() const { return jammed_; }
  /// Who was furthest from the laws of a stage that could not be solved, or was solved inexactly.
  std::span<const Culprit> culprits() const { return culprits_; }
  void set_culprits(std::vector<Culprit> culprits) { culprits_ = std::move(culprits); }
  /// How the last active set went.
  const ActiveSetOutcome& active_set_outcome() const { return outcome_; }
  /// Threads that could not be started.
  int missing_threads() const { return islands_.missing_threads(); }

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive);
  void transfer_factors(Archive& archive);

 private:
  StageProblem problem(std::span<double> lambda) { return {laws_, b_, effective_mass_, lambda, w_}; }
  double natural_tolerance() const;
  bool exact(std::span<const double> lambda) const;
  bool may_rest() const { return friction_dominated() || (!contacts_.empty() && contacts_.rest()); }
  double warm_start_tolerance(double rate_tolerance, bool rested) const;
  bool laws_move(std::span<const double> lambda, double rate_tolerance);
  void rates_without(const Stage& stage);
  enum class Pivoting { kMet, kFailed, kGivenUp };
  Pivoting solve_by_active_set(const Stage& stage, double rate_tolerance, StepReport& report);
  Pivoting give_up_pivoting(const Stage& stage, bool next_too);
  Pivoting after_stalled_pivoting(const Stage& stage, const ActiveSetSettings& settings);
  enum class Sticking { kNoneNeeded, kFound, kLetGo };
  Sticking search_sticking(const Stage& stage, double rate_tolerance, StepReport& report);
  bool accept_warm_start(const Stage& stage, double rate_tolerance, StepReport& report);
  bool solve_all_sticking(const Stage& stage, double rate_tolerance, StepReport& report);
  bool meets_laws(std::span<double> lambda, double off, double rate_tolerance, StepReport& report);
  void take_segments(std::span<const double> lambda);
  bool solve_primal(const Stage& stage, double rate_tolerance, double resting, StepReport& report);
  bool solve_axes(std::span<double> lambda, double rate_tolerance, StepReport& report);
  bool solve_on_segments(std::span<double> lambda, const PrimalDualLimits& limits, StepReport& report);
  bool solve_by_newton(std::span<double> lambda, const NewtonLimits& limits, StepReport& report);
  bool solve_islands(std::span<double> lambda, const NewtonLimits& limits, double resting,
                     StepReport& report);
  void add(const StageRecord& record, StepReport& report);
  void turn_contacts(const Stage& stage, StepReport& report);
  double natural_residual(std::span<const double> lambda, std::span<const double> w) const;
  double natural_scale(std::span<const double> lambda, std::span<const double> w) const;
  double natural_error(int r, std::span<const double> lambda, std::span<const double> w, double scale,
                       const std::pair<double, double>& rate_noise) const;
  std::pair<double, double> rate_noise() const;
  void note_jam(std::span<const double> lambda);

  const World* named_;
  ConstraintSystem& system_;
  AxisForces& axes_;
  ContactForces& contacts_;
  const Settings& settings_;
  std::optional<ActiveSet> active_;
  ContactSolver contact_solver_;
  ContactIslands islands_;
  InteriorPoint interior_;
  PrimalDualActiveSet primal_dual_;

  std::vector<RowLaw> laws_;
  std::vector<double> b_, w_, effective_mass_;
  double stage_h_ = 0, size_ = 1;  // over which rates are differences of poses, of a system of this size [m]
  std::span<const Twist> twists_;
  std::pair<double, double> contact_noise_{};  // rate_noise() of the position stage

  double inexact_ = 0;  // residual that may be taken
  bool reduced_budget_ = false;
  bool good_guess_ = false;
  bool rested_ = false;         // the last stage took the impulses of before
  bool laws_moved_ = false;     // friction let go, or its load changed, before this stage was solved
  int primal_stages_left_ = 0;  // that go straight to the bodies, since the active set gave up on one before
  double stage_residual_ = 0;   // residual taken beyond 1e-8 by the present solve,
  double worst_stage_residual_ = 0;  // … and in this advance
  double natural_ = 0;               // natural residual of the stages of this advance
  std::vector<int> jammed_;
  std::vector<Culprit> culprits_;
  ActiveSetOutcome outcome_;
  std::vector<RowLaw> held_laws_;
  std::vector<double> guess_, held_;
  std::vector<int> segments_scratch_;
};

}  // namespace taut
