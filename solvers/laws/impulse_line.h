#pragma once

#include <algorithm>

#include "solvers/laws/law_constants.h"

namespace taut {

/// Chosen, where nothing else is said.
struct TangentTuning {
  /// Impulses of curves, which are taken by their tangents, are right to this part of themselves: better than
  /// laws are met, by two digits.
  static constexpr double kTolerance = 1e-11;
  /// Or to what changes the rate by this part of the tolerance of rates.
  static constexpr double kRatePart = 0.1;
};

/// By how much an impulse of this size may be off its curve [N·s or N·m·s].
inline double tangent_tolerance(double size, double rate_tolerance, double effective_mass) {
  return std::max(TangentTuning::kTolerance * size,
                  TangentTuning::kRatePart * rate_tolerance * effective_mass);
}

/// Impulse of a kick over the rate, λ = level − slope w.
struct ImpulseLine {
  double level = 0;  ///< [N·m·s or N·s]
  double slope = 0;  ///< c [kg·m² or kg]
  double at(double w) const { return level - slope * w; }
};

/// The rate where curves have their tangents, on its way to that of the solution, and between which rates
/// this is known to be.
struct TangentPoint {
  double rate = 0;                 ///< [rad/s or m/s]
  double lowest = 0, highest = 0;  ///< of the solution

  void start(double w) {
    rate = w;
    lowest = -kUnreachedRate, highest = kUnreachedRate;
  }
  /// To the rate w of a solution with these tangents.
  void move(double w, double rate_tolerance);
};

}  // namespace taut
