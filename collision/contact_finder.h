#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "collision/narrow/contact.h"
#include "core/world/world.h"

namespace taut {

struct ContactSettings {  ///< How a ContactFinder finds contacts.
  double margin = 0.005;  ///< [m] contacts with a gap up to this are given
  int threads = 0;        ///< 0: as many as the machine has.  The result has the same bits with any number
  int max_points = 8;     ///< [4, 64] of one pair (of each direction of the normal on a surface of triangles)
  /// Most contacts, and a quarter of the most pairs of boxes, of one find(); 0: 10,000 + 50 per shape.
  int max_contacts = 0;
};

/// What one ContactFinder::find() met with.
struct DetectionReport {
  int shapes = 0;           ///< of the world
  int candidate_pairs = 0;  ///< boxes overlap
  int touching_pairs = 0;   ///< with at least one contact
  /// Pairs near each other for which there is no contact (have_contacts()).
  std::vector<std::pair<ShapeId, ShapeId>> unsupported;
  // Two reasons for which no contacts at all are given.
  Crowd crowd;           ///< more pairs or contacts than ContactSettings::max_contacts
  ShapeId out_of_reach;  ///< a shape that is not in a finite place, or reaches beyond 1e70 m in the horizon
  bool blind() const { return !crowd.empty() || out_of_reach.index >= 0; }  ///< no contacts were given
  int missing_threads = 0;  ///< of those wanted, which could not be started; the others do their work
  double broad_seconds = 0, narrow_seconds = 0;  ///< wall time of the phase [s]
};

/// Whether there are contacts between two shapes; not between two surfaces of triangles or two grounds.
bool have_contacts(const Shape& a, const Shape& b);

/// Finds the contacts of a World: broad phase by FCL's dynamic tree, narrow phase by FCL's distances and by
/// manifolds of its own (collision/narrow).  It changes nothing in the World.  Feature ids are carried on
/// from one call to the next, hence one finder for one simulation; everything else depends on the arguments
/// alone.
class ContactFinder {
 public:
  /// @throws std::invalid_argument for a negative margin, a number of threads that is negative or more than
  /// 1024, max_points out of range or a negative max_contacts.
  explicit ContactFinder(ContactSettings settings = {});
  ~ContactFinder();
  ContactFinder(ContactFinder&&) noexcept;             ///< the source may only be destroyed or assigned to
  ContactFinder& operator=(ContactFinder&&) noexcept;  ///< the source may only be destroyed or assigned to

  /// All contacts at this state, sorted by shape a, shape b and feature; valid until the next call.  None if
  /// report().blind().
  ///
  /// With a horizon h [s] > 0 contacts farther away are given, too, if their points would come together
  /// within h at the velocities of the state: gap ≤ margin − h n·(v_Q − v_P).  A solver that keeps gap + h
  /// n·(v_Q − v_P) ≥ 0 at the end of a step h lets nothing pass through anything, however fast and thin.
  /// @throws std::invalid_argument if the state has not as many poses and twists as the world has bodies, or
  /// for a horizon that is negative or not finite.
  const std::vector<Contact>& find(const World& world, const State& state, double horizon = 0);
  const std::vector<Contact>& find(const World& world, double horizon = 0) {  ///< at the present state
    return find(world, world.state(), horizon);
  }
  const std::vector<Contact>& contacts() const;  ///< of the last find(), valid until the next
  const DetectionReport& report() const;         ///< on the last find()
  const ContactSettings& settings() const;       ///< as given
  /// Forgets the features of the last find(): those of the next are not carried on.
  void forget();
  /// Carries on the features of these contacts, as if the last find() had given them.
  void recall(std::vector<Contact> contacts);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace taut
