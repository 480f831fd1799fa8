#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "core/world/world.h"
#include "solvers/common/settings.h"
#include "solvers/common/step_report.h"
#include "solvers/laws/axes/axis_forces.h"
#include "solvers/laws/breaking.h"
#include "solvers/laws/contact_forces.h"

namespace taut {

class Archive;

/// A scheme of time integration, as the simulator sees it: it starts at a state and advances it by steps.
/// RATTLE, Moreau–Jean, the force level and reduced coordinates are such schemes.  What acts beside joints is
/// empty where the settings exclude it, as for the force level.  (solvers/integrators)
class Scheme {
 public:
  enum class Outcome { kDone, kStalled, kUnstable, kImpact, kOverload, kNotFinite, kBlind };
  /// Whose velocities a state has: the user's, which joints may forbid, or those that a step has ended with.
  enum class Velocities { kGiven, kLeft };

  Scheme(const World& world, const Rows& rows, const Settings& settings)
      : axes_(world, rows, settings.locate_plastic_impacts),
        contacts_(world, settings),
        breaking_(world, rows) {}
  virtual ~Scheme() = default;
  Scheme(const Scheme&) = delete;
  Scheme& operator=(const Scheme&) = delete;

  // Starting.
  /// Joints are closed where it starts, and its steps end with J V = 0.
  virtual bool closes_joints() const { return true; }
  /// Before a start: no step will be longer than `horizon` [s], compliant contacts are stretched so
  /// (ContactForces::recall()), and contacts go on that a scheme of the same kind knew before the pattern
  /// changed, if there is one.
  virtual void prepare(double /*horizon*/, std::vector<ContactStretch> /*stretches*/, Scheme* /*old*/) {}
  /// Takes over a state.
  virtual void start(const State& state, Velocities velocities, SubstepReport& report) = 0;
  /// start() in the pattern that there is, which keeps what is known of contacts and friction.
  virtual void restart(const State& state, Velocities velocities, SubstepReport& report) {
    start(state, velocities, report);
  }
  /// Back at a state of the same step, from which on impulses were these.
  virtual void go_back(const State& state, std::span<const double> /*impulses*/, SubstepReport& report) {
    start(state, Velocities::kLeft, report);
  }
  /// After start(): what held and how in that scheme, with the forces as a guess.
  virtual void inherit(const Scheme& /*old*/) {}
  /// Nothing is known of contacts and axes of bodies that were moved (one entry a body).
  virtual void forget(std::span<const char> /*moved*/) {}
  /// Gravity or a force law has changed, the state has not.  False if that is a jump: restart(), then.
  virtual bool renew_forces() { return false; }

  // Stepping.
  /// A step of dt [s] begins, of one or more advances.
  virtual void begin(double /*dt*/) {}
  /// One step of h ≠ 0 [s] (negative in compositions).  kStalled: joints or laws could not be met; kUnstable:
  /// the multipliers turned out to demand a smaller step; kImpact, kOverload: an axis or contact bounces, or
  /// a joint breaks, at time_to_event(), where the next advance must end, or has broken now if that is 0;
  /// kBlind: contacts could not be looked for.  The state is then the old one.  kNotFinite: so is the state.
  [[nodiscard]] virtual Outcome advance(double h, SubstepReport& report) = 0;
  virtual double time_to_event() const { return 0; }  ///< [s]
  /// Laws count as met within this residual when all that may be tried has been, which is less if `soon`.
  virtual void accept_inexact(double /*residual*/, bool /*soon*/) {}
  /// After kStalled: true if it was laws with contacts, whose impulses are no guess for the next advance.
  virtual bool drop_guess() { return false; }
  /// The longest step from here that the scheme is stable and accurate with [s].
  virtual double step_limit() const { return std::numeric_limits<double>::infinity(); }

  /// The last step ended at this time to the last bit.
  virtual void set_time(double /*time*/) {}

  // Where it is.
  virtual const State& state() const = 0;
  /// M V of the bodies in world axes, those of state().
  virtual std::span<const Wrench> momenta() const = 0;
  /// Impulses of the rows in the last advance, or since they were cleared [N·s, N·m·s].
  virtual std::span<const double> impulses() const = 0;
  /// φ of the rows at state(), if it is known; else empty.
  virtual std::span<const double> known_residual() const { return {}; }
  /// Forces of the rows at state() [N, N·m], if they do not follow from it; else empty.
  virtual std::span<const double> forces_of_laws() const { return {}; }
  /// Forces of all rows at state() [N, N·m], if the scheme finds them itself; else empty.
  virtual std::span<const double> present_forces() { return {}; }
  /// Works of what acts are reported.
  virtual bool knows_works() const { return true; }
  const AxisForces& axes() const { return axes_; }
  /// Sums over the sub-steps of a step, with impulses in place of mean forces; in the order of
  /// Rows::axis_rows().
  virtual const std::vector<AxisReport>& axis_reports() const { return axes_.reports(); }
  /// Why the last advance() ended with kStalled, for messages; empty: StallDiagnosis looks for it.
  virtual std::string stall_reason() const { return {}; }
  const ContactForces& contacts() const { return contacts_; }
  /// Of the step so far.
  const ContactWork& work_of_contacts() { return contacts_.works().sum(); }
  const Breaking& breaking() const { return breaking_; }
  /// Contacts could not be looked for the last time: see ContactCache::detection().
  bool blind() const { return !contacts_.empty() && contacts_.cache().detection().blind(); }
  /// Threads that could not be started.
  virtual int missing_threads() const { return 0; }
  /// The body whose state was not finite, if state() is the old one in spite of that; else the ground.
  virtual BodyId not_finite() const { return kGround; }

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  /// Reading, in place of start().
  virtual void transfer(Archive& archive) = 0;

 protected:
  AxisForces axes_;
  ContactForces contacts_;
  Breaking breaking_;
};

}  // namespace taut
