#pragma once

#include <span>

#include "solvers/laws/contact_rows.h"
#include "solvers/laws/time_of_meeting.h"

namespace taut {

class Archive;

/// Impacts of contacts with restitution, or of all, as one of the two kinds that are located within a step
/// (integrators/impact_search.h).  At the end of a sub-step that ends there ContactForces::begin_impact()
/// follows its velocity stage.
class ContactImpacts {
 public:
  /// Of all contacts of a table.
  ContactImpacts(ContactConstraints& table, const ContactRows& contacts)
      : table_(table), contacts_(contacts) {}

  // For the location of the first one.
  std::size_t size() const { return table_.points.size(); }
  ImpactState& state(std::size_t k) { return table_.impacts[k]; }
  /// Some may be let through.
  bool wanted() const { return true; }
  /// Contact k closes its gap in this step, and presses with impulses λ: it is left out now.
  bool let_through(std::size_t k, std::span<const double> lambda, std::span<const double> w);
  /// So it was with some.
  void count() { ++count_; }
  /// The impacts of those let through are to be located; beyond MeetingTuning::kMostImpacts they happen with
  /// their sub-step.
  bool located() const { return count_ <= MeetingTuning::kMostImpacts; }
  /// The time from the start of a step of h, in (0, h], at which contact k closes, by its mean rate; h if it
  /// does not.
  double meeting(std::size_t k, std::span<const double> w, double h) const;
  /// That is when it strikes; rates are looked at then.
  void set_meeting(std::size_t /*k*/, double /*time*/, std::span<const double> /*w*/, double /*h*/) {}
  /// A new step.
  void clear();

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive);

 private:
  ContactConstraints& table_;
  const ContactRows& contacts_;
  int count_ = 0;
};

}  // namespace taut
