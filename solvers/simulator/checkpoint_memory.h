#pragma once

#include "core/state/archive.h"
#include "solvers/simulator/simulator.h"

/// Plain data of a checkpoint.  What each part remembers is its own transfer(), all of them in
/// checkpoint_memory.cpp.
namespace taut {

void transfer_fields(Archive& archive, ContactReport& r);
void transfer_fields(Archive& archive, AxisReport& r);
void transfer_fields(Archive& archive, Reaction& r);

}  // namespace taut
