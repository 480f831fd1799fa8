#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/world/world.h"
#include "solvers/common/settings.h"
#include "solvers/common/step_report.h"
#include "solvers/simulator/checkpoint.h"
#include "solvers/simulator/event.h"

namespace taut {

struct ContactStage;
struct DueEvent;

/// Force and torque of a joint on its body B, world axes; A receives the opposite.
struct Reaction {
  Vec3 force = Vec3::Zero();   ///< [N]
  Vec3 torque = Vec3::Zero();  ///< about the joint's anchor on B [N·m]
};

/// What many steps came to.
struct RunReport {
  StepReport last;                 ///< of the last step, or the one that failed
  std::int64_t steps = 0;          ///< that were taken
  std::int64_t inexact_steps = 0;  ///< with Status::kInexact, among them
  Gap gap;                         ///< largest of the steps taken
  double penetration = 0;          ///< deepest of the steps taken [m]
  double natural_residual = 0;     ///< largest of the steps taken, relative

  bool ok() const { return last.ok(); }  ///< the end was reached
  bool exact() const {
    return last.exact() && inexact_steps == 0;
  }  ///< the end was reached by exact steps alone
};

/// Advances a World in time.
///
///     Simulator simulator(world);
///     while (world.time() < 1)
///       if (!simulator.step(1e-3).ok()) throw std::runtime_error(simulator.report().message);
class Simulator {
 public:
  /// @throws std::invalid_argument if a setting is out of range.
  explicit Simulator(World& world, const Settings& settings = {});
  ~Simulator();
  Simulator(Simulator&&) noexcept;  ///< the source may only be destroyed

  /// One step of dt [s].  A world that was assigned to (world = other) is another one, and the simulator
  /// starts anew.  What a force law throws comes through; world, report and what comes next are then as
  /// before the call. The world's state moves to the end of the step if StepReport::ok(), or stays
  /// where it was.  The report lives until the next call.
  /// @throws std::invalid_argument if dt is not finite and positive, or for axes with properties, contacts or
  /// joints that break and an integrator other than kRattle; kMoreauJean lacks joints that break and
  /// compliant contacts only.
  const StepReport& step(double dt);
  /// What happens from now on, in place of what was given before: see Event.  step() divides the step of dt
  /// where events happen, and its report is that of all parts together; mean reactions, contacts and axes are
  /// those of the last part.  Events of one instant happen in the order of the list.  A joint that cannot be
  /// attached ends the step with Status::kContradiction and the world at the event, which has not happened;
  /// if a part fails, the world is where that part began.  What they have set, and which have happened, is in
  /// checkpoints.  Events of the world that was assigned to are forgotten.
  /// @throws std::invalid_argument if an event names what the world does not have, has a number that is out
  /// of range, or a name that is given twice.
  void set_events(std::vector<Event> events);
  /// All that has happened, in its order.
  const std::vector<EventRecord>& events_happened() const;
  /// The last event that has ended the run (EndRun), by name; empty if none has.  step() still steps.
  const std::string& ended_by() const;
  /// Steps of h until the time is t [s], to the last bit: the last step is shorter, or longer by up to a
  /// millionth of h where that saves a tiny one.  Ends with the first step that is not ok(), so also with one
  /// that set_interrupt() has ended, and with one in which an event ends the run.  Nothing is done if it is t
  /// already.
  /// @throws std::invalid_argument if t is not finite or has passed, h is not finite and positive, or there
  /// are more than 1e12 steps, or settings exclude what the world has.
  RunReport run_until(double t, double h);
  /// apply_force(world, …) of the world: a wrench about the centre of mass of a body, world axes [N·m, N],
  /// during the next step alone (core/world/applied_force.h).
  /// @throws std::invalid_argument, with the name of the body, for a value that is not finite.
  void apply_force(BodyId body, const Wrench& wrench);
  /// A force [N], world axes, at point P of the body, by how the body is turned now, in the next step alone.
  void apply_force(BodyId body, const Vec3& p_BP, const Vec3& force);
  const StepReport& report() const;  ///< of the last step() or assemble()

