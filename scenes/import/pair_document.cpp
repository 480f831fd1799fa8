#include "scenes/import/rigid_groups.h"
#include "scenes/import/scene_document.h"

// Who may touch whom, beyond what a scene says by itself: bodies with a common joint do not touch, others do.
namespace taut::model {
namespace {

using PairRules = std::map<std::pair<int, int>, bool>;

/// The link that stands for all that are fixed to each other; the world for what never moves.
int group_of(const RobotModel& model, int link) {
  if (stands_still(model, link)) return kWorld;
  while (!model.links[link].free && model.links[link].axes.empty()) link = model.links[link].parent;
  return link;
}

}  // namespace

bool SceneDocument::has_shapes(int link) const {
  return !(link == kWorld ? model_.ground_shapes : model_.links[link].shapes).empty();
}

bool SceneDocument::joined_directly(int a, int b) const {
  const auto joins = [&](int child, int parent) {
    return child != kWorld && model_.links[child].parent == parent && !model_.links[child].free &&
           segments_[child].size() <= 1;
  };
  return joins(a, b) || joins(b, a);
}

/// Links that are fixed to each other, and those next to each other, do not touch, the world apart.
void SceneDocument::forbid_neighbours(PairRules& rules) const {
  std::map<int, std::vector<int>> members;
  for (int i = 0; i < static_cast<int>(model_.links.size()); ++i)
    if (has_shapes(i)) members[group_of(model_, i)].push_back(i);
  const auto forbid = [&](int a, int b) {
    if (a != b && !joined_directly(a, b)) rules[std::minmax(a, b)] = false;
  };
  for (const auto& [group, links] : members) {
    if (group == kWorld) continue;
    const int next = model_.links[group].free ? group : group_of(model_, model_.links[group].parent);
    for (int a : links) {
      for (int b : links) forbid(a, b);
      if (next == kWorld || next == group || !members.contains(next)) continue;
      for (int b : members[next]) forbid(a, b);
    }
  }
}

/// Two links with shapes, of which one moves, and that are not next to each other.
bool SceneDocument::may_meet(int a, int b) const {
  const bool moves = !stands_still(model_, a) || !stands_still(model_, b);
  return moves && has_shapes(a) && has_shapes(b) && !joined_directly(a, b);
}

/// Two that a weld holds have nothing to push apart, and could not.
void SceneDocument::allow_joined(PairRules& rules) {
  for (int i = 0; i < static_cast<int>(model_.links.size()); ++i) {
    const Link& link = model_.links[i];
    if (link.free || stands_still(model_, i) || segments_[i].size() > 1 || !stands_still(model_, link.parent))
      continue;
    if (has_shapes(i) && has_shapes(link.parent)) rules[std::minmax(i, link.parent)] = true;
  }
  for (const Loop& loop : model_.loops) {
    if (!may_meet(loop.a.link, loop.b.link)) continue;
    if (loop.fixed && loop.active)
      note(loop.place, "\"" + body(loop.a.link) + "\" and \"" + body(loop.b.link) +
                           "\" are welded: they do not touch each other");
    else
      rules.try_emplace(std::minmax(loop.a.link, loop.b.link), true);
  }
}

void SceneDocument::write_pairs(SceneJson& document) {
  PairRules rules;
  forbid_neighbours(rules);
  if (model_.joined_touch) allow_joined(rules);
  for (const LinkPair& pair : model_.pairs) rules[std::minmax(pair.a, pair.b)] = pair.collide;
  for (const auto& [pair, collide] : rules)
    if (pair.first != pair.second)
      document["pairs"].push_back({{"a", body(pair.first)}, {"b", body(pair.second)}, {"collide", collide}});
}

}  // namespace taut::model
