#pragma once

#include <span>
#include <string>

#include "core/constraints/wide_parts.h"
#include "core/world/world.h"

namespace taut {

namespace detail {

/// Σ w_i |p_{i+1} − p_i| along the points; sections between two points of one body are constant.
/// @throws std::invalid_argument if there are fewer than two points or bodies, a point is not finite.
row_parts::Coupling wire_length(const std::string& name, const std::vector<WirePoint>& points,
                                const std::vector<double>& weights, std::span<const BodyId> bodies);
/// Different bodies of the points, the first and the last in front.
std::vector<BodyId> wire_bodies(const std::string& name, const std::vector<WirePoint>& points);
}  // namespace detail
}  // namespace taut
