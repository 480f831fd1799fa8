#pragma once

#include <memory>

#include "core/world/diagnostics.h"
#include "core/world/world.h"

/// Joints at other places of their bodies than those that they were made for.
namespace taut {

/// How far a joint is open in the present poses, detached or not, soft or rigid.
/// @throws std::invalid_argument for a missing joint, or one that couples an axis of a detached one.
Gap gap_of(const World& world, JointId joint);

/// X_BF for World::set_joint_frame(), with which a joint of two bodies is closed in the present poses: B's
/// end is moved by the smallest turn about the joint's anchor and the smallest shift that close it, so that a
/// ball is where its anchor on A is, a hinge has its axis on A, and a fixed joint keeps the present pose.
/// @throws std::invalid_argument, with the joint's name, for a joint of more than two bodies, one that
/// couples axes, or one that no place of its end closes.
Pose closing_frame(const World& world, JointId joint);

namespace detail {

/// The joint as one whose frame on body B is displaced by X_BF: it holds F as it held B.
std::shared_ptr<const Joint> with_frame(std::shared_ptr<const Joint> joint, const Pose& X_BF);

}  // namespace detail
}  // namespace taut
