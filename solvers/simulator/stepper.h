#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/world/world.h"
#include "solvers/common/settings.h"
#include "solvers/integrators/scheme.h"
#include "solvers/system/constraint_system.h"

namespace taut {

class Archive;

/// The system of a world and the integrator that steps it: made anew for each pattern (topology, geometry,
/// who sleeps), started for each state.  (solvers/simulator, "Sub-steps")
class Stepper {
 public:
  /// Laws that are not met are named by bodies and joints of `named`.  `settings` live as long.
  Stepper(const World& world, const World& named, const Settings& settings);

  // The pattern.
  /// Once renew() has been called there is a system and a scheme.
  bool made() const { return scheme_ != nullptr; }
  /// Pattern and order are those of the world as it is.
  bool knows_pattern() const;
  /// Pattern and order are those of the world as it is, but perhaps for who sleeps.
  bool knows_topology() const;
  /// What it was for the pattern before; the system outlives the scheme that refers to it.
  struct Predecessor {
    std::unique_ptr<ConstraintSystem> system;
    std::unique_ptr<Scheme> scheme;  ///< null: it knew nothing worth keeping
  };
  /// Pattern, order and integrator of the present topology, which know no state yet.
  void renew();
  /// As renew(), and the new integrator knows of contacts and friction what the old one did, but of bodies
  /// that were moved.
  Predecessor renew_from_known();

  // The state.
  /// That of the world is the one at which the integrator is.
  bool knows_state() const { return state_version_ == world_.state_version(); }
  /// It is at some state: it has been started, and no step has failed since.
  bool is_started() const { return state_version_ >= 0; }
  /// It has a state, which that of the world can be compared with.
  bool has_state() const { return made() && !state().poses.empty(); }
  /// What a scheme knows of contacts, friction and impulses holds.
  bool remembers() const { return has_state() && (is_started() || retaken_); }
  /// Only gravity or a force law has changed, and that is no jump: the scheme goes on.
  bool goes_on_with_new_forces();
  void note_started() { retaken_ = false; }
  /// The scheme knows the state that the world has.
  void note_state() { state_version_ = world_.state_version(); }
  /// The world has the state that a step has left, whose velocities are those of the scheme.
  void note_left() { left_version_ = world_.state_version(); }
  bool left_state() const { return left_version_ == world_.state_version(); }
  /// What is done from now on may be taken back; and it has been, so that the state is what it was.
  void begin_undoable() { was_left_ = left_state(); }
  void note_restored() {
    if (was_left_) note_left();
  }
  void forget_state() { state_version_ = -1; }
  /// The world still has the state from before, and all its joints: start from there again.
  void forget_step();
  /// As forget_step(), at the end of a step that is taken again: if it was `done`, its integrator keeps its
  /// memory.
  void retake(bool done);
  /// What is known may be anything.
  void forget_all();

  /// The state of a body of the world is not what the integrator has left.
  bool is_moved(int body) const;
  /// Which they are, of all bodies; those that have just fallen asleep are where they were.
  std::vector<char> moved_bodies() const;

  ConstraintSystem& system() { return *system_; }
  const ConstraintSystem& system() const { return *system_; }
  Scheme& scheme() { return *scheme_; }
  const Scheme& scheme() const { return *scheme_; }

  const State& state() const { return scheme_->state(); }
  /// M V of the bodies in world axes.
  std::span<const Wrench> momenta() const { return scheme_->momenta(); }
  /// Of the rows over the last step.
  std::span<const double> impulses() const { return scheme_->impulses(); }
  /// Contacts at present.
  std::span<const ContactCache::Slot> slots() const;
  /// Contacts of the last step with the mean forces over dt.
  std::vector<ContactReport> mean_contacts(double dt) const;
  /// Springs between bodies are laws of forces here; only RATTLE of order 2 and Moreau–Jean take them
  /// implicitly, as rows.
  Springs force_springs() const {
    return springs_ == Springs::kIncluded ? Springs::kLeftOut : Springs::kIncluded;
  }

  /// Threads of the system that could not be started.
  int missing_threads() const { return threads_.missing(); }

  /// What the integrator remembers from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive);

 private:
  std::unique_ptr<Scheme> make_scheme();

  const World &world_, &named_;
  const Settings& settings_;
  Springs springs_;           // among the rows
  OrderMemory orders_;        // of elimination
  detail::LazyPool threads_;  // of the system
  std::unique_ptr<ConstraintSystem> system_;
  std::unique_ptr<Scheme> scheme_;
  std::int64_t topology_version_ = -1, geometry_version_ = -1, sleep_version_ = -1, state_version_ = -1,
               left_version_ = -1;
  bool retaken_ = false;
  bool was_left_ = false;
};

}  // namespace taut
