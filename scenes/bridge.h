#pragma once

#include <vector>

#include "scenes/scene.h"

namespace taut {

/// Plank bridges on a hanging circular arc of equal chords, held by the world at both ends:
///   bridge-hinge   one hinge per seam: 5 (n + 1) rows of which 3 are redundant
///   bridge-balls   two ball joints per seam: 6 (n + 1) rows of which n + 4 are redundant
///   bridge         short name of bridge-balls with other defaults
/// With `truck` a mass of 400 planks stands welded on plank n / 2.
std::vector<SceneInfo> bridge_scenes();

}  // namespace taut
