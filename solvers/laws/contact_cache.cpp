#include "solvers/laws/contact_cache.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <tuple>

#include "core/math/so3.h"

namespace taut {
namespace {

/// Chosen, where nothing else is said.  (solvers/laws, "Contacts")
struct ContactCacheTuning {
  /// A contact is where one was before if in either body it is no further from it than this [m].
  static constexpr double kSamePoint = 1e-4;
  /// Finds after which an unused slot may be given up: other slots ask for another order of the factor.
  static constexpr int kKept = 200;
  /// Shapes that are parted are out of each other at this depth [m].
  static constexpr double kOut = 1e-6;
  /// Tangents follow the slip above this speed [m/s], and if no less than this part of it lies in the plane.
  static constexpr double kSlipSpeed = 1e-6, kInPlane = 1e-3;
  /// Worlds of more shapes than this are judged by the filters alone: pairs grow with the square.
  static constexpr int kFewShapes = 200;
  /// Shapes may overlap at the start by this part of the smaller body's radius of gyration; a spring may in
  /// addition be pressed by so many times the smaller body's weight.
  static constexpr double kOverlapPart = 0.01, kWeights = 100;
};

auto order_of(const Rows::ContactSlot& slot) { return std::tuple(slot.a, slot.b, slot.twist); }

bool agree(const CollisionFilter& a, const CollisionFilter& b) {
  return (a.groups & b.mask) != 0 && (b.groups & a.mask) != 0;
}

bool can_touch(const World& world) {
  const int count = world.shape_count();
  if (count > ContactCacheTuning::kFewShapes) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> filters;
    for (int a = 0; a < count; ++a) {
      const CollisionFilter& filter = world.shape(ShapeId{a}).filter;
      filters.insert({filter.groups, filter.mask});
    }
    for (const auto& [groups, mask] : filters)
      for (const auto& [other_groups, other_mask] : filters)
        if (agree({groups, mask}, {other_groups, other_mask})) return true;
    return false;
  }
  for (int a = 0; a < count; ++a)
    for (int b = a + 1; b < count; ++b)
      if (world.may_collide(ShapeId{a}, ShapeId{b})) return true;
  return false;
}

Rows::ContactSlot slot_for(const World& world, const Contact& contact) {
  const Material material = world.contact_material(contact.a, contact.b);
  const bool twist =
      material.rolling_friction > 0 || material.spinning_friction > 0 || resists_turning_linearly(material);
  return {contact.A.index, contact.B.index, twist};
}

/// t₁ along the slip if there is one, else where it was.
row_parts::ContactFrame frame_of(const Vec3& n, const Vec3& slip, const Vec3& last) {
  row_parts::ContactFrame frame;
  frame.n = n;
  Vec3 along = slip.norm() > ContactCacheTuning::kSlipSpeed ? slip : last;
  along -= n.dot(along) * n;
  // Written so that what is not a number, left by a step that failed, does not stay.
  if (!(along.norm() >=
        ContactCacheTuning::kInPlane * (slip.norm() > ContactCacheTuning::kSlipSpeed ? slip.norm() : 1)))
    along = n.unitOrthogonal();
  frame.t1 = along.normalized();
  frame.t2 = n.cross(frame.t1);
  return frame;
}

/// How far a contact may be pressed at the start [m].
double overlap_bound(const World& world, const Contact& contact) {
  double mass = std::numeric_limits<double>::infinity();
  for (const BodyId body : {contact.A, contact.B})
    if (world.moves(body)) mass = std::min(mass, world.mass_properties(body).mass());
  const double compliance = world.contact_material(contact.a, contact.b).compliance;
  return overlap_depth(world, contact) +
         ContactCacheTuning::kWeights * compliance * mass * world.gravity().norm();
}

}  // namespace

double overlap_depth(const World& world, const Contact& contact) {
  double size = std::numeric_limits<double>::infinity();
  for (const BodyId body : {contact.A, contact.B}) {
    if (!world.moves(body)) continue;
    const MassProperties& mass = world.mass_properties(body);
    size = std::min(size, std::sqrt(mass.principal_moments().maxCoeff() / mass.mass()));
  }
  return ContactCacheTuning::kOverlapPart * size;
}

ContactCache::ContactCache(const World& world, const ContactSettings& settings)
    : empty_(!can_touch(world)), finder_(settings) {}

std::vector<Rows::ContactSlot> ContactCache::rows() const {
  std::vector<Rows::ContactSlot> rows;
  for (const Slot& slot : slots_) rows.push_back(slot.at);
  return rows;
}

void ContactCache::undo() {
  std::copy(before_.begin(), before_.end(), slots_.begin());
  parts_ = true;
}

