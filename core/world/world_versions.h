#pragma once

#include <cstdint>

namespace taut::detail {

/// Counts of changes of a World, each kind by itself: equal ones of one World mean equal contents of that
/// kind.                                                              (core/world, "Identity and change")
struct WorldVersions {
  std::int64_t topology = 0;    ///< what there is, and which axes and joints have rows
  std::int64_t state = 0;       ///< state, gravity and force laws, as they are set
  std::int64_t axes = 0;        ///< values of what acts along axes, and of compliances
  std::int64_t properties = 0;  ///< strengths, materials and who may collide
  std::int64_t geometry = 0;    ///< shapes
  std::int64_t sleep = 0;       ///< who is asleep
};

}  // namespace taut::detail
