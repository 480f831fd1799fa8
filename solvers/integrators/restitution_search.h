#pragma once

#include <functional>

namespace taut {

/// Newton's law of impact with friction may give energy (Kane's paradox).  Sought is the part of restitution,
/// 0 to 1, with which impacts take (1 − e²) of what they take without it, as they would without friction: e
/// is then energetic, as Stronge's.                                             (solvers/laws, "Impacts")
struct RestitutionSearch {
  double restitution = 0;             ///< e, the largest of those that strike
  std::function<bool(double)> solve;  ///< meets the laws with this part of each e; false if that fails
  std::function<double()> energy;     ///< what that has given [J]

  /// From a solution with all of restitution, which has given energy.  False if a solve fails.
  bool run() const;
};

}  // namespace taut
