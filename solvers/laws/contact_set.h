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

/// The contacts of a world as places of the constraint system.  A place belongs to a pair of bodies and is
/// kept for a while after its contact has gone, so that a scene that has settled keeps its pattern: contacts
/// of the same two bodies take over each other's places.  (solvers/laws, "Contacts")
class ContactSet {
 public:
  struct Place {
    Rows::ContactPlace at;
    bool active = false;
    int unused = 0;                   ///< finds since it was last active
    Contact contact;                  ///< the present one, or the last
    Material material;                ///< of the pair; rigid while one of its bodies is parted from any
    bool parted = false;              ///< its bodies were in each other when they met
    row_parts::ContactPoint point{};  ///< its rows
  };

  ContactSet(const World& world, const ContactSettings& settings);

  /// No two shapes of the world can touch.
  bool empty() const { return empty_; }
  const std::vector<Place>& places() const { return places_; }
  /// Contacts of bodies that sleep, as they were.
  const std::vector<Place>& resting() const { return resting_; }
  std::vector<Rows::ContactPlace> rows() const;

  /// Contacts at a state, and those that could come about within `horizon` [s] (contact_finder.h), put into
  /// places.  Returns true if they needed other places than before: the constraint system must be told.
  /// `origin()` then says for each place which one of before it continues, −1 for none: its contact is new.
  bool find(const World& world, const State& state, double horizon);
  std::span<const int> origin() const { return origin_; }
  /// The index that each place had before, −1 for a place that is new.
  std::span<const int> moved() const { return moved_; }
  /// The contact that a place, by its index of then, had before the last find().
  const Contact& contact_before(int place) const { return contacts_before_[place]; }
  /// Goes on with the contacts of another set.  Those between bodies that do not move have no places; they
  /// are kept until these wake.
  struct Heritage {
    std::vector<int>
        places;  ///< of each place: its index there; contacts that were kept come after the places
    std::vector<int> resting;  ///< the same of those that are kept here
  };
  Heritage inherit(ContactSet& old, const World& world);
  /// As it was before the last find(), but in the places of now.
  void undo();
  /// Turned tangents.
  row_parts::ContactPoint& point(int place) { return places_[place].point; }
  /// The active place of a contact of these shapes that is nearest to a point of A [m, from its centre of
  /// mass], where it was or no further than 1e-4 m from it; −1 for none.
  int place_near(const World& world, ShapeId a, ShapeId b, const Vec3& p_AP) const;
  const DetectionReport& detection() const { return finder_.report(); }

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive, const World& world);

 private:
  struct Key {
    ShapeId a, b;
    std::uint64_t feature;
    int place;
  };
  /// By what a contact is known again.
  enum class Likeness { kSameFeatureAndPoint, kNearest, kSameFeature };
  void match(const World& world, const std::vector<Contact>& contacts);
  void vacate();
  void occupy(int place, std::size_t contact);
  int place_before(const World& world, const Contact& contact, Likeness likeness) const;
  void part_overlaps(const World& world, const std::vector<Contact>& contacts);
  int free_place(const Rows::ContactPlace& at) const;
  void rebuild();
  void sort_pairs();
  void fill(int place, const Contact& contact, bool parted, const World& world, const State& state);

  bool empty_ = true;
  ContactFinder finder_;
  std::vector<Place> places_, before_, resting_;
  std::vector<Contact> contacts_before_;  // in the places of before
  std::vector<int> origin_, moved_;
  std::vector<Key> keys_;
  std::vector<std::pair<Rows::ContactPlace, int>> by_pair_;  // sorted
  std::vector<int> place_of_contact_;
  std::vector<char> parted_;   // by contact
  std::vector<char> parting_;  // bodies that have such a contact
  bool parts_ = false;         // one of them has, or may have, as of the last find
};

}  // namespace taut
