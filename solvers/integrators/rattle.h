#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/world/world.h"
#include "solvers/common/settings.h"
#include "solvers/common/step_report.h"
#include "solvers/complementarity/stage_solver.h"
#include "solvers/integrators/implicit_tension.h"
#include "solvers/integrators/kick_works.h"
#include "solvers/integrators/multiplier_prediction.h"
#include "solvers/integrators/step_limit.h"
#include "solvers/laws/axis_forces.h"
#include "solvers/laws/breaking.h"
#include "solvers/system/constraint_system.h"

namespace taut {

class Archive;

/// RATTLE [Andersen1983] on rigid bodies, the default integrator.  One step of length h from (q₀, p₀), where
/// p = (L, P) are the momenta in world axes and S(q₀) is already factored:
///
///   kick        p  = p₀ + h/2 f(q₀) + J(q₀)ᵀ λ
///   drift       q₁ = free flow of (q₀, p) over h, with λ such that φ(q₁) = 0     (simplified Newton, S(q₀))
///   factor      S(q₁)
///   kick        p₁ = p + h/2 f(q₁) + J(q₁)ᵀ μ, with μ such that J(q₁) M⁻¹ p₁ = 0               (one solve)
///
/// The next step starts with the factor of S(q₁): one factorisation a step.   (solvers/integrators, "RATTLE")
class Rattle {
 public:
  enum class Outcome { kDone, kStalled, kUnstable, kImpact, kOverload, kNotFinite, kBlind };

  Rattle(const World& world, ConstraintSystem& system, const Settings& settings);
  virtual ~Rattle() = default;

  /// The longest step that may come: contacts are found as far ahead as that.
  void set_horizon(double horizon) { horizon_ = horizon; }

  /// Takes over a state: factors S there, makes velocities tangent and estimates the multipliers.
  void start(const State& state, StepReport& report);
  /// The same in the pattern that there is, which keeps what is known of contacts and friction.
  void restart(const State& state, StepReport& report);
  /// Nothing is known of contacts and axes of bodies that were moved (one entry a body).
  void forget(std::span<const char> moved);
  /// The next start() or restart() finds contacts stretched so (ContactForces::recall()).
  void recall(std::vector<ContactStretch> stretches) { contacts_.recall(std::move(stretches)); }
  /// Gravity or a force law has changed, the state has not.  False if that is a jump: restart(), then.
  bool renew_forces();
  /// The last step ended at this time to the last bit.
  void set_time(double time) {
    linearized_time_ = state_.time;
    state_.time = time;
  }
  /// One step of h ≠ 0 (negative in compositions).  kStalled: Newton did not close the positions; kUnstable:
  /// the multipliers turned out to demand a smaller step; kImpact: an axis bounces at time_to_impact(), where
  /// the next advance must end; kOverload: a joint does not bear its load, and either is out now, or breaks
  /// at time_to_break() > 0, where the next advance must end; kBlind: contacts could not be looked for, for
  /// the reason that blind() gives.  The state is then the old one and the factor is that of S(q₀) again.
  [[nodiscard]] virtual Outcome advance(double h, StepReport& report);

