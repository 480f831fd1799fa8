#pragma once

#include <span>
#include <vector>

#include "core/base/union_find.h"
#include "core/world/world.h"
#include "solvers/common/contact_report.h"
#include "solvers/common/settings.h"
#include "solvers/laws/contact_cache.h"

namespace taut {

class Archive;

/// Lets islands at rest fall asleep, and wakes them.  An island is what joints, force laws that name their
/// bodies, and contacts connect, not by way of fixed bodies; it sleeps and wakes as a whole.
/// With Settings::sleep off it does nothing.                         (solvers/simulator, "Sleep")
class Sleep {
 public:
  explicit Sleep(const Settings& settings)
      : enabled_(settings.sleep), speed_(settings.sleep_speed), time_(settings.sleep_time) {}

  bool enabled() const { return enabled_; }

  // Before a step.
  /// Wakes the islands of which a body is awake, on which forces have changed, or that a moving body may
  /// touch within h.
  void wake(World& world, std::span<const ContactCache::Slot> slots, double h);
  /// The bodies of islands in which all have been slow for long enough, and that neither a driver nor a motor
  /// keeps going, become candidates() in place of those before.
  void choose_candidates(const World& world, const Rows& rows, std::span<const ContactCache::Slot> slots);
  void forget_candidates() { candidates_.clear(), candidate_twists_.clear(); }
  const std::vector<BodyId>& candidates() const { return candidates_; }
  /// The candidates stay where they are from now on.
  void put_to_sleep(World& world);

  // After it.
  /// How long each body has been slow, after a step of dt.
  void watch(const World& world, double dt);
  /// Wakes the islands that a step has touched, or, if it could not be done, all: true if there are any, and
  /// the step must be taken again.
  bool wake_after(World& world, std::span<const ContactReport> contacts, bool done);
  /// A step that failed changes nothing: not who sleeps, either.
  void restore_awake(World& world);

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  /// Reading, bodies that slept are put to sleep in the world.
  void transfer(Archive& archive, World& world);

 private:
  void read_bodies(const World& world);
  bool is_slow(const World& world, int body) const;
  bool is_quiet(int body) const { return quiet_[body] >= time_; }
  void connect(const World& world, std::span<const ContactCache::Slot> slots);
  void join(const World& world, std::span<const BodyId> bodies);
  std::vector<BodyId> collect_sleep_candidates(const World& world, const Rows& rows,
                                               std::span<const ContactCache::Slot> slots);
  void note_restless(const World& world, const Rows& rows);
  void wake_island(World& world, int island);
  void wake_stirred(World& world);
  void wake_pulled(World& world);
  void wake_approached(World& world, std::span<const ContactCache::Slot> slots, double h);
  bool wake_touched(World& world, std::span<const ContactReport> contacts);
  bool any_asleep() const;
  bool forces_changed(const World& world, int body) const;

  const bool enabled_;
  double speed_, time_;
  std::vector<BodyId> candidates_;  // that fall asleep with the present step
  std::vector<Twist> candidate_twists_;
  std::vector<double> quiet_;                 // time for which a body has been slow [s]
  std::vector<double> gyration_;              // square of the largest radius of gyration [m²]
  std::vector<int> wake_counts_;              // World::wake_count() that were seen
  std::vector<int> island_of_;                // of bodies: the island that sleeps, −1 for none
  UnionFind connected_;                       // bodies
  std::vector<char> restless_;                // first bodies of what is connected
  std::vector<std::vector<BodyId>> islands_;  // that sleep; empty: a free place
  std::vector<Wrench> forces_, forces_then_;  // now, and when the body fell asleep
};

}  // namespace taut
