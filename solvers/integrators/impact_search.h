#pragma once

#include <span>

#include "solvers/laws/axes/axis_impacts.h"
#include "solvers/laws/contact_impacts.h"

namespace taut {

/// The first impact within a step that is located, of axes at rigid limits and of contacts.  What the step
/// stops in free flight is let through once: the step solved again shows when it gets there, and the next
/// sub-step ends then.  Impacts closer together than 1e-3 of a step are one.  (solvers/integrators, "RATTLE")
class ImpactSearch {
 public:
  /// Both kinds must outlive it.
  ImpactSearch(AxisImpacts& axes, ContactImpacts& contacts) : axes_(axes), contacts_(contacts) {}

  /// True if a solution of the position stage, with these impulses and rates of the rows, has impacts: their
  /// laws let them through now.
  bool begin(std::span<const double> lambda, std::span<const double> rates);
  /// The length of the sub-step that ends with the first of them [s], from the rates without them in a step
  /// of h; those at that time are due then.
  double first(double h, std::span<const double> rates);
  /// None of them is wanted any more.
  void end();
  /// None of them is wanted, nor looked for again in this step.
  void give_up();

 private:
  AxisImpacts& axes_;
  ContactImpacts& contacts_;
};

}  // namespace taut
