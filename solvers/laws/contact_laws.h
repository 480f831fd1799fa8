#pragma once

#include <span>

#include "solvers/laws/friction_linearization.h"
#include "solvers/laws/row_law.h"
#include "solvers/laws/signorini_coulomb.h"
#include "solvers/laws/stick_search.h"

namespace taut {

class Archive;

/// Contacts as laws of their rows for the two stages of a RATTLE step: Signorini's law and Newton's of impact
/// along the normal, Coulomb's in the disc |Λ_t| ≤ μ Λ_n of the tangents, likewise rolling and spinning.
///
///   position stage   w = J(q₀) M⁻¹ p, Λ = λ the impulse of the first kick
///   velocity stage   w = J(q₁) M⁻¹ p₁, Λ = λ + μ that of both
///
/// As cones they are exact; as laws of single rows their friction is a linearization about the last solution.
///                                                                                 (solvers/laws, "Contacts")
class ContactLaws : public ContactRows {
 public:
  using Cone = ContactCone;

  explicit ContactLaws(ContactConstraints& table) : ContactRows(table) {}
  ContactLaws(const ContactLaws&) = delete;

  /// Of their rows in the present stage.
  void set_laws(std::span<RowLaw> laws) const;
  /// In place of the laws of a stage: what presses at impulses λ holds, along its normal and across it, and
  /// the others give nothing.
  void held_laws(std::span<const double> lambda, std::span<RowLaw> laws) const;

  Cone cone(int k) const { return contact_cone(*this, k); }
  /// Rates that the cones ask for.
  void targets(std::span<double> target) const;
  /// Rigid contacts that come together, by more than `least` [√J] of the natural residual, at impulses of
  /// more than `most` [√J]: joints hold their normals (bodies in one line, of which the first and the last
  /// touch), hardly an impulse changes their rate, and what they ask for contradicts the joints by terms of
  /// second order.  For the rest of the stage they have a compliance of 1e-6 S_rr, unless that let them come
  /// together by more than 1e-5 m in the step.
  /// @returns whether there are any that did not before.
  bool let_yield(std::span<const double> lambda, std::span<const double> w, double least, double most);

  // Friction by row laws (friction_linearization.h).
  void take_over(std::span<const double> lambda, std::span<const double> w, double rate_tolerance) {
    friction_.take_over(lambda, w, rate_tolerance);
  }
  double residual() const { return friction_.residual(); }

  StickSearch& stick_search() { return stick_search_; }
  bool weakened() const { return stick_search_.weakened(); }

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer_residuals(Archive& archive);

 protected:
  /// Laws of the springs of compliant contacts for the position stage, and for the velocity stage.  @{
  void set_position_springs();
  void set_velocity_springs();  /// @}
  /// That of the tangents of contact k in the velocity stage, after what the first kick gave.
  void set_velocity_slip(int k);

 private:
  void friction_laws(int k, std::span<RowLaw> laws) const;

  FrictionLinearization friction_{*this};
  StickSearch stick_search_{*this, friction_};
};

}  // namespace taut