  const State& state() const { return state_; }
  /// (L, P) of the bodies in world axes, those of state().
  std::span<const Wrench> momenta() const { return momenta_; }
  double time_to_impact() const { return time_to_impact_; }
  double time_to_break() const { return breaking_.time_to_break(); }
  const Breaking& breaking() const { return breaking_; }
  /// From an integrator of the world before its pattern changed: its contacts, before start() …
  void inherit_contacts(Rattle& old);
  /// … and after it what holds and how, with the forces as a guess.
  void inherit(const Rattle& old);
  /// Zero in the rows of joints that broke.
  void clear_broken_rows(std::span<double> rows) const {
    for (int r : breaking_.rows()) rows[r] = 0;
  }
  /// The body whose tension asks for the shortest step.
  BodyId stiffest() const { return limit_.stiffest(); }
  /// Largest step that tension and rotation allow from here.
  double step_limit() const { return limit_.step(); }
  /// φ at the last Newton iterate, for a diagnosis after kStalled.
  std::span<const double> residual() const { return phi_; }
  /// That is φ at the poses of state().
  bool knows_residual() const { return knows_residual_; }
  const std::vector<Pose>& trial_poses() const { return poses_; }
  /// λ + μ, summed over the advances since clear_impulses(), for reactions.
  std::span<const double> impulses() const { return impulses_; }
  void set_impulses(std::span<const double> impulses) { impulses_.assign(impulses.begin(), impulses.end()); }
  void clear_impulses() {
    std::fill(impulses_.begin(), impulses_.end(), 0.0);
    axes_.clear_reports();
    contacts_.clear_reports();
  }
  const AxisForces& axes() const { return axes_; }
  const ContactForces& contacts() const { return contacts_; }
  /// Forces of the rows at the end of the last step.
  std::span<const double> force_multipliers() const { return force_multipliers_; }
  /// Residual up to which the laws of a stage are taken as met when Newton's method has spent its steps,
  /// which are few if the steps before were hard; 0: none beyond its own.
  void accept_inexact(double residual, bool reduced_budget) {
    stages_.accept_inexact(residual, reduced_budget);
  }
  /// The next guess has no impulses of contacts.
  void forget_contact_impulses();
  /// Who jams, if a stage of the last advance failed because friction grows with a load that it makes grow:
  /// the rows of that friction, and those of motors without bound and of joints that follow the time whose
  /// impulses are as large.
  std::span<const int> jammed() const { return stages_.jammed(); }
  /// Contacts could not be looked for the last time, also in start(): see contacts().set().detection().
  bool blind() const { return !contacts_.empty() && contacts_.set().detection().blind(); }
  /// Threads that could not be started.
  int missing_threads() const {
    return std::max(contacts_.set().detection().missing_threads, stages_.missing_threads());
  }
  /// Who was furthest from the laws of a stage that could not be solved, or was solved inexactly, in the last
  /// advance.
  std::span<const Culprit> culprits() const { return stages_.culprits(); }
  /// The body on which forces changed most when they did not settle in the last advance; else the ground.
  BodyId unsettled() const { return {unsettled_}; }
  /// Shapes of contacts in culprits() belong to the bodies of this world.
  void name_by(const World& world) { stages_.name_by(world); }
  /// How the last active set of a stage went.
  const ActiveSetOutcome& active_set_outcome() const { return stages_.active_set_outcome(); }

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  /// Reading, in place of start().
  void transfer(Archive& archive);

 protected:  // the stages, which Moreau–Jean has, too (moreau_jean.h)
  /// Newton is given up, or restarted with a fresh factor, when an iteration takes away less than this part.
  static constexpr double kSlow = 0.6;

