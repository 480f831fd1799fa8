#include "solvers/diagnosis/contradiction.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <utility>
#include <variant>

#include "solvers/diagnosis/violation_search.h"
#include "solvers/laws/axes/axis_motor_law.h"
#include "solvers/laws/contact_cache.h"

namespace taut {
namespace {

using Bound = Contradiction::Bound;
using Touch = Contradiction::Touch;
using Verdict = ViolationSearch::Verdict;

struct ContradictionTuning {
  /// Members with less than this part of the largest blame do not belong to the contradiction; and the same
  /// where that has left out too many.  Chosen.
  static constexpr double kBlamed = 1e-4, kHardlyBlamed = 1e-9;
  /// Sets of more members are not made smaller: each trial is a search of its own.  Chosen.
  static constexpr std::size_t kMinimalSetLimit = 200;
};

/// Whoever can be left out: a pair of bodies, what holds an axis, or a joint with its equalities.
using Member = std::variant<Touch, Bound, JointId>;

using Slots = std::vector<ContactCache::Slot>;

Touch touch_of(const Situation& s, const Contact& contact) {
  const World& world = s.named ? *s.named : s.world;
  const BodyId a = world.shape(contact.a).body, b = world.shape(contact.b).body;
  return {std::min(a, b), std::max(a, b)};
}

Slots find_contacts(const Situation& s) {
  Slots slots;
  if (!s.bounds || s.contact_margin <= 0) return slots;
  ContactCache set(s.world, {.margin = s.contact_margin});
  if (set.empty()) return slots;
  set.find(s.world, s.from, s.horizon);
  std::copy_if(set.slots().begin(), set.slots().end(), std::back_inserter(slots),
               [](const auto& slot) { return slot.active && slot.material.compliance == 0; });
  return slots;
}

/// Demands with their members, as a ViolationSearch takes them.
class Demands {
 public:
  Demands(const Situation& situation, const ViolationSearch& search, const Slots& slots)
      : situation_(situation), x_(search.rows().row_count()) {
    search.values(situation.from, x_);
    for (int j = 0; j < situation.world.joint_count(); ++j) add_joint(search.rows(), {j});
    if (!situation.bounds) return;
    for (const Rows::AxisRow& row : search.rows().axis_rows())
      if (const AxisId* axis = row.axis(); axis && !is_gone(axis->joint)) add_axis(*axis, row.row);
    for (std::size_t k = 0; k < slots.size(); ++k)
      add_contact(touch_of(situation, slots[k].contact), search.contact_row(static_cast<int>(k)));
  }
  std::vector<Demand> demands;
  std::vector<Member> members;

 private:
  bool is_gone(JointId joint) const {
    return std::find(situation_.gone.begin(), situation_.gone.end(), joint) != situation_.gone.end();
  }
  void add_joint(const Rows& rows, JointId joint) {
    if (is_gone(joint)) return;
    const Rows::JointRows& place = rows.joints()[joint.index];
    for (int r = place.first_row; r < place.first_row + place.equality_count; ++r)
      if (rows.is_equality(r)) add(joint, r, 0, 0);
  }
  void add_axis(AxisId axis, int row) {
    const AxisProperties& p = situation_.world.axis_properties(axis);
    double lower = -kUnlimited, upper = kUnlimited;
    if (p.limits && p.limits->compliance == 0) {
      lower = p.limits->lower, upper = p.limits->upper;
      if (lower > -kUnlimited) add(Bound{axis, Bound::Kind::kLowerLimit}, row, lower, kUnlimited);
      if (upper < kUnlimited) add(Bound{axis, Bound::Kind::kUpperLimit}, row, -kUnlimited, upper);
    }
    if (!p.motor || !is_unbounded(*p.motor)) return;
    if (p.motor->pulls_only) {
      const double longest = std::max(lower, target(*p.motor, let_out(axis)));
      if (std::isfinite(longest)) add(Bound{axis, Bound::Kind::kMotor}, row, -kUnlimited, longest);
      return;
    }
    // A motor of any force stops at a limit.
    const double aim = std::clamp(target(*p.motor, x_[row]), lower, upper);
    if (std::isfinite(aim)) add(Bound{axis, Bound::Kind::kMotor}, row, aim, aim);
  }
  double let_out(AxisId axis) const { return situation_.from.axes[situation_.world.axis_index(axis)]; }
  /// Where a motor wants its axis to be, coming from θ.
  double target(const AxisMotor& motor, double theta) const {
    const double h = situation_.horizon;
    if (motor.mode == AxisMotor::Mode::kVelocity) return theta + h * motor.target;
    const bool follows = motor.mode == AxisMotor::Mode::kTrajectory;
    const double aim = follows ? motor.trajectory(situation_.from.time + h).value : motor.target;
    const double reach = std::isinf(motor.max_speed) ? kUnlimited : h * motor.max_speed;
    return theta + std::clamp(aim - theta, -reach, reach);
  }
  void add(const Member& member, int row, double lower, double upper) {
    if (members.empty() || !(members.back() == member)) members.push_back(member);
    demands.push_back({row, static_cast<int>(members.size()) - 1, lower, upper});
  }
  void add_contact(const Touch& touch, int row) {
    const auto [entry, fresh] = member_of_pair_.try_emplace({touch.a, touch.b}, members.size());
    if (fresh) members.push_back(touch);
    // What has sunk in must not sink deeper.
    demands.push_back({row, static_cast<int>(entry->second), std::min(0.0, x_[row]), kUnlimited});
  }

