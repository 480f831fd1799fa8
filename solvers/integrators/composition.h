#pragma once

#include <span>

#include "solvers/common/settings.h"

namespace taut {

/// Sub-step fractions γ_i of a symmetric composition of a symmetric second-order method, Σ γ_i = 1.  Applying
/// the method with steps γ₁h, γ₂h, … gives order 4, 6 or 8; some γ are negative.
/// (solvers/integrators, "Composition")
std::span<const double> composition_of(Integrator integrator);

}  // namespace taut
