#pragma once

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "solvers/common/contact_report.h"
#include "solvers/common/settings.h"
#include "solvers/laws/contact_impacts.h"
#include "solvers/laws/contact_laws.h"
#include "solvers/laws/contact_works.h"

namespace taut {

class Archive;

/// All contacts of a world as laws (contact_laws.h), with what they remember from step to step, their impacts
/// and their works.
class ContactForces final : public ContactLaws {
 public:
  ContactForces(const World& world, const Settings& settings);

  bool empty() const { return !wanted_ || table_.cache.empty(); }
  /// Some are there: touching or near.
  bool any() const {
    const auto& slots = table_.cache.slots();
    return wanted_ && std::any_of(slots.begin(), slots.end(), [](const auto& slot) { return slot.active; });
  }
  const ContactCache& cache() const { return table_.cache; }
  /// For the laws of some of them.
  ContactConstraints& table() { return table_; }

  /// New start: contacts at this state.  True if the slots changed.
  bool start(const World& world, const State& state, double horizon);
  /// What is known of contacts by the forces of the same world before its pattern changed; to be called
  /// before start().
  void inherit(ContactForces& old, const World& world);
  /// The next start() keeps what is known.
  void keep_memory();
  /// The next start() stretches contacts so; p_AP is in the bodies of this world.  What is not there then is
  /// left out.
  void recall(std::vector<ContactStretch> stretches) { recalled_ = std::move(stretches); }
  /// Those of compliant contacts that press, also of bodies that sleep.
  std::vector<ContactStretch> stretches() const;
  /// Nothing is known of contacts of bodies that were moved.
  void forget(std::span<const char> moved);
  /// The slot there that a slot continues, −1 for none, after start().
  int inherited(int slot) const {
    const int origin = slot < std::ssize(table_.cache.origin()) ? table_.cache.origin()[slot] : -1;
    return origin < 0 || origin >= std::ssize(inherited_) ? -1 : inherited_[origin];
  }
  void end_inheritance() { inherited_.clear(); }
  /// Contacts at the end of the drift; what is known of those that go on is kept.  True if the slots
  /// changed.
  bool move_on(const World& world, const State& state, double horizon);
  /// The rows of slots, in the system: after the system was told of changed slots, or a new start.
  void set_rows(const Rows& rows);
  /// Slots and directions to the system.
  void give_points(ConstraintSystem& system) const;

  /// A step of h begins; `rates`: J V before it.
  void begin(double h, std::span<const double> rates, std::span<const double> effective_mass);
  /// A step of h by Moreau–Jean begins, whose impulses act at once; after move_on().
  void begin_single_kick(double h);
  /// Back to begin(), over a move_on() if there was one.
  void roll_back(bool moved_on);

  /// Some held at the end of the last step.
  bool any_hold() const;
  /// Contacts that let go of static friction in this stage may hold as before: its rates were others.
  void hold_again();
  /// Between them: what the first kick gave, in the directions of now.  `rates`: J V without the impulses of
  /// the second.  `anew`: laws of rigid contacts are those of the second kick alone, until end_impacts().
  void begin_velocities(std::span<const double> rates, std::span<const double> effective_mass, bool anew);
  /// Contacts strike at the end of this step; they are left out of its velocity stage.
  bool strikes() const;
  /// They strike after it: with its rates w⁻, set_laws() ask for w ≥ −e w⁻ with this part of each e, in
  /// all contacts that are touched, and the laws are those of what is added to the impulses `before`.  One
  /// that parts may come together as fast as it parted, so that no normal impulse gives energy.  Returns the
  /// largest e of those that strike.
  double begin_impact(std::span<const double> rates, std::span<const double> before, double part);
  /// The laws are those of the whole kick again.
  void end_impacts();
  /// Some that are touched do at these rates, faster than the resting speed.
  bool come_together(std::span<const double> rates) const;
  /// Moreau–Jean between begin_single_kick() and set_laws(): `rates` J V before the step.  Contacts that
  /// are touched have Newton's law of impact w ≥ −e w⁻ however slow they are.
  void begin_impulses(std::span<const double> rates, std::span<const double> effective_mass);
  /// Within the step.
  ContactImpacts& impacts() { return impacts_; }
  bool struck() const { return struck_; }

  /// Records the first kick, during which the rows moved with `rates` on the mean; to be called before
  /// move_on().
  void record_first_kick(std::span<const double> lambda, std::span<const double> w,
                         std::span<const double> rates);
  /// After the second kick: its impulses, and the state of friction.
  void finish(std::span<const double> mu, double time);

  /// Sums since clear_reports(), with impulses in place of forces.
  std::vector<ContactReport> reports() const;
  ContactWorks& works() { return works_; }
  void clear_reports();

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive, const World& world);

 private:
  void remap();
  void take_up_recalled(const World& world);
  void remember(double h);
  void aim_discs(int slot, std::span<const double> rates);
  void keep_report(int slot);

  bool wanted_;
  ContactConstraints table_;
  ContactImpacts impacts_{table_, *this};
  std::vector<Point> before_;
  std::vector<ImpactState> impacts_before_;
  std::vector<int> inherited_;         // −1: from one that had no rows
  std::vector<Point> resting_points_;  // of the contacts of bodies that sleep
  std::vector<ContactStretch> recalled_;
  std::vector<ContactReport> departed_;
  std::vector<char> goes_on_;
  std::vector<Point> point_scratch_;
  std::vector<ImpactState> impact_scratch_;
  ContactWorks works_{*this};
  std::size_t departed_before_ = 0;
  bool struck_ = false;
};

}  // namespace taut