  const Situation& situation_;
  std::vector<double> x_;
  std::map<std::pair<BodyId, BodyId>, std::size_t> member_of_pair_;
};

/// The members to blame, the largest first.
std::vector<Member> blamed(const std::vector<Member>& members, std::span<const double> blame, double part) {
  const double largest = *std::max_element(blame.begin(), blame.end());
  std::vector<std::size_t> order;
  for (std::size_t m = 0; m < members.size(); ++m)
    if (blame[m] > part * largest) order.push_back(m);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return blame[a] > blame[b]; });
  std::vector<Member> found;
  for (std::size_t m : order) found.push_back(members[m]);
  return found;
}

/// A world that has but some members' joints, and a search in it with any of these members.
class LocalSearch {
 public:
  LocalSearch(const Situation& s, const Slots& slots, std::span<const Member> members)
      : world_(s.world), slots_(slots) {
    reduce(s, members);
    search_.emplace(world_, slots_);
    Demands local(s, *search_, slots_);
    members_ = std::move(local.members);
    search_->begin(std::move(local.demands), static_cast<int>(members_.size()), s.from,
                   s.from.time + s.horizon);
  }
  Verdict search(std::span<const Member> wanted) {
    mask_.assign(members_.size(), 0);
    for (std::size_t m = 0; m < members_.size(); ++m)
      mask_[m] = std::find(wanted.begin(), wanted.end(), members_[m]) != wanted.end();
    return search_->search(mask_);
  }
  std::vector<Member> blamed_left() {
    return blamed(members_, search_->blame(), ContradictionTuning::kBlamed);
  }
  double largest() const { return search_->largest(); }

 private:
  void reduce(const Situation& s, std::span<const Member> members) {
    std::vector<JointId> joints;
    for (const Member& member : members) {
      if (const auto* joint = std::get_if<JointId>(&member)) joints.push_back(*joint);
      if (const auto* bound = std::get_if<Bound>(&member)) joints.push_back(bound->axis.joint);
    }
    world_.detach_all_but(joints);
    std::erase_if(slots_, [&](const ContactCache::Slot& slot) {
      const Member touch = touch_of(s, slot.contact);
      return std::find(members.begin(), members.end(), touch) == members.end();
    });
  }

  World world_;
  Slots slots_;
  std::optional<ViolationSearch> search_;
  std::vector<Member> members_;
  std::vector<char> mask_;
};

/// Deletion filter [Chinneck2008]: whoever is not needed for the contradiction goes, the least involved
/// first. What the certificate of the others does without goes with it.
void make_minimal(LocalSearch& local, std::vector<Member>& set) {
  for (std::size_t k = set.size(); k-- > 0;) {
    std::vector<Member> rest = set;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(k));
    if (rest.empty() || local.search(rest) != Verdict::kExcluded) continue;
    const std::vector<Member> involved = local.blamed_left();
    set.swap(rest);
    std::vector<Member> smaller;
    for (std::size_t i = 0; i < set.size(); ++i)  // those behind k are known to be needed
      if (i >= k || std::find(involved.begin(), involved.end(), set[i]) != involved.end())
        smaller.push_back(set[i]);
    if (smaller.size() == set.size() || local.search(smaller) != Verdict::kExcluded) continue;
    k -= set.size() - smaller.size();
    set.swap(smaller);
  }
}

/// The blame of many members hardly differs; their place in the world says more.
void sort_as_in_world(std::vector<Member>& members) {
  using Key = std::tuple<std::size_t, int, int, Bound::Kind>;
  const auto key = [](const Member& m) -> Key {
    if (const auto* touch = std::get_if<Touch>(&m)) return {m.index(), touch->a.index, touch->b.index, {}};
    if (const auto* joint = std::get_if<JointId>(&m)) return {m.index(), joint->index, 0, {}};
    const auto& [axis, kind] = std::get<Bound>(m);
    return {m.index(), axis.joint.index, axis.axis, kind};
  };
  std::sort(members.begin(), members.end(),
            [&](const Member& first, const Member& second) { return key(first) < key(second); });
}

Contradiction made_of(const std::vector<Member>& members, double residual) {
  Contradiction found{.joints = {}, .bounds = {}, .contacts = {}, .residual = residual};
  for (const Member& member : members) {
    if (const auto* touch = std::get_if<Touch>(&member)) found.contacts.push_back(*touch);
    if (const auto* bound = std::get_if<Bound>(&member)) found.bounds.push_back(*bound);
    if (const auto* joint = std::get_if<JointId>(&member)) found.joints.push_back(*joint);
  }
  return found;
}

}  // namespace

Contradiction find_contradiction(const Situation& s) {
  const Slots slots = find_contacts(s);
  ViolationSearch whole(s.world, slots);
  Demands all(s, whole, slots);
  const std::size_t count = all.members.size();
  if (count == 0) return {};
  whole.begin(std::move(all.demands), static_cast<int>(count), s.from, s.from.time + s.horizon);
  if (whole.search(std::vector<char>(count, 1)) != Verdict::kExcluded) return {};
  for (double part : {ContradictionTuning::kBlamed, ContradictionTuning::kHardlyBlamed}) {
    std::vector<Member> set = blamed(all.members, whole.blame(), part);
    LocalSearch local(s, slots, set);
    if (local.search(set) != Verdict::kExcluded) continue;
    if (set.size() > ContradictionTuning::kMinimalSetLimit) {
      sort_as_in_world(set);
      return made_of(set, local.largest());
    }
    make_minimal(local, set);
    (void)local.search(set);
    return made_of(set, local.largest());
  }
  return {};
}

}  // namespace taut
