#pragma once

#include <cmath>

#include "core/axes/axis.h"
#include "solvers/laws/axes/axis_part_law.h"

namespace taut {

/// The law of a property that is bounded, of which its header says the bound and the rate that it keeps: at
/// most bound(θ₀) times the length of a kick against w − kept_rate().  It remembers nothing.
template <BoundedAxisProperty Property, typename Place = AxisPlace<Property>>
struct AxisBoundLaw : AxisBoxLaw<Place::kPart> {
  void release() { this->bound = 0; }
  bool set(const AxisStage& stage) {
    release();
    const std::optional<Property>& property = Place::get(stage.p);
    if (!property) return true;
    const double most = stage.step.kick_time() * property->bound(stage.start.theta),
                 kept = property->kept_rate();
    if (!std::isfinite(most) || !std::isfinite(kept)) return false;
    this->bound = most, this->at = kept;
    return true;
  }
};

}  // namespace taut
