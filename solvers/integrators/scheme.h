#pragma once

#include <limits>
#include <span>

#include "core/state/state.h"
#include "solvers/common/step_report.h"

namespace taut {

class Archive;

/// A scheme of time integration, as the simulator sees it: it starts at a state and advances it by steps.
/// RATTLE, Moreau–Jean, the force level and compositions are such schemes.            (solvers/integrators)
class Scheme {
 public:
  enum class Outcome { kDone, kStalled, kUnstable, kImpact, kOverload, kNotFinite, kBlind };

  Scheme() = default;
  virtual ~Scheme() = default;
  Scheme(const Scheme&) = delete;
  Scheme& operator=(const Scheme&) = delete;

  /// Takes over a state.
  virtual void start(const State& state, SubstepReport& report) = 0;
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

  virtual const State& state() const = 0;
  /// (L, P) of the bodies in world axes, those of state().
  virtual std::span<const Wrench> momenta() const = 0;
  /// Impulses of the rows in the last advance, or since they were cleared [N·s, N·m·s].
  virtual std::span<const double> impulses() const = 0;

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  /// Reading, in place of start().
  virtual void transfer(Archive& archive) = 0;
};

}  // namespace taut
