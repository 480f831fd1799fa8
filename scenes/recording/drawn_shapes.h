#pragma once

#include "scenes/builders/scene.h"
#include "scenes/recording/recording.h"

namespace taut {

/// Fills shapes and drawn of a header.  A body is drawn by what the scene says for it, or else by its
/// collision shapes, or else, if it moves, as the uniform ellipsoid of its mass and inertia,
/// rᵢ = √(5 (Iⱼ + Iₖ − Iᵢ) / 2m), not thinner than a fiftieth of its length.  Equal shapes are listed once.
void collect_shapes(const Scene& scene, RecordingHeader& header);

}  // namespace taut
