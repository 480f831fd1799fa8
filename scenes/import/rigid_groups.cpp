#include "scenes/import/rigid_groups.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <sstream>

#include "core/math/dense.h"
#include "scenes/import/link_inertia.h"

namespace taut::model {
namespace {

bool is_fixed(const Link& link) { return !link.free && link.axes.empty(); }

/// The link nearest to the world that this one is fixed to.
int root_of(const RobotModel& model, int link) {
  while (is_fixed(model.links[link]) && model.links[link].parent != kWorld) link = model.links[link].parent;
  return link;
}

class Fusion {
 public:
  explicit Fusion(RobotModel& model) : model_(model), into_(model.links.size()) {
    for (int i = 0; i < static_cast<int>(into_.size()); ++i) into_[i] = i;
  }

  void run() {
    std::map<int, std::vector<int>> groups;
    for (int i = 0; i < static_cast<int>(into_.size()); ++i)
      if (const int root = root_of(model_, i); !is_fixed(model_.links[root])) groups[root].push_back(i);
    for (const auto& [root, members] : groups) {
      balance(root, members);
      choose(root, members);
    }
    if (!problems_.empty()) throw ImportError(in_order(std::move(problems_)));
    for (const auto& [root, members] : groups) move_joint(root, members);
    for (int i = 0; i < static_cast<int>(into_.size()); ++i)
      if (into_[i] != i) fuse(i, into_[i]);
    redirect();
    remove();
  }

 private:
  /// Where links that move together are no body even as one, each that is none by itself gets the mean of its
  /// principal moments as each of them, as with MuJoCo's balanceinertia; negative ones are of nothing.
  void balance(int root, const std::vector<int>& members) {
    if (model_.refuses_wrong_inertia || is_solid(inertia_seen_from(root, members))) return;
    constexpr double kRoundOff = 1e-9;  // of what was a rod
    for (int i : members) {
      Link& link = model_.links[i];
      const Vec3 moments = dense::symmetric_eigenvalues3(link.inertia.inertia);
      const LinkInertia round{link.inertia.mass, link.inertia.centre, moments.mean() * Mat3::Identity()};
      if (is_solid(link.inertia) || !is_solid(round) || moments[0] < -kRoundOff * moments[2]) continue;
      link.inertia = round;
      std::ostringstream message;
      message.precision(6);
      message << "the principal moments of inertia of \"" << link.name
              << "\" are those of no body (value: " << moments[0] << ' ' << moments[1] << ' ' << moments[2]
              << " kg m²): each becomes their mean, " << moments.mean() << " kg m²";
      model_.notices.push_back({link.place, message.str(), 1});
    }
  }

  /// Which member each of them is to become a part of.
  void choose(int root, const std::vector<int>& members) {
    if (!require_solid(root, members)) return;
    int first_solid = -1;
    for (int i : members)
      if (first_solid < 0 && is_solid(model_.links[i].inertia)) first_solid = i;
    for (int i : members) {
      if (is_solid(model_.links[i].inertia)) continue;
      int target = i;
      while (target != root && !is_solid(model_.links[target].inertia)) target = model_.links[target].parent;
      if (!is_solid(model_.links[target].inertia)) target = first_solid < 0 ? root : first_solid;
      into_[i] = target;
    }
    for (int i : members)
      if (into_[i] == i && !is_solid(inertia_with_parts(i, members))) {  // only all together are a body
        for (int member : members) into_[member] = root;
        return;
      }
  }

  LinkInertia inertia_with_parts(int whole, const std::vector<int>& members) const {
    std::vector<int> parts;
    std::ranges::copy_if(members, std::back_inserter(parts), [&](int i) { return into_[i] == whole; });
    return inertia_seen_from(whole, parts);
  }
  /// Of all of them as one, in the axes of a link.
  LinkInertia inertia_seen_from(int link, const std::vector<int>& members) const {
    const Pose X_LW = inverse(model_.links[link].X_WL);
    LinkInertia all;
    for (int i : members) all = sum(all, in_frame(X_LW * model_.links[i].X_WL, model_.links[i].inertia));
    return all;
  }