bool ContactCache::find(const World& world, const State& state, double horizon) {
  const std::vector<Contact>& contacts = finder_.find(world, state, horizon);
  before_ = slots_;
  contacts_before_.clear();
  for (const Slot& slot : slots_) contacts_before_.push_back(slot.contact);
  match(world, contacts);
  part_overlaps(world, contacts);
  const bool missing =
      std::any_of(slot_of_contact_.begin(), slot_of_contact_.end(), [](int slot) { return slot < 0; });
  if (missing) {
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      if (slot_of_contact_[c] >= 0) continue;
      slot_of_contact_[c] = static_cast<int>(slots_.size());
      Slot slot;
      slot.at = slot_for(world, contacts[c]);
      slot.active = true;
      slots_.push_back(slot);
      before_.push_back(slot);
      before_.back().active = false;
      origin_.push_back(-1);
      moved_.push_back(-1);
    }
  }
  for (std::size_t c = 0; c < contacts.size(); ++c)
    fill(slot_of_contact_[c], contacts[c], parted_[c], world, state);
  if (missing) rebuild();
  return missing;
}

/// Contacts that were there get their slots again: those that are the same feature at the same point first,
/// then those nearest to where one was, since features of flat faces are numbered anew by round-off, then the
/// same feature wherever it is now.  Others get free slots of the same pair; −1 where there is none.
void ContactCache::match(const World& world, const std::vector<Contact>& contacts) {
  vacate();
  slot_of_contact_.assign(contacts.size(), -1);
  for (const Likeness likeness : {Likeness::kSameFeatureAndPoint, Likeness::kNearest, Likeness::kSameFeature})
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      if (slot_of_contact_[c] >= 0) continue;
      const int found = slot_before(world, contacts[c], likeness);
      if (found < 0) continue;
      occupy(found, c);
      origin_[found] = found;
    }
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    if (slot_of_contact_[c] >= 0) continue;
    const int slot = free_slot(slot_for(world, contacts[c]));
    if (slot >= 0) occupy(slot, c);
  }
}

/// All slots are free; keys_ has those that were not, sorted by shapes and features.
void ContactCache::vacate() {
  keys_.clear();
  for (std::size_t k = 0; k < slots_.size(); ++k) {
    Slot& slot = slots_[k];
    if (slot.active) keys_.push_back({slot.contact.a, slot.contact.b, slot.contact.feature, int(k)});
    ++slot.unused;
    slot.active = false;
  }
  std::sort(keys_.begin(), keys_.end(), [](const Key& x, const Key& y) {
    return std::tie(x.a, x.b, x.feature) < std::tie(y.a, y.b, y.feature);
  });
  origin_.assign(slots_.size(), -1);
  moved_.resize(slots_.size());
  std::iota(moved_.begin(), moved_.end(), 0);
}

void ContactCache::occupy(int slot, std::size_t contact) {
  slot_of_contact_[contact] = slot;
  slots_[slot].active = true;
}

/// The free slot of a contact that was there, the nearest of those like this one; −1 for none.
int ContactCache::slot_before(const World& world, const Contact& contact, Likeness likeness) const {
  const auto at = slot_for(world, contact);
  const auto first = std::lower_bound(
      keys_.begin(), keys_.end(), contact,
      [](const Key& x, const Contact& y) { return std::tie(x.a, x.b) < std::tie(y.a, y.b); });
  double least = likeness == Likeness::kSameFeature ? std::numeric_limits<double>::infinity()
                                                    : ContactCacheTuning::kSamePoint;
  int found = -1;
  for (auto key = first; key != keys_.end() && key->a == contact.a && key->b == contact.b; ++key) {
    const Slot& slot = slots_[key->slot];
    if (slot.active || slot.at != at) continue;
    if (likeness != Likeness::kNearest && key->feature != contact.feature) continue;
    const double distance =
        std::min((slot.contact.p_AP - contact.p_AP).norm(), (slot.contact.p_BQ - contact.p_BQ).norm());
    if (distance > least) continue;
    least = distance;
    found = key->slot;
  }
  return found;
}

/// Shapes that are found in each other without having touched before, as at the start, are parted as rigid
/// ones, slowly, until they are out: a spring would throw them by 2/h of that depth, and so would those of
/// others that they are pressed into meanwhile.  The impulse that took them out is none of a spring's, so
/// that they are rigid at the find after it, too.
void ContactCache::part_overlaps(const World& world, const std::vector<Contact>& contacts) {
  parted_.assign(contacts.size(), 0);
  parting_.assign(world.body_count(), 0);
  const auto same_pair = [](const auto& x, const auto& y) { return x.a == y.a && x.b == y.b; };
  for (auto first = contacts.begin(), last = first; first != contacts.end(); first = last) {
    last = std::find_if(first, contacts.end(), [&](const Contact& c) { return !same_pair(c, *first); });
    const double depth =
        -std::min_element(first, last, [](const Contact& x, const Contact& y) { return x.gap < y.gap; })->gap;
    if (!(depth > ContactCacheTuning::kOut) && !parts_) continue;
    auto key = std::lower_bound(keys_.begin(), keys_.end(), *first, [](const Key& x, const Contact& y) {
      return std::tie(x.a, x.b) < std::tie(y.a, y.b);
    });
    bool parted = (key == keys_.end() || !same_pair(*key, *first)) && depth > overlap_bound(world, *first);
    for (; key != keys_.end() && same_pair(*key, *first); ++key) {
      const Slot& before = slots_[key->slot];
      parted |= before.parted && std::max(depth, -before.contact.gap) > ContactCacheTuning::kOut;
    }
    if (!parted) continue;
    std::fill(parted_.begin() + (first - contacts.begin()), parted_.begin() + (last - contacts.begin()), 1);
    for (const BodyId body : {first->A, first->B}) parting_[body.index] = world.moves(body);
  }
  parts_ = std::find(parted_.begin(), parted_.end(), 1) != parted_.end();
}

