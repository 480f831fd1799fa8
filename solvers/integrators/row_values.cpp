#include "solvers/integrators/row_values.h"

#include "solvers/common/move_rows.h"
#include "solvers/system/constraint_system.h"

namespace taut {

RowValues::RowValues(int rows, bool laws) {
  for (auto* values : {&lambda, &mu, &correction, &phi, &joint_rates, &impulses, &force_multipliers})
    values->assign(rows, 0.0);
  for (auto* values : {&start_theta, &rates, &kick_rates, &guess_rates}) values->assign(laws ? rows : 0, 0.0);
}

void RowValues::add_rates_of(std::span<const double> guess, ConstraintSystem& system) {
  system.multiply(guess, guess_rates);
  for (std::size_t r = 0; r < guess_rates.size(); ++r) rates[r] += guess_rates[r];
}

void RowValues::move_rows(std::span<const int> from) {
  for (auto* values : {&lambda, &mu, &correction, &phi, &joint_rates, &impulses, &force_multipliers,
                       &start_theta, &rates, &kick_rates, &guess_rates})
    taut::move_rows(from, 0.0, *values);
}

}  // namespace taut
