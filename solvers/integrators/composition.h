#pragma once

#include <span>
#include <vector>

#include "solvers/integrators/scheme.h"

namespace taut {

/// A symmetric composition of RATTLE, a symmetric scheme of order 2: its steps of γ₁h, γ₂h, … with Σ γ_i = 1
/// are one of order 4, 6 or 8; some γ are negative.  Other integrators have γ₁ = 1 alone.  All stages of a
/// step of h are taken or none, since one of another length would cost the order.
/// (solvers/integrators, "Composition")
class Composition {
 public:
  /// The integrator says of which order.
  explicit Composition(Integrator integrator);

  /// A step begins from where the scheme is.
  void begin(const Scheme& scheme);
  /// No stage of it is left.
  bool is_done() const { return left_.empty(); }
  /// γ of the next stage.
  double next();
  /// A stage has failed: the scheme is where it was when the step began.
  void give_up(Scheme& scheme, SubstepReport& report);
  /// No step has begun.
  void forget() { left_ = {}; }
  /// The largest h whose longest stage respects the limit of the scheme [s].
  double step_limit(const Scheme& scheme) const { return scheme.step_limit() / longest_; }

 private:
  std::span<const double> fractions_, left_;  // γ, and of those stages that are still to be taken
  double longest_ = 0;                        // |γ|
  State before_;
  std::vector<double> impulses_before_;
};

}  // namespace taut
