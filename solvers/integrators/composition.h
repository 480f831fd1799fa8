#pragma once

#include <span>
#include <vector>

#include "solvers/common/settings.h"
#include "solvers/integrators/impulse_scheme.h"

namespace taut {

/// A symmetric composition of a symmetric scheme of order 2: its steps of γ₁h, γ₂h, … with Σ γ_i = 1 are one
/// of order 4, 6 or 8; some γ are negative.  Of order 2, and for Moreau–Jean, it is the scheme itself.
/// (solvers/integrators, "Composition")
class Composition final : public Scheme {
 public:
  /// The scheme must outlive it.
  Composition(Integrator integrator, ImpulseScheme& scheme);

  /// All stages of a step of h, or none, since one of another length would cost the order: after an outcome
  /// that is not kDone the scheme is where it was, but for kNotFinite and kBlind.
  /// Whose stages it has.
  ImpulseScheme& scheme() { return scheme_; }

  [[nodiscard]] Outcome advance(double h, StepReport& report) override;
  /// The largest h whose longest stage respects the limit of the scheme.
  double step_limit() const override { return scheme_.step_limit() / longest_; }

  void start(const State& state, StepReport& report) override { scheme_.start(state, report); }
  double time_to_event() const override { return scheme_.time_to_event(); }
  const State& state() const override { return scheme_.state(); }
  std::span<const Wrench> momenta() const override { return scheme_.momenta(); }
  std::span<const double> impulses() const override { return scheme_.impulses(); }
  void transfer(Archive& archive) override { scheme_.transfer(archive); }

 private:
  ImpulseScheme& scheme_;
  std::span<const double> fractions_;  // γ
  double longest_ = 0;                 // |γ|
  State before_;
  std::vector<double> impulses_before_;
};

}  // namespace taut
