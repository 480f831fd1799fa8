#pragma once

#include "solvers/laws/law_constants.h"

namespace taut {

/// When impulses of a stage act: in RATTLE at the start of the step, where the rate w of a law is the mean
/// one, and at its end, with w = θ̇(q₁); in Moreau–Jean once, with w the rate after it.
enum class Kick { kFirst, kSecond, kSingle };

/// A step of free axes: two kicks of h/2 in RATTLE, one of h in Moreau–Jean.  (solvers/laws, "Axes")
struct AxisStep {
  double h = 0;              ///< length [s]
  double end_time = 0;       ///< [s]
  Kick kick = Kick::kFirst;  ///< of the present stage
  double vartheta = 0;       ///< ϑ of Moreau–Jean
  double restitution = 1;    ///< part of e that counts in a round of impacts

  bool in(Kick which) const { return kick == which; }
  /// How long forces act in this kick [s].
  double kick_time() const { return in(Kick::kSingle) ? h : 0.5 * h; }
};

/// An axis at the start of a step.
struct AxisStart {
  double theta = 0;           ///< θ₀ [rad or m]
  double rate = 0;            ///< θ̇₀ [rad/s or m/s]
  double effective_mass = 0;  ///< 1/S_rr [kg·m² or kg]; of motors that ask for it, with all joints held
  double let_out = 0;         ///< of a rope with a winch [m]
};

/// The way of an axis in a step: forces act for `time`, at this `part` of the way.
struct AxisStroke {
  double time = 0;          ///< of a kick [s]
  double from = 0, to = 0;  ///< [rad or m]
  double per_rate = 0;      ///< ∂to/∂w [s]
  double part = 0.5;        ///< from 0 to 1
};

/// With the rate w of the position stage, or at the end of a step of Moreau–Jean: RATTLE goes h w, with the
/// middle of it as the place of a force in both kicks; Moreau–Jean h V_ϑ.
inline AxisStroke stroke(const AxisStep& step, const AxisStart& start, double w) {
  if (!step.in(Kick::kSingle)) return {0.5 * step.h, start.theta, start.theta + step.h * w, step.h, 0.5};
  return {step.h, start.theta, start.theta + step.h * ((1 - step.vartheta) * start.rate + step.vartheta * w),
          step.vartheta * step.h, step.vartheta};
}

}  // namespace taut
