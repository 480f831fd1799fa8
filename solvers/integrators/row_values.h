#pragma once

#include <span>
#include <vector>

namespace taut {

class ConstraintSystem;

/// What a scheme knows of each row of the system: impulses of its kicks [N·s, N·m·s], sums of them and
/// forces [N, N·m], gaps φ and rates.
struct RowValues {
  /// `laws`: rows have laws of their own, and with them start_theta, rates and kick_rates.
  RowValues(int rows, bool laws);

  std::vector<double> lambda, mu;         ///< of the first kick and of the second
  std::vector<double> correction;         ///< S⁻¹ of what rows are off by; that itself before the solve
  std::vector<double> phi;                ///< φ of equality rows and θ of axes, at the poses last looked at
  std::vector<double> impulses;           ///< since they were cleared, for reactions
  std::vector<double> force_multipliers;  ///< at the end of the last step
  /// Coordinates of axes at the start, rates that laws see, and the mean ones of a kick.
  std::vector<double> start_theta, rates, kick_rates;
  std::vector<double> guess_rates;   ///< S times a guess of the impulses
  std::vector<double> joint_rates;   ///< J V + φ_t of rows that hold by themselves
  bool residual_is_current = false;  ///< phi is φ at the end of the last step

  /// Rates that laws see, with what a guess of the impulses gives: w ← w + S μ.
  void add_rates_of(std::span<const double> guess, ConstraintSystem& system);
  /// Row r was `from[r]`; −1: it is new.
  void move_rows(std::span<const int> from);
};

}  // namespace taut
