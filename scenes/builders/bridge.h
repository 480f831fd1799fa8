#pragma once

#include <vector>

#include "scenes/builders/scene.h"

namespace taut {

/// Plank bridges on a hanging circular arc of equal chords, held by the world at both ends:
///   bridge-hinge   one hinge per seam: 5 (n + 1) rows of which 3 are redundant
///   bridge-balls   two ball joints per seam: 6 (n + 1) rows of which n + 4 are redundant
///   bridge         short name of bridge-balls with other defaults
/// With `truck` a mass of 400 planks stands welded on plank n / 2.
std::vector<SceneInfo> bridge_scenes();

/// What add_bridge() has built.
struct Bridge {
  std::vector<BodyId> planks;  ///< along x
  Vec3 plank = Vec3::Zero();   ///< size of one [m]
  double half_span = 0;        ///< its ends are at (±half_span, 0, 0) [m]
};
/// n planks on a hanging arc, with hinges or pairs of ball joints between them and to the ground.
Bridge add_bridge(Scene& scene, int n, bool hinges);

}  // namespace taut
