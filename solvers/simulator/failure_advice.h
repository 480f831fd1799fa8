#pragma once

#include <span>
#include <string>

#include "solvers/simulator/inquiry.h"

/// Words for who has the largest share in what a step could not do, and what may help.
/// (solvers/diagnosis, "A step that failed")
namespace taut {

/// ": ball elbow stays open by 1e-09 m; a shorter step …" of the joint that does most by its gaps φ, which
/// becomes the culprit of the report; "" if none does, or no more than `least`.
std::string widest_gap(const Inquiry& asked, const State& state, std::span<const double> phi, double least);
/// widest_gap() with the gaps φ of the state, and any of them.
std::string widest_gap(const Inquiry& asked, const State& state);

/// ": contact of box and ground (3e-07), … ; a shorter step …" of the report's culprits, those that miss
/// their laws most.
std::string list_culprits(const Inquiry& asked);

/// "; ball hip twist is next to where it has no value", as at a swing of π; "" if no axis is.
std::string singular_axis(const Inquiry& asked);

}  // namespace taut
