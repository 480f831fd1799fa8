#pragma once

#include "collision/narrow/convex.h"

namespace taut::detail {

/// The direction in which two convex bodies are farthest apart, or overlap least.
struct Separation {
  Vec3 n;    ///< unit, in the frame of A, from A to B
  double s;  ///< min_B n·x − max_A n·x of the full bodies [m]; negative: depth of penetration
};

/// Maximises s(n) over the unit sphere (collision/narrow, Eq. 1).  For separated bodies the maximum is their
/// distance and unique; for overlapping ones it is exact for boxes, hulls, capsules and spheres with up to
/// kEdgePairs pairs of edge directions, and the local maximum next to the best candidate otherwise. Returns
/// false, early, if a direction with s > cutoff exists.
bool find_separation(const Convex& A, const Convex& B, const Relative& X_AB, double cutoff, Separation& out);

}  // namespace taut::detail
