#pragma once

#include <vector>

#include "solvers/integrators/impulse_scheme.h"

namespace taut {

/// Moreau–Jean time stepping [Moreau1999], [Jean1999]: the non-smooth scheme of order 1.  One step of length
/// h from (q₀, p₀), with q_M = q₀ ⊕ h/2 V₀ its predicted middle, V = M(q_M)⁻¹ p and the impulses Λ of the
/// whole step:
///
///   p₁ = p₀ + h f(q_ϑ, V_ϑ, t₀ + ϑh) + J(q_M)ᵀ Λ,     V_ϑ = (1 − ϑ) V₀ + ϑ V₁,   q_ϑ = q₀ ⊕ ϑh V_ϑ
///   q₁ = q₀ ⊕ h V_ϑ
///
/// joints: J V₁ + φ_t = 0;  contacts with gap(q_M) ≤ 0: 0 ≤ Λ_n ⊥ w_n + e w_n⁻ ≥ 0, |Λ_t| ≤ μ Λ_n against
/// w_t;  axes (AxisForces::set_laws): those of a stage, tables F: −h ((2 − 2ϑ) F̄ + (2ϑ − 1) F(θ₁)) with
/// the mean F̄ on the way to θ₁ = θ₀ + h ((1 − ϑ) w⁻ + ϑ w).  Nothing in it closes positions;
/// DriftCure::kPositionPush closes joints and limits after the step.  (solvers/integrators, "Moreau–Jean")
///
/// Under constant force q is exact for ϑ = ½ and (ϑ − ½) f h t/m behind otherwise.  Linear springs keep their
/// energy for ϑ = ½ (implicit midpoint rule) and lose it by 1/(1 + ω²h²) a step for ϑ = 1 (implicit Euler).
/// Joints lose ½ ‖ΔV‖²_M, of order h: V₀ is tangent at the q_M before and projected onto the tangents at this
/// one.  An impact without restitution takes ½ ‖ΔV‖²_M and the work of friction.  Angular momentum of
/// colliding bodies is off by the moment of the gap or depth at which they touch.
class MoreauJean final : public ImpulseScheme {
 public:
  MoreauJean(const World& world, ConstraintSystem& system, const Settings& settings);

  /// One step of h > 0; kDone, kStalled, kNotFinite or kBlind, as ImpulseScheme::advance().
  /// @throws std::invalid_argument if a contact is of materials with compliance; the state is then the old
  /// one.
  [[nodiscard]] Outcome advance(double h, SubstepReport& report) override;

 private:
  void predict(double h, std::span<double> impulses);
  void go_to_middle(double h, SubstepReport& report);
  void begin_laws(double h, std::span<double> impulses, SubstepReport& report);
  Outcome find_impulses(double h, std::span<double> impulses, SubstepReport& report);
  bool solve_stage(std::span<double> impulses, SubstepReport& report);
  bool meet_laws(double part, std::span<double> impulses, SubstepReport& report);
  double given_by_contacts(std::span<const double> impulses);
  void blend(double h);
  Pose moved(int b, double h) const;
  void add_works(double h, std::span<const double> impulses, SubstepReport& report);
  bool go_to_end(double h, SubstepReport& report);
  bool push_positions(SubstepReport& report);
  void note_passed_limit();
  void keep_impulses(double h, std::span<const double> impulses);

  double theta_ = 0.5;               // of this step
  State blended_;                    // q_ϑ, V_ϑ at t₀ + ϑh, where forces are taken
  std::vector<Twist> first_twists_;  // V₀
  std::vector<double> first_axes_;
  std::vector<Wrench> free_momenta_;  // without impulses
  std::vector<double> free_rates_, mean_rates_;
  std::vector<AxisForces::Bound> limits_;
};

}  // namespace taut
