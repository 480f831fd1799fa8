#pragma once

#include <span>
#include <vector>

#include "solvers/common/settings.h"
#include "solvers/integrators/impulse_scheme.h"

namespace taut {

/// A symmetric composition of a symmetric scheme of order 2: its steps of γ₁h, γ₂h, … with Σ γ_i = 1 are one
/// of order 4, 6 or 8; some γ are negative.  Of order 2, and for Moreau–Jean, it is the scheme itself.
/// (solvers/integrators, "Composition")
class Composition {
 public:
  explicit Composition(Integrator integrator);

  /// All stages of a step of h, or none, since one of another length would cost the order: after an outcome
  /// that is not kDone the scheme is where it was, but for kNotFinite and kBlind.
  [[nodiscard]] ImpulseScheme::Outcome advance(ImpulseScheme& scheme, double h, StepReport& report);
  /// The largest h whose longest stage respects the limit of the scheme.
  double step_limit(const ImpulseScheme& scheme) const { return scheme.limit().step() / longest_; }

 private:
  std::span<const double> fractions_;  // γ
  double longest_ = 0;                 // |γ|
  State before_;
  std::vector<double> impulses_before_;
};

}  // namespace taut
