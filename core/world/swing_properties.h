#pragma once

#include <optional>

#include "core/world/world.h"

namespace taut {

/// A swing of a joint that has friction, or a spring whose rest is 0.  Where it is 0 the direction of that
/// axis is none, so these act along two others of the joint instead.             (solvers/laws, "Axes")
struct SwingProperties {
  int swing = 0;  ///< by its place in the joint
  SwingAxes across{};
  bool has_friction = false;  ///< its turns have rows, too
  bool has_spring = false;    ///< its components have rows, too, and its spring

  bool operator==(const SwingProperties& other) const {
    return swing == other.swing && has_friction == other.has_friction && has_spring == other.has_spring;
  }
};

namespace detail {
/// Without a table, or none at all.
inline bool is_linear(const std::optional<AxisSpring>& spring) {
  return !spring || (!spring->table && !spring->damping_table);
}
}  // namespace detail

/// A linear spring of a swing with its rest at 0 is one of each component: −k θ j is −k s.
inline std::optional<SwingProperties> swing_properties(const World& world, JointId joint) {
  for (int k = 0; k < world.axis_count(joint); ++k) {
    const SwingAxes& across = world.axis_info({joint, k}).across;
    if (across.turns[0] < 0 || across.components[0] < 0) continue;
    const auto spring_of = [&](int axis) -> const auto& {
      return world.axis_properties({joint, axis}).spring;
    };
    SwingProperties swing{.swing = k, .across = across};
    swing.has_friction = world.axis_properties({joint, k}).friction.has_value();
    swing.has_spring = spring_of(k) && spring_of(k)->rest == 0 && detail::is_linear(spring_of(k)) &&
                       detail::is_linear(spring_of(across.components[0])) &&
                       detail::is_linear(spring_of(across.components[1]));
    if (swing.has_friction || swing.has_spring) return swing;
  }
  return {};
}

/// Both springs of a component: its own, if it has one, and that of the swing.
inline AxisSpring with_spring_of_swing(const std::optional<AxisSpring>& own, const AxisSpring& swing) {
  if (!own) return swing;
  const double stiffness = own->stiffness + swing.stiffness;
  return {.stiffness = stiffness,
          .damping = own->damping + swing.damping,
          .rest = stiffness > 0 ? own->stiffness / stiffness * own->rest : 0};
}

}  // namespace taut
