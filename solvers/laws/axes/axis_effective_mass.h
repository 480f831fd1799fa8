#pragma once

#include <array>
#include <span>
#include <vector>

namespace taut {

class ConstraintSystem;

/// How heavy a row of an axis is with all that the joints join to it: 1/(S_rr − S_rE (S_EE + Σ)⁺ S_Er) [kg·m²
/// or kg], where E are the rows that hold.  1/S_rr is that of two bodies by themselves, which a lever or an
/// arm that they carry exceeds many times.
class AxisEffectiveMass {
 public:
  /// With the factor of S where there is one, and the rows E that it holds fast; else by conjugate gradients
  /// on the rows of joints and those in `held`, one entry a row.  Never less than 1/S_rr, of which `alone`
  /// has one entry a row, too.
  double of(ConstraintSystem& system, int row, std::span<const double> alone, std::span<const char> held);

 private:
  double by_factor(ConstraintSystem& system, int row);
  double by_iteration(ConstraintSystem& system, int row, std::span<const double> alone,
                      std::span<const char> held);

  std::array<std::vector<double>, 4> scratch_;  // of the size of the rows
};

}  // namespace taut
