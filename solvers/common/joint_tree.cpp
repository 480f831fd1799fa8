#include "solvers/common/joint_tree.h"

#include <algorithm>

#include "core/world/swing_properties.h"

namespace taut {
namespace {

/// What of an axis has a force that does not follow from the state; null: nothing.
const char* unknown_force(const AxisProperties& p) {
  if (p.limits && p.limits->compliance == 0) return "rigid limits";
  if (p.motor && p.motor->pulls_only) return "a winch";
  if (p.motor && !p.motor->has_gains()) return "a motor without stiffness or damping";
  if (p.friction &&
      (p.friction->static_friction > 0 || p.friction->dynamic_friction > 0 || p.friction->per_load > 0))
    return "dry friction";
  return nullptr;
}

}  // namespace

JointTree::JointTree(const World& world, const Rows& rows) {
  const int bodies = rows.body_count();
  std::vector<int> branch_of(bodies, -1);  // of a moving body that is reached
  std::vector<char> used(rows.joints().size(), 0);
  const auto name = [&](int block) {
    return "joint " + world.name(std::get<JointId>(rows.joints()[block].owner));
  };
  // The other body of a block that holds something, or −1.
  const auto other_end = [&](int block, int body) {
    const Rows::JointRows& joint = rows.joints()[block];
    if (used[block] || joint.equality_count == 0 || !std::holds_alternative<JointId>(joint.owner)) return -1;
    if (joint.side_count > 2) {
      if (problem.empty())
        problem = name(block) + " has more than two bodies, but in a tree each joins a body to its parent";
      return -1;
    }
    const int a = rows.sides()[joint.first_side].body, b = rows.sides()[joint.first_side + 1].body;
    return a == body ? b : a;
  };
  std::vector<int> reached;
  const auto grow = [&](int root) {
    reached.assign(1, root);
    for (std::size_t at = 0; at < reached.size(); ++at) {
      const int body = reached[at];
      for (int s : rows.sides_of(body)) {
        const int block = rows.sides()[s].block, other = other_end(block, body);
        if (other < 0) continue;
        used[block] = 1;
        if (!world.moves({other})) continue;
        if (branch_of[other] < 0) {
          branch_of[other] = static_cast<int>(branches.size());
          branches.push_back({other, body, {block}});
          reached.push_back(other);
        } else if (branches[branch_of[other]].parent == body && !branches[branch_of[other]].blocks.empty()) {
          branches[branch_of[other]].blocks.push_back(block);
        } else if (problem.empty()) {
          problem = name(block) + " closes a loop, which a tree has not";
        }
      }
    }
  };
  for (int b = 0; b < bodies; ++b)
    if (!world.moves({b})) grow(b);
  for (int b = 0; b < bodies; ++b) {
    if (!world.moves({b}) || branch_of[b] >= 0) continue;
    branch_of[b] = static_cast<int>(branches.size());
    branches.push_back({b, 0, {}});
    grow(b);
  }
}

std::string tree_problem(const World& world, const Rows& rows) {
  const auto names = [&](JointId joint, const std::string& what) {
    return "joint " + world.name(joint) + " has " + what;
  };
  for (const Rows::JointRows& block : rows.joints()) {
    const JointId* joint = std::get_if<JointId>(&block.owner);
    if (!joint || block.row_count == 0) continue;
    if (world.compliance(*joint)) return names(*joint, "a compliance");
    if (const auto swing = swing_properties(world, *joint); swing && swing->bends)
      return names(*joint, "a spring on its swing");
    for (int k = 0; k < world.axis_count(*joint); ++k)
      if (const char* unknown = unknown_force(world.axis_properties({*joint, k})))
        return names(*joint, std::string(unknown) + " on its axis " + world.axis_info({*joint, k}).name);
  }
  return JointTree(world, rows).problem;
}

}  // namespace taut
