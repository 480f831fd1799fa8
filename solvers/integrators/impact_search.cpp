#include "solvers/integrators/impact_search.h"

#include <algorithm>

#include "solvers/laws/law_constants.h"

namespace taut {
namespace {

/// Lets through what this solution of the position stage stops in free flight.  True if there is any.
template <typename Kind>
bool seek(Kind& kind, std::span<const double> lambda, std::span<const double> w) {
  if (!kind.wanted()) return false;
  bool any = false;
  for (std::size_t i = 0; i < kind.size(); ++i) {
    if (!kind.state(i).is_open() || !kind.let_through(i, lambda, w)) continue;
    kind.state(i).seek();
    any = true;
  }
  if (any) kind.count();
  return any;
}

/// When the first of them gets there; h if none does.
template <typename Kind>
double first_meeting(Kind& kind, std::span<const double> w, double h) {
  double first = h;
  for (std::size_t i = 0; i < kind.size() && kind.located(); ++i)
    if (kind.state(i).sought()) first = std::min(first, kind.meeting(i, w, h));
  return first;
}

/// Those that get there until then are due.  What was due at the end of a longer step goes on to be if it
/// comes first.
template <typename Kind>
void take(Kind& kind, double until, std::span<const double> w, double h) {
  for (std::size_t i = 0; i < kind.size(); ++i) {
    if (!kind.state(i).let_through()) continue;
    const double time = kind.meeting(i, w, h);
    kind.state(i).set_due(time <= until);
    kind.set_meeting(i, time, w, h);
  }
}

template <typename Kind>
void forget(Kind& kind, bool for_good) {
  for (std::size_t i = 0; i < kind.size(); ++i) kind.state(i).forget(for_good);
}

}  // namespace

bool ImpactSearch::begin(std::span<const double> lambda, std::span<const double> rates) {
  const bool axis = seek(axes_, lambda, rates), contact = seek(contacts_, lambda, rates);
  return axis || contact;
}

double ImpactSearch::first(double h, std::span<const double> rates) {
  const double together = LawTuning::kTogether * h;
  const double first =
      std::max(std::min(first_meeting(axes_, rates, h), first_meeting(contacts_, rates, h)), together);
  take(axes_, first + together, rates, h);
  take(contacts_, first + together, rates, h);
  return first > (1 - LawTuning::kTogether) * h ? h : first;
}

void ImpactSearch::end() {
  forget(axes_, false);
  forget(contacts_, false);
}

void ImpactSearch::give_up() {
  forget(axes_, true);
  forget(contacts_, true);
}

}  // namespace taut
