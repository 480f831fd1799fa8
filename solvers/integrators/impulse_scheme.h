#pragma once

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "core/world/world.h"
#include "solvers/common/settings.h"
#include "solvers/common/step_report.h"
#include "solvers/complementarity/stage_solver.h"
#include "solvers/integrators/kick_works.h"
#include "solvers/integrators/multiplier_prediction.h"
#include "solvers/integrators/step_limit.h"
#include "solvers/laws/axis_forces.h"
#include "solvers/laws/breaking.h"
#include "solvers/laws/contact_forces.h"
#include "solvers/system/constraint_system.h"

namespace taut {

class Archive;

/// What schemes at the level of impulses have in common: bodies with momenta, rows with laws, contacts that
/// come and go with their rows, and a velocity stage.  RATTLE (rattle.h) and Moreau–Jean (moreau_jean.h) say
/// how a step is made of these.                                          (solvers/integrators, "RATTLE")
class ImpulseScheme {
 public:
  enum class Outcome { kDone, kStalled, kUnstable, kImpact, kOverload, kNotFinite, kBlind };

  ImpulseScheme(const World& world, ConstraintSystem& system, const Settings& settings);
  virtual ~ImpulseScheme() = default;
  ImpulseScheme(const ImpulseScheme&) = delete;
  ImpulseScheme& operator=(const ImpulseScheme&) = delete;

  /// Takes over a state: factors S there, makes velocities tangent and estimates the multipliers.
  virtual void start(const State& state, StepReport& report);
  /// The same in the pattern that there is, which keeps what is known of contacts and friction.
  void restart(const State& state, StepReport& report);
  /// One step of h ≠ 0 (negative in compositions).  kStalled: joints or laws could not be met; kUnstable: the
  /// multipliers turned out to demand a smaller step; kImpact, kOverload: an axis or contact bounces, or a
  /// joint breaks, at time_to_event(), where the next advance must end, or has broken now if that is 0;
  /// kBlind: contacts could not be looked for, for the reason that blind() gives.  The state is then the old
  /// one and the factor is that of S(q₀) again.  kNotFinite: so is the state.
  [[nodiscard]] virtual Outcome advance(double h, StepReport& report) = 0;
  virtual double time_to_event() const { return 0; }  ///< [s]

  // Between steps.
  /// The longest step that may come: contacts are found as far ahead as that.
  void set_horizon(double horizon) { horizon_ = horizon; }
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
  /// From a scheme for the world before its pattern changed: its contacts, before start() …
  void inherit_contacts(ImpulseScheme& old);
  /// … and after it what holds and how, with the forces as a guess.
  void inherit(const ImpulseScheme& old);
  /// The next guess has no impulses of contacts.
  void forget_contact_impulses();
  /// How far laws may be missed, and who is named.
  StageSolver& stages() { return stages_; }
  void set_impulses(std::span<const double> impulses) { impulses_.assign(impulses.begin(), impulses.end()); }
  void clear_impulses();

  // What the last step came to.
  const State& state() const { return state_; }
  /// (L, P) of the bodies in world axes, those of state().
  std::span<const Wrench> momenta() const { return momenta_; }
  /// Impulses of the rows, summed over the advances since clear_impulses(), for reactions.
  std::span<const double> impulses() const { return impulses_; }
  /// Forces of the rows at the end of the last step.
  std::span<const double> force_multipliers() const { return force_multipliers_; }
  const AxisForces& axes() const { return axes_; }
  const ContactForces& contacts() const { return contacts_; }
  const Breaking& breaking() const { return breaking_; }
  /// Zero in the rows of joints that broke.
  void clear_broken_rows(std::span<double> rows) const {
    for (int r : breaking_.rows()) rows[r] = 0;
  }
  /// Largest step that tension and rotation allow from here.
  const StepLimit& limit() const { return limit_; }
  /// That residual() is φ at the poses of state().
  bool residual_is_current() const { return residual_current_; }

