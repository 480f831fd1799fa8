#pragma once

#include <vector>

#include "core/math/so3.h"

namespace taut {

/// A wheel that a track runs round, in the plane of the track: x ahead, z up [m].
struct TrackWheel {
  double x = 0, z = 0, radius = 0;
};

/// The pins of a closed track: n links of one pitch round wheels.
struct TrackPins {
  double pitch = 0;                  ///< [m]
  std::vector<Eigen::Vector2d> pin;  ///< (x, z) of pin k; link k goes from pin k to pin k + 1
};

/// Lays n links of equal pitch round wheels that stand anticlockwise (x to the right, z up) and are all
/// touched.  The pins are on the convex curve of arcs and tangents round the wheels, of radius
///   ρ = √((radius + offset)² + pitch²/4),
/// so that a link that bridges an arc touches its wheel at `offset` from the line of its pins, and one on a
/// straight run passes it by ρ − radius − offset.  The pitch is what closes the ring, to round-off.
/// @throws std::invalid_argument for fewer than two wheels, or too few links.
TrackPins lay_track(const std::vector<TrackWheel>& wheels, int links, double offset);

}  // namespace taut
