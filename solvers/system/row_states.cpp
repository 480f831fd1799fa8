#include "solvers/system/row_states.h"

#include <algorithm>

namespace taut {

void RowStates::set(std::span<const double> states) {
  const bool all_free = std::all_of(states.begin(), states.end(), [](double s) { return s == 0; });
  states_.assign(states.begin(), all_free ? states.begin() : states.end());
}

void RowStates::mask_bounded(const Rows& rows) {
  const bool any = !rows.axis_rows().empty() || rows.contact_count() > 0;
  states_.assign(any ? rows.row_count() : 0, 0.0);
  for (const Rows::AxisRow& axis : rows.axis_rows()) states_[axis.row] = kMasked;
  if (any) std::fill(states_.begin() + rows.first_contact_row(), states_.end(), kMasked);
}

bool RowStates::any_free() const {
  return states_.empty() || std::find(states_.begin(), states_.end(), 0.0) != states_.end();
}

void RowStates::clear_masked(std::span<double> x) const {
  for (std::size_t r = 0; r < states_.size(); ++r)
    if (states_[r] == kMasked) x[r] = 0;
}

void RowStates::add_compliance(std::span<const double> x, std::span<double> out) const {
  for (std::size_t r = 0; r < states_.size(); ++r)
    out[r] = states_[r] == kMasked ? 0 : out[r] + states_[r] * x[r];
}

}  // namespace taut