  // For diagnoses.
  /// φ at the last Newton iterate, and its poses.
  std::span<const double> residual() const { return phi_; }
  const std::vector<Pose>& trial_poses() const { return poses_; }
  /// Contacts could not be looked for the last time, also in start(): see contacts().set().detection().
  bool blind() const { return !contacts_.empty() && contacts_.set().detection().blind(); }
  /// Threads that could not be started.
  int missing_threads() const {
    return std::max(contacts_.set().detection().missing_threads, stages_.missing_threads());
  }
  const StageSolver& stages() const { return stages_; }
  /// The body on which forces changed most when they did not settle in the last advance; else the ground.
  BodyId unsettled() const { return {unsettled_}; }

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  /// Reading, in place of start().
  virtual void transfer(Archive& archive);

 protected:
  bool iterative() const { return stages_.iterative(); }
  /// Rows have laws of their own, or are to be solved one by one.
  bool bounded() const { return stages_.bounded(); }
  bool struck() const { return axes_.struck() || contacts_.struck(); }

  void linearize(StepReport& report);
  void linearize_and_factorize(StepReport& report);
  /// The force laws at state_, but for springs that have rows.
  void find_forces() { world_.forces(state_, forces_, springs_); }
  void find_contacts();
  Configuration end_of_step(double h) const;
  void twists_from_momenta();
  void second_kick(int b, double h) { momenta_[b] = kicked_[b] + 0.5 * h * forces_[b]; }
  void project_momenta(StepReport& report, std::span<double> mu, double h = 0);
  void take_impulses();
  void note_velocities(StepReport& report);
  /// Between passes of the fixed point for forces that depend on what they lead to: whether forces_, new
  /// since last_forces_, are the same, still come closer, or do not.
  enum class Fixed { kYes, kNotYet, kStalled };
  Fixed fixed_point(int pass, double& last_change);
  void clear_loose_rows(std::span<double> rows) const;
  void finish_laws(StepReport& report);
  bool finite() const;
  void roll_back(StepReport& report);
  void update_step_limit() { limit_.update(state_, force_multipliers_); }

  const World& world_;
  ConstraintSystem& system_;
  const Settings& settings_;
  Springs springs_;  // among the force laws

  State state_;                        // at the start of a step; twists are those of momenta_
  std::vector<Wrench> momenta_;        // (L, P) at the start; zero for fixed bodies
  std::vector<Wrench> start_momenta_;  // the same, while momenta_ already hold the end
  double start_time_ = 0;
  double linearized_time_ = 0;       // of J at the end of the last step, which set_time() has rounded anew
  std::vector<Wrench> forces_;       // at the start
  std::vector<Wrench> last_forces_;  // of the pass before
  std::vector<Wrench> kicked_;       // p, between the kicks
  std::vector<Pose> poses_;          // trial, end of the step; of the start, once it is accepted

  // Of rows: impulses of both kicks, b or a correction, φ, rates, sums and forces.
  std::vector<double> lambda_, mu_, delta_, phi_, velocity_rows_, impulses_, force_multipliers_;
  bool residual_current_ = false;  // the last step left φ at its end in phi_
  // … with axes or contacts: coordinates at the start, rates that laws see, and those of a kick.
  std::vector<double> start_theta_, rates_, kick_rates_;

  AxisForces axes_;
  ContactForces contacts_;
  Breaking breaking_;
  StageSolver stages_;
  StepLimit limit_;
  KickWorks works_;
  MultiplierPrediction prediction_;
  double horizon_ = 0;
  Works works_before_;  // of the report, to be set back
  int unsettled_ = 0;

 private:
  struct Guess {
    std::vector<Rows::JointRows> joints;
    int contacts = 0;
    std::vector<double> forces, lambda;
  };
  void start_iterative();
  void start_contacts();
  void take_over_places();
  void set_places();
  void move_rows(std::span<const int> from);
  Guess guess() const;
  void take(const Guess& guess);
  template <typename Change>
  void twists_and_rates(Change change);
  void watch_contraction(double sum);

  std::vector<double> last_rates_;  // of rows, before the second pass of the projection
  double contraction_ = 0;          // part of them that it leaves
  int steady_count_ = 0;            // sub-steps in which that was the same
};

}  // namespace taut
