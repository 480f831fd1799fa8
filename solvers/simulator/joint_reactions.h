#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/world/world.h"
#include "solvers/simulator/simulator.h"
#include "solvers/simulator/stepper.h"

namespace taut {

/// What the rows of joints bear at the present instant, from the acceleration equation
///
///     S λ = −(γ + J M⁻¹ (f − ω × Iω)),
///
/// and wrenches on bodies B from multipliers.
class JointReactions {
 public:
  /// Rows of a new pattern: nothing is known.
  void renew(int row_count);
  /// Room for rows that contacts have added.
  void reserve(int row_count) { multipliers_.resize(row_count); }

  /// λ in the present state, with a system of its own so that the integrator keeps its factor; where rows
  /// have laws other than springs, the multipliers at the end of the last step; in reduced coordinates those
  /// of the recursion.
  void solve(const World& world, const Settings& settings, Stepper& stepper);
  std::span<const double> multipliers() const { return multipliers_; }

  /// Force and torque of a joint at the present state of the source, whose rows are `own`, from multipliers
  /// of the rows of the system times `scale`.
  Reaction of(JointId joint, const World& source, const Rows& own, const Rows& system,
              std::span<const double> multipliers, double scale);

 private:
  void solve_accelerations(const World& world, const Settings& settings);
  void add_spring_forces(const World& world, const Stepper& stepper);

  std::vector<double> multipliers_;
  std::vector<double> jacobian_;  // of the source's present state, made when the first joint asks
  std::int64_t version_ = -1, jacobian_version_ = -1;
};

}  // namespace taut
