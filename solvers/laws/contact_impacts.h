#pragma once

#include <span>

#include "solvers/laws/contact_rows.h"

namespace taut {

class Archive;

/// Impacts of contacts with restitution, or all, within a step, as those of axes (axis_forces.h): contacts
/// whose gap a free step would close are left out of it, the first that closes is located by their mean
/// rates, and the step ends there, where ContactForces::begin_impact() follows its velocity stage.
/// (solvers/laws, "Impacts")
class ContactImpacts {
 public:
  /// Of all contacts of a table.
  ContactImpacts(ContactTable& table, const ContactRows& contacts) : table_(table), contacts_(contacts) {}

  /// Leaves out contacts that close their gap in this step, and press with impulses λ.  True if there are
  /// any.
  bool seek(std::span<const double> lambda);
  /// When the first of them closes [s from the start of the step]; h if none does.
  double first(std::span<const double> w) const;
  /// The step ends with the impacts of those that close until then [s].
  void take(double until, std::span<const double> w);
  /// None is sought or due any more; `for_good`: nor will those be in this step.
  void forget(bool for_good);
  /// A new step.
  void clear();

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive);

 private:
  double crossing(int k, double w) const;

  ContactTable& table_;
  const ContactRows& contacts_;
  int count_ = 0;
};

}  // namespace taut
