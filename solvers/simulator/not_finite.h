#pragma once

#include "solvers/simulator/inquiry.h"

namespace taut {

/// Ends a step with Status::kNotFinite and names what is not finite: what a motor or a joint follows, at the
/// start of the step or at its end; the joint whose row of S overflows; the force law; or the body.
/// (solvers/diagnosis, "A step that failed")
void end_not_finite(const Inquiry& asked);

}  // namespace taut
