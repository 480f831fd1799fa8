#pragma once

#include "solvers/simulator/inquiry.h"

/// What looking for contacts came to in a step.
namespace taut {

/// Pairs of shapes without a law for their contact, and threads that are missing.
void report_detection(const Stepper& stepper, StepReport& report);

/// Ends a step in which contacts could not be looked for: there are too many, or a body is nowhere.
void end_blind(const Inquiry& asked);

}  // namespace taut