  /// Asked now and then inside step() and assemble(), between sub-steps, iterations and parts of a long
  /// factorisation, whether to end early; with CHOLMOD a factorisation is one part.  If it says yes, the
  /// world stays as it was before the call and the report has Status::kInterrupted; what is known of contacts
  /// is kept as contact_stretches() had it.  It must be cheap, and safe to call from several threads at once;
  /// empty: nothing is asked.
  void set_interrupt(std::function<bool()> asked);
  /// Told inside step() of each stage with contacts that is solved directly, as a friction problem
  /// (solvers/complementarity/contact_stage.h), in the order in which they are: several a step, since
  /// positions are closed by iterations.  What it throws comes through; empty: nothing is told.
  void set_stage_watch(std::function<void(const ContactStage&)> watch);

  /// Mean reaction of a joint over the last step: the impulse that it gave, divided by dt.
  Reaction mean_reaction(JointId joint) const;
  /// Reaction at the present instant from the acceleration equation  S λ = −(γ + J M⁻¹ f).
  /// One assembly, factorisation and solve for all joints on the first call after a step.  Where free axes
  /// have limits, motors, friction or springs: the multipliers at the end of the last step.
  Reaction reaction(JointId joint);

  /// What acted along a free axis over the last step: mean forces and works of its motor, friction, limits
  /// and spring.  All zero for an axis without properties.
  /// @throws std::invalid_argument for an axis that is not there.
  AxisReport axis_report(AxisId axis) const;

  /// The contacts of the last step with the mean forces that they gave: those that are there at its end, and
  /// those that were given up in between.  Without restitution or friction a contact is still listed when it
  /// is near (Settings::contact_margin) and gives nothing.
  std::vector<ContactReport> contacts() const;

  /// The springs of compliant contacts across their normals, as the last step left them: what a state needs
  /// besides World::state(), so that a heap which is put back goes on standing.  Empty before the first step
  /// and after one that failed.
  std::vector<ContactStretch> contact_stretches() const;
  /// The next step starts with contacts stretched so, and with all bodies awake: for the state to which they
  /// belong, after World::set_state().  Those that are not found within 1e-4 m of p_AP, or are rigid, are
  /// left out.
  /// @throws std::invalid_argument for a shape that is not there, or what is not finite.
  void set_contact_stretches(std::vector<ContactStretch> stretches);

  /// All that goes on from here depends on: a simulator of an equal world with equal settings that restores
  /// it takes the same steps as this one, to the last bit, whatever contacts, friction, sleep, merged bodies
  /// and breaking joints remember.  What was changed in the world since the last step is taken up as the next
  /// step would.
  Checkpoint checkpoint();
  /// Sets the world to the state of a checkpoint, with what is detached and asleep, and goes on from there.
  /// What is no part of a state stays the world's: axis properties, materials, forces, gravity.
  /// @throws std::invalid_argument if it is empty, or made with another world (bodies, joints, shapes and
  /// forces by number, name and kind) or with another integrator, solver, or choice of contacts, sleep or
  /// merging; world and simulator are then as before.
  void restore(const Checkpoint& checkpoint);

  /// Rank, freedoms and redundant rows by name in the present pose.  Nothing moves.
  RankReport analyze_rank();
  /// What cannot hold together `horizon` [s] from now: joints with limits, motors of unbounded force and
  /// contacts, by an irreducible set of them.  Empty if all of it can, as far as is known.  Nothing moves.
  /// @throws std::invalid_argument if the horizon is negative or not finite.
  Contradiction contradiction(double horizon = 0);
  /// Closes all joints from the present pose by the smallest mass-weighted move; velocities are made tangent.
  const StepReport& assemble();

  /// The fixed joints that are not solved, because their bodies move as one (Settings::merge_fixed_joints),
  /// in ascending order.  Their reactions follow from the motion.    (solvers/simulator, "Merged bodies")
  std::vector<JointId> merged_joints() const;

  const World& world() const;        ///< as given
  const Settings& settings() const;  ///< as given
  /// "CHOLMOD 3.0.14 supernodal, OpenBLAS 0.3.21 …": which factor and BLAS do the work.
  std::string solver_description() const;

 private:
  Checkpoint checkpoint_before(std::vector<DueEvent> due);
  const StepReport& step_with_events(double dt);
  bool take_part(double from, double to);
  bool locate_event(double from, double to, const Checkpoint& before);
  bool let_happen(StepReport& whole, double instant);
  Checkpoint checkpoint_if_any(const std::vector<DueEvent>& due);
  class Impl;
  Impl& impl() const;
  mutable std::unique_ptr<Impl> impl_;
};

}  // namespace taut
