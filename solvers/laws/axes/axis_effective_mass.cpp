#include "solvers/laws/axes/axis_effective_mass.h"

#include "solvers/system/constraint_system.h"

namespace taut {
namespace {

struct AxisEffectiveMassTuning {
  /// The iteration ends when a step changes the inverse by less than this part, or after so many.  Chosen.
  static constexpr double kChange = 1e-9;
  static constexpr int kMostSteps = 200;
};

double inner_product(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t r = 0; r < a.size(); ++r) sum += a[r] * b[r];
  return sum;
}

}  // namespace

double AxisEffectiveMass::of(ConstraintSystem& system, int row, std::span<const double> alone,
                             std::span<const char> held) {
  for (auto& values : scratch_) values.assign(system.row_count(), 0.0);
  const double inverse =
      system.has_delassus_factor() ? by_factor(system, row) : by_iteration(system, row, alone, held);
  const double effective_mass = 1 / inverse;
  return inverse > 0 && effective_mass > alone[row] ? effective_mass : alone[row];
}

/// A row of the factor is in it with its own compliance; one that is masked has a column of S.
double AxisEffectiveMass::by_factor(ConstraintSystem& system, int row) {
  auto& [unit, column, solution, unused] = scratch_;
  const std::span<const double> states = system.factored_states();
  unit[row] = 1;
  if (states.empty() || states[row] != kMasked) {
    system.solve(unit);
    return 1 / unit[row] - (states.empty() ? 0 : states[row]);
  }
  system.multiply(unit, column);
  for (std::size_t r = 0; r < states.size(); ++r) solution[r] = states[r] == kMasked ? 0 : column[r];
  system.solve(solution);
  return column[row] - inner_product(column, solution);
}

/// y = S_EE⁺ S_Er by conjugate gradients, scaled by the diagonal.  S_rr − S_rE y falls with each step.
double AxisEffectiveMass::by_iteration(ConstraintSystem& system, int row, std::span<const double> alone,
                                       std::span<const char> held) {
  auto& [direction, image, residual, scaled] = scratch_;
  const Rows& rows = system.rows();
  direction[row] = 1;
  system.multiply(direction, residual);
  direction[row] = 0;
  double inverse = residual[row];
  const auto hold = [&](std::span<double> x) {
    for (int r = 0; r < system.row_count(); ++r)
      if (r == row || r >= rows.first_contact_row() || !(rows.is_equality(r) || held[r])) x[r] = 0;
  };
  hold(residual);
  double before = 0;
  for (int step = 0; step < AxisEffectiveMassTuning::kMostSteps; ++step) {
    for (std::size_t r = 0; r < alone.size(); ++r) scaled[r] = alone[r] * residual[r];
    const double size = inner_product(scaled, residual);
    if (!(size > 0)) break;
    for (std::size_t r = 0; r < alone.size(); ++r)
      direction[r] = scaled[r] + (step > 0 ? size / before : 0) * direction[r];
    before = size;
    system.multiply(direction, image);
    hold(image);
    const double along = inner_product(direction, image);
    if (!(along > 0)) break;
    const double length = size / along;
    for (std::size_t r = 0; r < alone.size(); ++r) residual[r] -= length * image[r];
    inverse -= length * size;
    if (length * size <= AxisEffectiveMassTuning::kChange * inverse) break;
  }
  return inverse;
}

}  // namespace taut
