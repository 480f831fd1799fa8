#pragma once

#include <span>
#include <vector>

#include "core/base/union_find.h"
#include "core/world/world.h"
#include "solvers/common/contact_report.h"
#include "solvers/common/settings.h"
#include "solvers/laws/contact_set.h"

namespace taut {

class Archive;

/// Lets islands at rest fall asleep, and wakes them.  An island is what joints, force laws that name their
/// bodies, and contacts connect, not by way of fixed bodies; it sleeps and wakes as a whole.
/// (solvers/simulator, "Sleep")
class Sleep {
 public:
  Sleep(const World& world, const Settings& settings);

  /// After a step of dt: how long each body has been slow.
  void watch(const World& world, double dt);
  /// The bodies of islands in which all have been slow for long enough, and that neither a driver nor a motor
  /// keeps going.
  std::vector<BodyId> tired(const World& world, const Rows& rows, std::span<const ContactSet::Place> places);
  /// Those bodies stay where they are from now on.
  void put_to_sleep(World& world, std::span<const BodyId> bodies);
  /// Wakes the islands of which a body is awake, on which forces have changed, or that a moving body may
  /// touch within h.
  void wake(World& world, std::span<const ContactSet::Place> places, double h);
  /// Wakes the islands that were touched in a step, which must then be taken again; false if there are none.
  bool wake_touched(World& world, std::span<const ContactReport> contacts);

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  /// Reading, bodies that slept are put to sleep in the world.
  void transfer(Archive& archive, World& world);

 private:
  void read_bodies(const World& world);
  bool is_slow(const World& world, int body) const;
  bool is_quiet(int body) const { return quiet_[body] >= time_; }
  void connect(const World& world, std::span<const ContactSet::Place> places);
  void join(const World& world, std::span<const BodyId> bodies);
  void note_restless(const World& world, const Rows& rows);
  void wake_island(World& world, int island);
  bool any_asleep() const;
  bool forces_changed(const World& world, int body) const;

  double speed_, time_;
  std::vector<double> quiet_;                 // time for which a body has been slow [s]
  std::vector<double> gyration_;              // square of the largest radius of gyration [m²]
  std::vector<int> stirs_;                    // World::wake_count() that were seen
  std::vector<int> island_of_;                // of bodies: the island that sleeps, −1 for none
  UnionFind connected_;                       // bodies
  std::vector<char> restless_;                // first bodies of what is connected
  std::vector<std::vector<BodyId>> islands_;  // that sleep; empty: a free place
  std::vector<Wrench> forces_, forces_then_;  // now, and when the body fell asleep
};

}  // namespace taut
