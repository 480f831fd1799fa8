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
  const char* bounded = nullptr;
  p.each([&]<typename Property>(const Property&) {
    if constexpr (BoundedAxisProperty<Property>) bounded = Property::kFacts.phrase;
  });
  return bounded;
}

/// Grows the branches of a tree, breadth first.
class TreeGrowth {
 public:
  TreeGrowth(const World& world, const Rows& rows, JointTree& tree)
      : world_(world),
        rows_(rows),
        tree_(tree),
        branch_of_(rows.body_count(), -1),
        used_(rows.joints().size(), 0) {}

  bool is_reached(int body) const { return branch_of_[body] >= 0; }
  /// A body that hangs on nothing.
  void plant(int body) { add({body, 0, {}}); }
  /// All that hangs on a body.
  void grow(int root) {
    std::vector<int> reached{root};
    for (std::size_t at = 0; at < reached.size(); ++at)
      for (int s : rows_.sides_of(reached[at])) {
        const int block = rows_.sides()[s].block, other = other_end(block, reached[at]);
        if (other < 0) continue;
        used_[block] = 1;
        if (world_.moves({other}) && !is_reached(other)) reached.push_back(other);
        if (world_.moves({other})) join(reached[at], other, block);
      }
  }

 private:
  void add(JointTree::Branch branch) {
    branch_of_[branch.body] = static_cast<int>(tree_.branches.size());
    tree_.branches.push_back(std::move(branch));
  }
  void join(int parent, int child, int block) {
    if (!is_reached(child)) return add({child, parent, {block}});
    JointTree::Branch& branch = tree_.branches[branch_of_[child]];
    if (branch.parent == parent && !branch.blocks.empty())
      branch.blocks.push_back(block);
    else
      complain(block, " closes a loop, which a tree has not");
  }
  /// The other body of a block that holds something and has not been used, or −1.
  int other_end(int block, int body) {
    const Rows::JointRows& joint = rows_.joints()[block];
    if (used_[block] || joint.equality_count == 0 || !std::holds_alternative<JointId>(joint.owner)) return -1;
    if (joint.side_count > 2) {
      complain(block, " has more than two bodies, but in a tree each joins a body to its parent");
      return -1;
    }
    const int a = rows_.sides()[joint.first_side].body, b = rows_.sides()[joint.first_side + 1].body;
    return a == body ? b : a;
  }
  void complain(int block, const char* what) {
    if (tree_.problem.empty())
      tree_.problem = "joint " + world_.name(std::get<JointId>(rows_.joints()[block].owner)) + what;
  }

  const World& world_;
  const Rows& rows_;
  JointTree& tree_;
  std::vector<int> branch_of_;  // of a moving body that is reached; else −1
  std::vector<char> used_;      // blocks
};

}  // namespace

JointTree::JointTree(const World& world, const Rows& rows) {
  TreeGrowth growth(world, rows, *this);
  for (int b = 0; b < rows.body_count(); ++b)
    if (!world.moves({b})) growth.grow(b);
  for (int b = 0; b < rows.body_count(); ++b) {
    if (!world.moves({b}) || growth.is_reached(b)) continue;
    growth.plant(b);
    growth.grow(b);
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
    if (const auto swing = swing_properties(world, *joint); swing && swing->has_spring)
      return names(*joint, "a spring on its swing");
    for (int k = 0; k < world.axis_count(*joint); ++k)
      if (const char* unknown = unknown_force(world.axis_properties({*joint, k})))
        return names(*joint, std::string(unknown) + " on its axis " + world.axis_info({*joint, k}).name);
  }
  return JointTree(world, rows).problem;
}

}  // namespace taut
