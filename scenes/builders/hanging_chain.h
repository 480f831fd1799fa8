#pragma once

#include <vector>

#include "core/math/so3.h"

namespace taut {

/// Nodes of a chain of n equal links that hangs at rest between two points, p₀ = from to pₙ = to: the
/// catenary of rigid links of equal mass.  The middle of link i has the slope a (i − c) against the
/// horizontal, since the horizontal tension is the same in all links and the vertical one grows by a weight
/// from link to link; a and c follow from the ends.  Ends above each other, between which no such chain
/// hangs, are joined by an arc of a circle.
/// @param length of all links [m]; at the distance of the ends the chain is straight
/// @param down direction of gravity, of any length; 0: −z
/// @throws std::invalid_argument if the length is less than the distance, n < 1, or one link has to sag.
std::vector<Vec3> hanging_chain(const Vec3& from, const Vec3& to, int n, double length, const Vec3& down);

}  // namespace taut
