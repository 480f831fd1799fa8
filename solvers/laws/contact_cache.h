#pragma once

#include <span>
#include <vector>

#include "collision/contact_finder.h"
#include "core/constraints/rows.h"
#include "core/world/world.h"

namespace taut {

class Archive;

/// A hundredth of the radius of gyration of the smaller of its bodies [m]: what is deeper when bodies meet is
/// an overlap, and no round-off of where they were put.
double overlap_depth(const World& world, const Contact& contact);

/// It has friction of turning that is proportional to the rate.
inline bool resists_turning_linearly(const Material& material) {
  return material.rolling_friction_linear > 0 || material.spinning_friction_linear > 0;
}

/// The contacts of a world as slots of the constraint system.  A slot belongs to a pair of bodies and is
/// kept for a while after its contact has gone, so that a scene that has settled keeps its pattern: contacts
/// of the same two bodies take over each other's slots.  (solvers/laws, "Contacts")
class ContactCache {
 public:
  struct Slot {
    Rows::ContactSlot at;
    bool active = false;
    int unused = 0;                   ///< finds since it was last active
    Contact contact;                  ///< the present one, or the last
    Material material;                ///< of the pair; rigid while one of its bodies is parted from any
    bool parted = false;              ///< its bodies were in each other when they met
    row_parts::ContactPoint point{};  ///< its rows
  };

  ContactCache(const World& world, const ContactSettings& settings);

  /// No two shapes of the world can touch.
  bool empty() const { return empty_; }
  const std::vector<Slot>& slots() const { return slots_; }
  /// Contacts of bodies that sleep, as they were.
  const std::vector<Slot>& resting() const { return resting_; }
  std::vector<Rows::ContactSlot> rows() const;

  /// Contacts at a state, and those that could come about within `horizon` [s] (contact_finder.h), put into
  /// slots.  Returns true if they needed other slots than before: the constraint system must be told.
  /// `origin()` then says for each slot which earlier one it continues, −1 for none: its contact is new.
  bool find(const World& world, const State& state, double horizon);
  std::span<const int> origin() const { return origin_; }
  /// The index that each slot had before, −1 for a slot that is new.
  std::span<const int> moved() const { return moved_; }
  /// The contact that a slot, by its index of then, had before the last find().
  const Contact& contact_before(int slot) const { return contacts_before_[slot]; }
  /// Goes on with the contacts of another set.  Those between bodies that do not move have no slots; they
  /// are kept until these wake.
  struct SlotOrigins {
    std::vector<int> slots;  ///< of each slot: its index there; contacts that were kept come after the slots
    std::vector<int> resting;  ///< the same of those that are kept here
  };
  SlotOrigins inherit(ContactCache& old, const World& world);
  /// As it was before the last find(), but in the present slots.
  void undo();
  /// Turned tangents.
  row_parts::ContactPoint& point(int slot) { return slots_[slot].point; }
  /// The active slot of a contact of these shapes that is nearest to a point of A [m, from its centre of
  /// mass], where it was or no further than 1e-4 m from it; −1 for none.
  int slot_near(const World& world, ShapeId a, ShapeId b, const Vec3& p_AP) const;
  const DetectionReport& detection() const { return finder_.report(); }

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive, const World& world);

 private:
  struct Key {
    ShapeId a, b;
    std::uint64_t feature;
    int slot;
  };
  /// By what a contact is known again.
  enum class Likeness { kSameFeatureAndPoint, kNearest, kSameFeature };
  void match(const World& world, const std::vector<Contact>& contacts);
  void vacate();
  void occupy(int slot, std::size_t contact);
  int slot_before(const World& world, const Contact& contact, Likeness likeness) const;
  void part_overlaps(const World& world, const std::vector<Contact>& contacts);
  int free_slot(const Rows::ContactSlot& at) const;
  void rebuild();
  void sort_pairs();
  void fill(int slot, const Contact& contact, bool parted, const World& world, const State& state);

  bool empty_ = true;
  ContactFinder finder_;
  std::vector<Slot> slots_, before_, resting_;
  std::vector<Contact> contacts_before_;  // in the slots that they had
  std::vector<int> origin_, moved_;
  std::vector<Key> keys_;
  std::vector<std::pair<Rows::ContactSlot, int>> by_pair_;  // sorted
  std::vector<int> slot_of_contact_;
  std::vector<char> parted_;   // by contact
  std::vector<char> parting_;  // bodies that have such a contact
  bool parts_ = false;         // one of them has, or may have, as of the last find
};

}  // namespace taut
