#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "collision/contact.h"
#include "core/world.h"

namespace taut {

struct ContactSettings {
  double margin = 0.005;  ///< [m] contacts with a gap up to this are given
  int threads = 0;        ///< 0: as many as the machine has.  The result has the same bits with any number
  int max_points = 8;     ///< [4, 64] of one pair (of each direction of the normal on a surface of triangles)
};

/// What the last find() met with.
struct DetectionReport {
  int shapes = 0;
  int candidate_pairs = 0;  ///< boxes overlap
  int touching_pairs = 0;   ///< with at least one contact
  /// Pairs that were not looked at because thousands of shapes lie in one place.
  std::int64_t pairs_left_out = 0;
  /// Pairs near each other for which there is no contact: two surfaces of triangles, or two grounds.
  std::vector<std::pair<ShapeId, ShapeId>> unsupported;
  double broad_seconds = 0, narrow_seconds = 0;
};

/// Finds the contacts of a World: broad phase by FCL's dynamic tree, narrow phase by FCL's distances and by
/// manifolds of its own (collision/README).  It changes nothing in the World.  Feature ids are carried on
/// from one call to the next, hence one finder for one simulation; everything else depends on the arguments
/// alone.
class ContactFinder {
 public:
  /// @throws std::invalid_argument for a negative margin or number of threads, or max_points out of range.
  explicit ContactFinder(ContactSettings settings = {});
  ~ContactFinder();
  ContactFinder(ContactFinder&&) noexcept;
  ContactFinder& operator=(ContactFinder&&) noexcept;

  /// All contacts at this state, sorted by shape a, shape b and feature; valid until the next call.
  ///
  /// With a horizon h [s] > 0 contacts farther away are given, too, if their points would come together
  /// within h at the velocities of the state: gap ≤ margin − h n·(v_Q − v_P).  A solver that keeps gap + h
  /// n·(v_Q − v_P) ≥ 0 at the end of a step h lets nothing pass through anything, however fast and thin.
  /// @throws std::invalid_argument if the state has not as many poses and twists as the world has bodies, or
  /// for a horizon that is negative or not finite.
  const std::vector<Contact>& find(const World& world, const State& state, double horizon = 0);
  const std::vector<Contact>& find(const World& world, double horizon = 0) {
    return find(world, world.state(), horizon);
  }
  const std::vector<Contact>& contacts() const;
  const DetectionReport& report() const;
  const ContactSettings& settings() const;
  /// Forgets the ids of the last call.
  void forget();
  /// Goes on with the ids of these, as if they were the contacts of the last call.
  void recall(std::vector<Contact> contacts);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace taut
