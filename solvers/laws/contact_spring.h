#pragma once

#include <cmath>

#include "solvers/laws/contact_constraints.h"

namespace taut {

/// The spring and damper of a compliant contact, 0 ≤ N ⊥ gap + C N ≥ 0, in a step of h, for the mass 1/S_rr
/// that a row of it feels: ω = √(S_rr/C).                        (solvers/laws, "Compliant contacts")
struct ContactSpring {
  double compliance = 0;  ///< C [m/N]; 0: rigid
  double root = 1;        ///< √S_rr
  double h = 0;           ///< [s]

  double period() const { return std::sqrt(compliance) / root; }  ///< 1/ω [s]
  /// True if the step is short enough to see the impact of a compliant contact: ω h < 1.
  bool impact_is_seen() const { return compliance > 0 && h * root < std::sqrt(compliance); }

  /// N = max(0, −g/C) with the gap g = g₀ + a w, and h N = 2λ (Eq. 7).  With a = h/2, the middle of the step,
  /// N (g₁ − g₀) is the change of g²/2C: energy is conserved while the bodies touch.  With a = h, its end,
  /// N |g₁ − g₀| ≥ g₁²/C, more than the spring stores: bodies that come to touch never gain any.  More than
  /// h/2 is a damper.                                                               (solvers/laws, Eq. 7)
  ContactConstraints::NormalLaw position_law(double gap, double restitution) const;
  /// The second kick μ gives what the first gave, `back`, unless the bodies then part faster than w̄, the rate
  /// of an impact and that of a spring as deep as they are.  As 2σλ is ω times the depth that belongs to λ,
  /// all of μ = λ is given up to (1 − δ) of that rate.  Where the step does not resolve the spring δ = 1, a
  /// critical damper: with μ = λ what rests would swing from step to step, and so it shrinks by (1 + eωh)/(1
  /// + ωh) in two steps.  The law is in μ: δ σ Λ = δ σ (μ + back).                    (solvers/laws, Eq. 8)
  ContactConstraints::NormalLaw velocity_law(double gap, double approach, double back,
                                             double restitution) const;

  /// Law of the tangents: the spring, with its stiffness across the normal, yields where friction does, so
  /// that its stretch `target` [m] is what has slipped.
  ContactConstraints::SlipLaw position_slip_law(const Vec2& target) const {
    return {target, 2 * compliance / (h * h)};
  }
  /// The second kick gives what the first gave, less a critical damper.
  ContactConstraints::SlipLaw velocity_slip_law(const Vec2& given) const {
    const double softness = root * std::sqrt(compliance) / h;
    return {softness * given, softness};
  }
};

}  // namespace taut
