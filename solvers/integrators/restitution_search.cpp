#include "solvers/integrators/restitution_search.h"

#include <algorithm>

namespace taut {
namespace {

struct RestitutionSearchTuning {
  /// Solves, at most, and the part of the energy lost without restitution that it is found to.  Chosen.
  static constexpr int kMostSolves = 12;
  static constexpr double kAccuracy = 1e-6;
};

}  // namespace

/// Regula falsi, Illinois; the last part that is not above is taken.
bool RestitutionSearch::run() const {
  double high = 1, above = energy();
  if (!solve(0)) return false;
  const double e = restitution, plastic = std::min(0.0, energy()), wanted = (1 - e * e) * plastic;
  double low = 0, below = plastic - wanted, last = 0;
  above -= wanted;
  for (int k = 0;
       k < RestitutionSearchTuning::kMostSolves && below < RestitutionSearchTuning::kAccuracy * plastic;
       ++k) {
    const double part = (low * above - high * below) / (above - below);
    if (!solve(part)) return false;
    last = part;
    const double off = energy() - wanted;
    if (off > 0) {
      high = part, above = off, below *= 0.5;
    } else {
      low = part, below = off, above *= 0.5;
    }
  }
  return last == low || solve(low);
}

}  // namespace taut
