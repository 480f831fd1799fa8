#include "solvers/integrators/force_iteration.h"

#include <algorithm>

namespace taut {
namespace {

/// Chosen, where nothing else is said.
struct ForceIterationTuning {
  /// Forces are settled that change by no more than this part of the largest, a little above round-off.
  static constexpr double kTolerance = 1e-12;
  /// A pass that leaves more than the second, which is a part of the change, stalls it, as do so many passes;
  /// halves come to 1e-12 in 40.
  static constexpr int kMostPasses = 60;
  static constexpr double kSlow = 0.5;
};

}  // namespace

ForceIteration::Fixed ForceIteration::look(std::span<const Wrench> forces, std::span<const Wrench> last) {
  double change = 0, size = 0;
  int most = 0;
  for (std::size_t b = 0; b < forces.size(); ++b) {
    const double of_body = std::max((forces[b].force - last[b].force).cwiseAbs().maxCoeff(),
                                    (forces[b].torque - last[b].torque).cwiseAbs().maxCoeff());
    if (of_body > change) change = of_body, most = static_cast<int>(b);
    size = std::max({size, forces[b].force.cwiseAbs().maxCoeff(), forces[b].torque.cwiseAbs().maxCoeff()});
  }
  if (!(change > ForceIterationTuning::kTolerance * size)) return Fixed::kYes;
  if (pass_ >= ForceIterationTuning::kMostPasses ||
      (pass_ > 0 && change > ForceIterationTuning::kSlow * last_change_)) {
    unsettled_ = most;
    return Fixed::kStalled;
  }
  ++pass_;
  last_change_ = change;
  return Fixed::kNotYet;
}

}  // namespace taut
