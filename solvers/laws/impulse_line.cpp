#include "solvers/laws/impulse_line.h"

namespace taut {

/// Digressive dampers would have Newton's method jump to and fro for ever, so what lies outside of the bounds
/// known is halved.
void TangentPoint::move(double w, double rate_tolerance) {
  (w > rate ? lowest : highest) = rate;
  if (w > lowest && w < highest)
    rate = w;
  else if (highest - lowest > rate_tolerance)
    rate = 0.5 * (lowest + highest);
  else
    start(w);  // others have moved it
}

}  // namespace taut