int ContactCache::free_slot(const Rows::ContactSlot& at) const {
  auto it = std::lower_bound(by_pair_.begin(), by_pair_.end(), at, [](const auto& entry, const auto& wanted) {
    return order_of(entry.first) < order_of(wanted);
  });
  for (; it != by_pair_.end() && it->first == at; ++it)
    if (!slots_[it->second].active) return it->second;
  return -1;
}

int ContactCache::slot_near(const World& world, ShapeId a, ShapeId b, const Vec3& p_AP) const {
  const Rows::ContactSlot at{world.shape(a).body.index, world.shape(b).body.index, false};
  auto it = std::lower_bound(by_pair_.begin(), by_pair_.end(), at, [](const auto& entry, const auto& wanted) {
    return order_of(entry.first) < order_of(wanted);
  });
  double least = ContactCacheTuning::kSamePoint;
  int found = -1;
  for (; it != by_pair_.end() && it->first.a == at.a && it->first.b == at.b; ++it) {
    const Slot& slot = slots_[it->second];
    const double distance = (slot.contact.p_AP - p_AP).norm();
    if (!slot.active || slot.contact.a != a || slot.contact.b != b || distance > least) continue;
    least = distance;
    found = it->second;
  }
  return found;
}

ContactCache::SlotOrigins ContactCache::inherit(ContactCache& old, const World& world) {
  finder_ = std::move(old.finder_);
  SlotOrigins from;
  const int slots = static_cast<int>(old.slots_.size());
  for (int k = 0; k < slots + std::ssize(old.resting_); ++k) {
    const Slot& slot = k < slots ? old.slots_[k] : old.resting_[k - slots];
    if (!slot.active) continue;
    const bool moves = world.moves({slot.at.a}) || world.moves({slot.at.b});
    (moves ? slots_ : resting_).push_back(slot);
    (moves ? from.slots : from.resting).push_back(k);
  }
  parts_ = true;
  before_ = slots_;
  origin_.resize(slots_.size());
  std::iota(origin_.begin(), origin_.end(), 0);
  moved_ = origin_;
  rebuild();
  return from;
}

/// Drops slots that nothing has used for long.
void ContactCache::rebuild() {
  std::vector<Slot> kept, kept_before;
  std::vector<int> origin, moved;
  for (std::size_t k = 0; k < slots_.size(); ++k) {
    if (!slots_[k].active && slots_[k].unused > ContactCacheTuning::kKept && !before_[k].active) continue;
    kept.push_back(slots_[k]);
    kept_before.push_back(before_[k]);
    origin.push_back(slots_[k].active ? origin_[k] : -1);
    moved.push_back(moved_[k]);
  }
  slots_ = std::move(kept);
  before_ = std::move(kept_before);
  origin_ = std::move(origin);
  moved_ = std::move(moved);
  sort_pairs();
}

void ContactCache::sort_pairs() {
  by_pair_.clear();
  for (std::size_t k = 0; k < slots_.size(); ++k) by_pair_.push_back({slots_[k].at, int(k)});
  std::sort(by_pair_.begin(), by_pair_.end(), [](const auto& x, const auto& y) {
    return std::pair(order_of(x.first), x.second) < std::pair(order_of(y.first), y.second);
  });
}

void ContactCache::fill(int index, const Contact& contact, bool parted, const World& world,
                        const State& state) {
  Slot& slot = slots_[index];
  const Pose &A = state.poses[slot.at.a], &B = state.poses[slot.at.b];
  const Twist &V_A = state.twists[slot.at.a], &V_B = state.twists[slot.at.b];
  const Vec3 r_A = rotate(A.q, contact.p_AP), r_B = rotate(B.q, contact.p_BQ);
  const Vec3 rate = V_B.at(r_B) - V_A.at(r_A);
  slot.contact = contact;
  slot.unused = 0;
  slot.material = world.contact_material(contact.a, contact.b);
  slot.parted = parted;
  if (parting_[slot.at.a] || parting_[slot.at.b]) slot.material.compliance = 0;
  slot.point.p_AP = contact.p_AP;
  slot.point.p_BQ = contact.p_BQ;
  slot.point.frame = frame_of(contact.normal, tangential(rate, contact.normal), slot.point.frame.t1);
}

}  // namespace taut
