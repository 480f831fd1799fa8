#pragma once

#include <cmath>

// What all laws share.
namespace taut {

/// Chosen, where nothing else is said.
struct LawTuning {
  /// A limit or contact is touched within this distance [m or rad]; positions are closed to less.
  static constexpr double kTouch = 1e-9;
  /// What starts beyond its limit, or bodies inside each other, come apart at no more than this rate [m/s or
  /// rad/s], so that an overlap does not throw them.  Chosen.
  static constexpr double kReturnRate = 1;
  /// Events (impacts, breaks) nearer to each other than this part of a sub-step happen together, and those
  /// nearer to its start or end happen there: no sub-step is shorter for them.  Chosen.
  static constexpr double kTogether = 1e-3;
  /// Rates this near to a step of the law are on it, as a part of 1 + |w| [m/s or rad/s]: laws are met to as
  /// much.
  static constexpr double kOnStep = 1e-9;
};
/// A step of a law that no rate comes to [m/s or rad/s].
inline constexpr double kUnreachedRate = 1e12;
inline bool on_step(double w, double at) {
  return std::abs(w - at) <= LawTuning::kOnStep * (1 + std::abs(w));
}

}  // namespace taut
