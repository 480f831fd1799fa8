#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/state/force.h"
#include "core/state/state.h"

namespace taut {

class World;

/// A wrench on a body about its centre of mass, world axes [N·m, N].
struct BodyLoad {
  BodyId body;    ///< it acts on
  Wrench wrench;  ///< constant in world axes
};

/// What acts on bodies of a World beside gravity and its force laws for a while, as for one step
/// (apply_force()); it is no force with an id, and no part of the world as it is saved or appended.
class PassingLoads {
 public:
  /// These act from now on, and a law that is not conservative beside them, in place of those before; none:
  /// nothing does.  A new state version.
  static void set(World& world, std::span<const BodyLoad> loads, std::shared_ptr<const Force> law = nullptr);
  /// What apply_force() has been told for the next step, one entry a body at most; it does not act yet.  @{
  static const std::vector<BodyLoad>& next(const World& world);
  static void set_next(World& world, std::vector<BodyLoad> loads);  /// @}
};

}  // namespace taut