  void linearize(StepReport& report);
  void linearize_and_factorize(StepReport& report);
  void predict_multipliers(double h);
  void keep_multipliers(double h);
  bool close_positions(double h, StepReport& report);
  double system_size() const;
  double distance_to_closure(StepReport& report);
  bool mend_positions(double h, StepReport& report);
  void kick_and_drift(double h, const Configuration& end);
  void try_positions(double h);
  void refactor_at_iterate(double h, StepReport& report);
  bool close_velocities(double h, StepReport& report);
  /// Between passes of the fixed point for forces that depend on what they lead to: whether forces_, new
  /// since last_forces_, are the same, still come closer, or do not.
  enum class Fixed { kYes, kNotYet, kStalled };
  Fixed fixed_point(int pass, double& last_change);
  template <typename Change>
  void twists_and_rates(Change change);
  void second_kick(int b, double h) { momenta_[b] = kicked_[b] + 0.5 * h * forces_[b]; }
  void project_momenta(StepReport& report, std::span<double> mu, double h = 0);
  bool iterative() const { return stages_.iterative(); }
  /// Rows have laws of their own, or are to be solved one by one.
  bool bounded() const { return stages_.bounded(); }
  bool struck() const { return axes_.struck() || contacts_.struck(); }
  void clear_loose_rows(std::span<double> rows) const;
  bool break_joints(double h, StepReport& report);
  void release_overloaded();
  void renew_position_laws();
  void renew_velocity_laws();
  Configuration end_of_step(double h) const;
  void begin_bounds(double h);
  bool seek_impacts();
  void forget_impacts(bool for_good);
  void start_contacts();
  void find_contacts();
  void take_over_places();
  void set_places();
  struct Guess {
    std::vector<Rows::JointRows> joints;
    int contacts = 0;
    std::vector<double> forces, lambda;
  };
  Guess guess() const;
  void take(const Guess& guess);
  void move_rows(std::span<const int> from);
  void contact_rates();
  std::size_t contact_offset() const;
  std::span<double> kept_contact_jacobian();
  double first_impact(double h);
  bool close_bounded_positions(double h, StepReport& report);
  double time_of_impact(double h, StepReport& report);
  bool stabilize_positions(double h, StepReport& report);
  bool stabilize_velocities(StepReport& report);
  void start_iterative();
  bool project_bounded_momenta(StepReport& report);
  void begin_velocities();
  void end_velocities(StepReport& report);
  void keep_first_kick();
  void finish_bounds(StepReport& report);
  void watch_left_over(double sum);
  void twists_from_momenta();
  void restore(StepReport& report);
  void roll_back(StepReport& report);
  bool finite() const;
  void update_step_limit() { limit_.update(state_, force_multipliers_); }
  void account_for_kick(double h, StepReport& report);
  std::span<const double> kick_jacobian() const;

  const World& world_;
  ConstraintSystem& system_;
  const Settings& settings_;

  /// The force laws at state_, but for springs that have rows.
  void find_forces() { world_.forces(state_, forces_, springs_); }
  Springs springs_;  // among the laws

  State state_;                        // at the start of a step; twists are those of momenta_
  std::vector<Wrench> momenta_;        // (L, P) at the start; zero for fixed bodies
  std::vector<Wrench> start_momenta_;  // the same, while momenta_ already hold the end
  double start_time_ = 0;
  double linearized_time_ = 0;       // of J at the end of the last step, which set_time() has rounded anew
  std::vector<Wrench> forces_;       // at the start
  std::vector<Pose> poses_;          // trial, end of the step
  std::vector<Wrench> kicked_;       // p
  std::vector<Wrench> last_forces_;  // of the pass before
  std::vector<Wrench> move_;         // M times a move of the bodies
  std::vector<Pose> unmended_;
  double size_ = 1;                     // of the whole system at the start [m]
  std::vector<double> start_jacobian_;  // J(q₀) after a refactorisation elsewhere
  std::vector<Twist> accelerations_;
  bool refactored_ = false, surprised_ = false;
  bool knows_residual_ = false;  // the last step left φ at its end in phi_

  std::vector<double> lambda_, mu_, delta_, phi_, velocity_rows_, impulses_, force_multipliers_;
  std::vector<double> last_rates_;  // of rows, before the second pass of the projection
  double left_over_ = 0;            // part of them that it leaves
  int left_alike_ = 0;              // sub-steps in which that was the same

  Breaking breaking_;
  std::vector<double> broken_states_;  // of rows, for the system without laws
  Works works_before_;

  // With axes or contacts:
  AxisForces axes_;
  ContactForces contacts_;
  double horizon_ = 0;
  StageSolver stages_;
  StepLimit limit_;
  ImplicitTension tension_;
  KickWorks works_;
  MultiplierPrediction prediction_;
  double slack_ = 0;              // of gaps and of places where friction holds, which is left [m or rad]
  std::vector<Wrench> absorbed_;  // momentum that bodies held fast did not take in this stage
  int unsettled_ = 0;
  std::vector<double> start_theta_, rates_, kick_rates_;
  double time_to_impact_ = 0;
};

}  // namespace taut
