#pragma once

#include <span>
#include <vector>

#include "solvers/integrators/scheme.h"

namespace taut {

/// A symmetric composition of RATTLE, a symmetric scheme of order 2: its steps of γ₁h, γ₂h, … with Σ γ_i = 1
/// are one of order 4, 6 or 8; some γ are negative.  Other integrators have γ₁ = 1 alone.
/// (solvers/integrators, "Composition")
class Composition {
 public:
  /// The integrator says of which order.
  explicit Composition(Integrator integrator);

  /// As Scheme::advance(): all stages of a step of h, or none, since one of another length would cost the
  /// order.  After an outcome that is not kDone the scheme is where it was, but for kNotFinite and kBlind.
  [[nodiscard]] Scheme::Outcome advance(Scheme& scheme, double h, SubstepReport& report);
  /// The largest h whose longest stage respects the limit of the scheme [s].
  double step_limit(const Scheme& scheme) const { return scheme.step_limit() / longest_; }

 private:
  std::span<const double> fractions_;  // γ
  double longest_ = 0;                 // |γ|
  State before_;
  std::vector<double> impulses_before_;
};

}  // namespace taut