  /// Whether the group is a body; if not, why is among the problems.
  bool require_solid(int root, const std::vector<int>& members) {
    const Link& link = model_.links[root];
    for (int i : members)
      if (!model_.links[i].unknown_mass.empty()) {
        problems_.push_back({model_.links[i].place, model_.links[i].unknown_mass, 1});
        return false;
      }
    const LinkInertia all = inertia_seen_from(root, members);
    if (is_solid(all)) return true;
    std::ostringstream message;
    message.precision(6);
    message << "\"" << link.name << "\" moves, and ";
    if (!(all.mass > 0))
      message << "has no mass (value: " << all.mass << " kg)";
    else
      message << "its inertia is that of no body: positive principal moments, none larger than the sum of "
                 "the others"
              << " (value: " << dense::symmetric_eigenvalues3(all.inertia).transpose() << " kg m²)"
              << (model_.refuses_wrong_inertia ? "; balanceinertia=\"true\" of <compiler> makes it one" : "");
    problems_.push_back({link.place, message.str(), 1});
    return false;
  }

  /// Where the root of a group goes into a member, the member takes over what joins the group to its parent.
  void move_joint(int root, const std::vector<int>& members) {
    const int target = into_[root];
    if (target == root || members.empty()) return;
    Link &from = model_.links[root], &to = model_.links[target];
    const Pose X_TR = inverse(to.X_WL) * from.X_WL;
    to.axes = std::move(from.axes);
    from.axes.clear();
    for (LinkAxis& axis : to.axes)
      axis.anchor = X_TR.point(axis.anchor), axis.axis = X_TR.q * axis.axis, axis.spin = X_TR.q * axis.spin;
    to.free_twist = {from.free_twist.w, from.free_twist.at(to.X_WL.p - from.X_WL.p)};
    to.parent = from.parent;
    to.free = from.free;
    to.joint_name = from.joint_name;
  }

  void fuse(int part, int whole) {
    Link &from = model_.links[part], &to = model_.links[whole];
    const Pose X = inverse(to.X_WL) * from.X_WL;
    to.inertia = sum(to.inertia, in_frame(X, from.inertia));
    for (LinkShape& shape : from.shapes) {
      shape.X_LS = X * shape.X_LS;
      to.shapes.push_back(std::move(shape));
    }
    model_.notices.push_back(
        {from.place,
         "\"" + from.name + "\" has no mass and inertia of a body: it is part of \"" + to.name + "\"", 1});
  }

  /// What named a link that is a part now names the whole.
  void redirect() {
    for (int i = 0; i < static_cast<int>(into_.size()); ++i) {
      int& parent = model_.links[i].parent;
      if (parent != kWorld && into_[parent] != i) parent = into_[parent];
    }
    const auto frame = [&](LinkFrame& f) {
      if (f.link == kWorld || into_[f.link] == f.link) return;
      f.X_LF = inverse(model_.links[into_[f.link]].X_WL) * model_.links[f.link].X_WL * f.X_LF;
      f.link = into_[f.link];
    };
    for (Loop& loop : model_.loops) frame(loop.a), frame(loop.b);
    for (Wire& wire : model_.wires)
      for (LinkFrame& point : wire.points) frame(point);
    for (ModelProbe& probe : model_.probes) frame(probe.at);
    for_each_index([&](int& link) { link = link == kWorld ? kWorld : into_[link]; });
  }

  template <typename Function>
  void for_each_index(Function function) {
    for (AxisRelation& relation : model_.relations) {
      function(relation.driven.link);
      if (relation.driving) function(relation.driving->link);
      if (relation.other) function(relation.other->link);
    }
    for (ModelProbe& probe : model_.probes)
      if (probe.axis) function(probe.axis->link);
    for (LinkPair& pair : model_.pairs) function(pair.a), function(pair.b);
  }

  void remove() {
    std::vector<int> now(into_.size(), kWorld);
    std::vector<Link> kept;
    for (std::size_t i = 0; i < into_.size(); ++i) {
      if (into_[i] != static_cast<int>(i)) continue;
      now[i] = static_cast<int>(kept.size());
      kept.push_back(std::move(model_.links[i]));
    }
    const auto index = [&](int& link) { link = link == kWorld ? kWorld : now[link]; };
    for (Link& link : kept) index(link.parent);
    model_.links = std::move(kept);
    for (Loop& loop : model_.loops) index(loop.a.link), index(loop.b.link);
    for (Wire& wire : model_.wires)
      for (LinkFrame& point : wire.points) index(point.link);
    for (ModelProbe& probe : model_.probes) index(probe.at.link);
    for_each_index(index);
  }

  RobotModel& model_;
  std::vector<int> into_;  // by link: what it becomes a part of; itself: it stays
  std::vector<ImportNotice> problems_;
};

}  // namespace

void fuse_links_without_mass(RobotModel& model) { Fusion(model).run(); }

bool stands_still(const RobotModel& model, int link) {
  return link == kWorld || is_fixed(model.links[root_of(model, link)]);
}

}  // namespace taut::model
