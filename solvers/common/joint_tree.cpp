#include "solvers/common/joint_tree.h"

#include <algorithm>
#include <set>
#include <utility>

#include "core/base/union_find.h"
#include "core/world/swing_properties.h"

namespace taut {
namespace {

/// What of an axis has a force that follows neither from the state nor from laws of rows alone; null:
/// nothing.
const char* unknown_force(const AxisProperties& p, bool is_swing) {
  if (p.motor && p.motor->pulls_only) return "a winch, whose rope is remembered,";
  if (p.motor && !p.motor->has_gains() && p.motor->mode != AxisMotor::Mode::kVelocity)
    return "a motor that brakes at its target, without stiffness or damping,";
  if (p.friction && p.friction->per_load > 0) return "friction that grows with the load";
  if (is_swing && p.friction && p.friction->static_friction > 0)
    return "friction of a swing, which has no direction at 0,";
  const char* bounded = nullptr;
  p.each([&]<typename Property>(const Property&) {
    if constexpr (BoundedAxisProperty<Property>) bounded = Property::kFacts.phrase;
  });
  return bounded;
}

/// A joint, with rows that hold.
bool holds(const Rows::JointRows& block) {
  return block.equality_count > 0 && std::holds_alternative<JointId>(block.owner);
}

/// Which blocks are edges of the forest: of those in a loop the ones with most rows, then the first, all that
/// do not move as one.  What joins the same two bodies as an edge is one, too.
std::vector<char> choose_edges(const World& world, const Rows& rows) {
  struct Edge {
    int block, rows, a, b;
  };
  std::vector<Edge> edges;
  for (int k = 0; k < std::ssize(rows.joints()); ++k) {
    const Rows::JointRows& joint = rows.joints()[k];
    if (!holds(joint) || joint.side_count != 2) continue;
    const int a = rows.sides()[joint.first_side].body, b = rows.sides()[joint.first_side + 1].body;
    edges.push_back({k, joint.equality_count, std::min(a, b), std::max(a, b)});
  }
  std::vector<Edge> by_rows = edges;
  std::stable_sort(by_rows.begin(), by_rows.end(),
                   [](const Edge& one, const Edge& other) { return one.rows > other.rows; });
  UnionFind parts;
  parts.reset(rows.body_count());
  const auto part = [&](int body) { return parts.find(world.moves({body}) ? body : 0); };
  std::set<std::pair<int, int>> joined;
  for (const Edge& edge : by_rows) {
    const int a = part(edge.a), b = part(edge.b);
    if (a == b) continue;
    parts.join(a, b);
    joined.insert({edge.a, edge.b});
  }
  std::vector<char> chosen(rows.joints().size(), 0);
  for (const Edge& edge : edges) chosen[edge.block] = joined.contains({edge.a, edge.b});
  return chosen;
}

/// Grows the branches of a tree, breadth first.
class TreeGrowth {
 public:
  TreeGrowth(const World& world, const Rows& rows, JointTree& tree)
      : world_(world),
        rows_(rows),
        tree_(tree),
        is_edge_(choose_edges(world, rows)),
        branch_of_(rows.body_count(), -1) {}

  bool is_reached(int body) const { return branch_of_[body] >= 0; }
  /// A body that hangs on nothing.
  void plant(int body) { add({body, 0, {}}); }
  /// All that hangs on a body.
  void grow(int root) {
    std::vector<int> reached{root};
    for (std::size_t at = 0; at < reached.size(); ++at)
      for (int s : rows_.sides_of(reached[at])) {
        const int block = rows_.sides()[s].block;
        if (!is_edge_[block]) continue;
        const int other = other_end(block, reached[at]);
        if (!world_.moves({other}) || other == parent_of(reached[at])) continue;
        if (!is_reached(other)) {
          reached.push_back(other);
          add({other, reached[at], {block}});
        } else
          tree_.branches[branch_of_[other]].blocks.push_back(block);
      }
  }
  /// All that is no edge is cut.
  void cut() {
    for (int k = 0; k < std::ssize(rows_.joints()); ++k)
      if (!is_edge_[k] && holds(rows_.joints()[k])) tree_.cuts.push_back(k);
  }

 private:
  void add(JointTree::Branch branch) {
    branch_of_[branch.body] = static_cast<int>(tree_.branches.size());
    tree_.branches.push_back(std::move(branch));
  }
  int other_end(int block, int body) const {
    const Rows::Side* sides = rows_.sides().data() + rows_.joints()[block].first_side;
    return sides[0].body == body ? sides[1].body : sides[0].body;
  }
  /// Of a moving body that hangs on another; else −1.
  int parent_of(int body) const {
    if (!is_reached(body)) return -1;
    const JointTree::Branch& branch = tree_.branches[branch_of_[body]];
    return branch.blocks.empty() ? -1 : branch.parent;
  }

  const World& world_;
  const Rows& rows_;
  JointTree& tree_;
  std::vector<char> is_edge_;   // blocks
  std::vector<int> branch_of_;  // of a moving body that is reached; else −1
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
  growth.cut();
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
      if (const char* unknown = unknown_force(world.axis_properties({*joint, k}),
                                              world.axis_info({*joint, k}).across.turns[0] >= 0))
        return names(*joint, std::string(unknown) + " on its axis " + world.axis_info({*joint, k}).name);
  }
  return {};
}

}  // namespace taut
