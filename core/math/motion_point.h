#pragma once

#include <functional>

namespace taut {

/// f(t) with its first two derivatives.  Values that are not finite end a step with Status::kNotFinite.
struct MotionPoint {
  double value = 0, rate = 0, acceleration = 0;  ///< f, ḟ or f̈, in this order
};
/// A prescribed motion; core/state/motion.h makes some.
using Motion = std::function<MotionPoint(double time)>;

}  // namespace taut
