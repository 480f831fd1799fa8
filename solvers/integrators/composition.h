#pragma once

#include <span>
#include <vector>

#include "solvers/integrators/rattle.h"

namespace taut {

/// A symmetric composition of RATTLE, a symmetric scheme of order 2: its steps of γ₁h, γ₂h, … with Σ γ_i = 1
/// are one of order 4, 6 or 8; some γ are negative.  (solvers/integrators, "Composition")
class Composition final : public Rattle {
 public:
  /// The settings say of which order.
  Composition(const World& world, ConstraintSystem& system, const Settings& settings);

  /// All stages of a step of h, or none, since one of another length would cost the order: after an outcome
  /// that is not kDone the scheme is where it was, but for kNotFinite and kBlind.
  [[nodiscard]] Outcome advance(double h, SubstepReport& report) override;
  /// The largest h whose longest stage respects the limit of RATTLE.
  double step_limit() const override { return Rattle::step_limit() / longest_; }

 private:
  std::span<const double> fractions_;  // γ
  double longest_ = 0;                 // |γ|
  State before_;
  std::vector<double> impulses_before_;
};

}  // namespace taut
