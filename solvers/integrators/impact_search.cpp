#include "solvers/integrators/impact_search.h"

#include <algorithm>

#include "solvers/laws/law_constants.h"

namespace taut {

bool ImpactSearch::begin(std::span<const double> lambda, std::span<const double> rates) {
  const bool axis = axes_.seek_impacts(rates), contact = contacts_.impacts().seek(lambda);
  return axis || contact;
}

double ImpactSearch::first(double h, std::span<const double> rates) {
  const double together = kTogether * h;
  const double first =
      std::max(std::min(axes_.first_impact(rates), contacts_.impacts().first(rates)), together);
  axes_.take_impacts(first + together, rates);
  contacts_.impacts().take(first + together, rates);
  return first > (1 - kTogether) * h ? h : first;
}

void ImpactSearch::end() {
  axes_.forget_impacts(false);
  contacts_.impacts().forget(false);
}

void ImpactSearch::give_up() {
  axes_.forget_impacts(true);
  contacts_.impacts().forget(true);
}

}  // namespace taut
