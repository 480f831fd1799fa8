#pragma once

#include <span>
#include <vector>

#include "solvers/integrators/scheme.h"

namespace taut {

/// A symmetric composition of RATTLE, a symmetric scheme of order 2: its steps of α₁h, α₂h, … with Σ α_i = 1
/// are one of order 4, 6 or 8; some α are negative.  Other integrators have α₁ = 1 alone.  All stages of a
/// step of h are taken or none, since one of another length would cost the order.  It is no Scheme around
/// another: Substepping asks it for the next stage and tells it what failed, so that stages stand in the list
/// of a step, and can be interrupted, as sub-steps do. (solvers/integrators, "Composition")
class Composition {
 public:
  /// The integrator says of which order.
  explicit Composition(Integrator integrator);

  /// A step of h begins from where the scheme is.
  void begin(const Scheme& scheme, double h);
  /// No stage of it is left, or it is none of the present one any more.
  bool is_done() const { return left_.empty(); }
  void forget() { left_ = {}; }
  /// α h of the next stage.
  double next();
  /// A stage has failed: the scheme is where it was when the step began.
  void give_up(Scheme& scheme, SubstepReport& report);
  /// The largest h whose longest stage respects the limit of the scheme [s].
  double step_limit(const Scheme& scheme) const { return scheme.step_limit() / longest_; }

 private:
  std::span<const double> fractions_, left_;  // α, and of those stages that are still to be taken
  double longest_ = 0, h_ = 0;                // |α|, and h
  State before_;
  std::vector<double> impulses_before_;
};

}  // namespace taut
