#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>

#include "core/base/union_find.h"
#include "core/merging/merged_world.h"

// Which bodies can be merged.
namespace taut {
namespace {

class Grouping {
 public:
  Grouping(const World& world, double tolerance) : world_(world), tolerance_(tolerance) {
    for (const auto& [joint, limits] : world.breakable()) breakable_.push_back(joint.index);
    for (int j = 0; j < world.joint_count(); ++j)
      if (is_weld(JointId{j})) welds_.push_back(JointId{j});
  }

  std::vector<MergedGroup> groups() {
    find_components();
    for (std::vector<JointId>& welds : welds_of_component_)
      if (auto group = group_of(welds)) groups_.push_back(std::move(*group));
    while (drop_groups_in_conflict())
      ;
    return std::move(groups_);
  }

 private:
  bool is_weld(JointId id) const {
    if (!world_.is_attached(id) || can_break(id) || !closes(world_.joint(id))) return false;
    const auto compliance = world_.compliance(id);
    return !compliance || (compliance->translation == 0 && compliance->rotation == 0);
  }
  /// Rigid, and with arms that leave less than the tolerance to round-off.
  bool closes(const Joint& joint) const {
    constexpr double kWeldRoundOff = 8 * std::numeric_limits<double>::epsilon();
    const std::optional<Pose> X_AB = joint.rigid_pose();
    if (!X_AB) return false;
    const Vec3 p_BQ = joint.reaction_point_B();
    return kWeldRoundOff * (p_BQ.norm() + X_AB->point(p_BQ).norm()) <= tolerance_;
  }
  bool can_break(JointId id) const {
    return std::binary_search(breakable_.begin(), breakable_.end(), id.index);
  }

  /// Moving bodies that welds connect, not by way of fixed ones; with their welds in ascending order.
  void find_components() {
    UnionFind connected;
    connected.reset(world_.body_count());
    for (JointId weld : welds_) {
      const Joint& joint = world_.joint(weld);
      if (world_.is_fixed(joint.a()) || world_.is_fixed(joint.b())) continue;
      connected.join(joint.a().index, joint.b().index);
    }
    std::vector<int> component(world_.body_count(), -1);
    for (JointId weld : welds_) {
      const Joint& joint = world_.joint(weld);
      int& c = component[connected.find(world_.is_fixed(joint.a()) ? joint.b().index : joint.a().index)];
      if (c < 0) {
        c = static_cast<int>(welds_of_component_.size());
        welds_of_component_.emplace_back();
      }
      welds_of_component_[c].push_back(weld);
    }
  }

  /// A spanning tree from the fixed body, or from the first one; nothing if the welds do not fit.
  std::optional<MergedGroup> group_of(const std::vector<JointId>& welds) {
    BodyId root{world_.body_count()};
    std::optional<BodyId> anchor;
    for (JointId weld : welds)
      for (BodyId body : world_.joint(weld).bodies()) {
        if (!world_.is_fixed(body)) {
          root = std::min(root, body);
        } else {
          if (anchor && *anchor != body) return {};
          anchor = body;
        }
      }
    MergedGroup group;
    group.fixed = anchor.has_value();
    group.carrier = anchor.value_or(root);
    if (!grow(group, welds)) return {};
    return group;
  }

  bool grow(MergedGroup& group, const std::vector<JointId>& welds) {
    std::map<int, std::vector<JointId>> welds_of_body;
    for (JointId weld : welds)
      for (BodyId body : world_.joint(weld).bodies()) welds_of_body[body.index].push_back(weld);
    std::map<int, Pose> X{{group.carrier.index, Pose{}}};  // in axes of the root
    std::vector<BodyId> queue{group.carrier};
    if (!group.fixed) group.members.push_back(group.carrier), group.welds.push_back({});
    for (std::size_t i = 0; i < queue.size(); ++i) {
      const BodyId body = queue[i];
      for (JointId weld : welds_of_body[body.index]) {
        const Joint& joint = world_.joint(weld);
        const Pose X_AB = *joint.rigid_pose();
        const bool from_A = joint.a() == body;
        const BodyId other = from_A ? joint.b() : joint.a();
        const Pose step = from_A ? X_AB : Pose{X_AB.q.conjugate(), X_AB.local(Vec3::Zero())};
        const Pose place = X.at(body.index) * step;
        const auto [found, is_new] = X.emplace(other.index, place);
        if (is_new) {
          queue.push_back(other), group.members.push_back(other), group.welds.push_back(weld);
          continue;
        }
        const double turn = 2 * (found->second.q.conjugate() * place.q).vec().norm();
        if (!((found->second.p - place.p).norm() <= tolerance_ && turn <= tolerance_)) return false;
      }
    }
    const std::set<JointId> tree(group.welds.begin(), group.welds.end());
    for (JointId weld : welds)
      if (!tree.contains(weld)) group.loops.push_back(weld);
    return true;
  }

  /// Of each body: its group, −1 for none, and the body that carries it.
  struct Places {
    std::vector<int> group, carrier;
  };
  Places places() const {
    Places places{std::vector<int>(world_.body_count(), -1), std::vector<int>(world_.body_count())};
    std::iota(places.carrier.begin(), places.carrier.end(), 0);
    for (std::size_t g = 0; g < groups_.size(); ++g)
      for (BodyId member : groups_[g].members) {
        places.group[member.index] = static_cast<int>(g);
        places.carrier[member.index] = groups_[g].carrier.index;
      }
    return places;
  }

  /// Adds the groups that a joint which is not merged away does not allow.
  void note_conflict(JointId id, const Places& at, std::set<int>& in_conflict) const {
    std::map<int, int> groups;  // and how many of the bodies they have
    std::set<int> carriers;
    bool all_fixed = true;
    for (BodyId body : world_.joint(id).bodies()) {
      const int carrier = at.carrier[body.index];
      carriers.insert(carrier);
      all_fixed = all_fixed && world_.is_fixed(BodyId{carrier});
      if (at.group[body.index] >= 0) ++groups[at.group[body.index]];
    }
    const bool idle = all_fixed || carriers.size() == 1;
    for (const auto& [group, bodies] : groups)
      if (idle || (bodies > 1 && can_break(id))) in_conflict.insert(group);
  }

  /// False if there was none.
  bool drop_groups_in_conflict() {
    std::set<JointId> merged;
    for (const MergedGroup& group : groups_) {
      merged.insert(group.welds.begin(), group.welds.end());
      merged.insert(group.loops.begin(), group.loops.end());
    }
    const Places at = places();
    std::set<int> in_conflict;
    for (int j = 0; j < world_.joint_count(); ++j)
      if (world_.is_attached(JointId{j}) && !merged.contains(JointId{j}))
        note_conflict(JointId{j}, at, in_conflict);
    for (auto g = in_conflict.rbegin(); g != in_conflict.rend(); ++g) groups_.erase(groups_.begin() + *g);
    return !in_conflict.empty();
  }

  const World& world_;
  double tolerance_;
  std::vector<int> breakable_;
  std::vector<JointId> welds_;
  std::vector<std::vector<JointId>> welds_of_component_;
  std::vector<MergedGroup> groups_;
};

}  // namespace

std::vector<MergedGroup> merged_groups(const World& world, double tolerance) {
  return Grouping(world, tolerance).groups();
}

}  // namespace taut
