#pragma once

#include <optional>
#include <pugixml.hpp>
#include <string>
#include <vector>

#include "core/world/world.h"

namespace taut {

/// A free axis of the joint between a body and its parent.
struct TreeAxis {
  AxisId id;
  bool angular = true;
  Vec3 direction = Vec3::UnitZ();  ///< of the motion against the parent, world axes
};

/// A body and what joins it to its parent.
struct TreeBody {
  BodyId body, parent;           ///< the ground is the parent of what is free or fixed
  JointId joint{-1};             ///< none: fixed to the ground, or free
  bool free = false;             ///< nothing joins it to the parent
  bool ball = false;             ///< its joint is a ball joint
  std::vector<TreeAxis> axes{};  ///< the first next to the parent; translations stand in front
  Vec3 anchor = Vec3::Zero();    ///< point of the joint, world [m]
};

/// A world as trees of bodies, which is what formats of robots can say.
struct ModelTree {
  std::vector<TreeBody> bodies;  ///< all but the ground, parents first
  std::vector<JointId> others;   ///< joints that are not in the trees
};
ModelTree model_tree(const World& world);

/// Points [m] in the world that stay together where a ball joint, hinge or fixed joint is: one, two of its
/// axis, three that do not lie on one line; none for other joints.
std::vector<Vec3> common_points(const World& world, JointId joint);

/// What the present values, limits and laws of an axis are; without its motor, and what a linear spring and
/// constant friction cannot say.
struct AxisWords {
  double value = 0;
  std::optional<double> lower, upper;
  double stiffness = 0, rest = 0, damping = 0, friction = 0;
};
/// What cannot be said is added to the notices.
AxisWords axis_words(const World& world, AxisId axis, std::vector<std::string>& notices);

/// "force 2 (torque on "arm")": which law it is, in the words of scene files, and its bodies.
std::string force_label(const World& world, ForceId force);

/// What no format can say of materials and joints as such: restitution, compliance, what is detached.
void note_what_no_model_has(const World& world, std::vector<std::string>& notices);

/// "0.1 0 -2", read back bit for bit.  @{
std::string words(const Vec3& v);
std::string words(double value);  /// @}

/// A document as text.
std::string xml_text(const pugi::xml_document& document);

}  // namespace taut
