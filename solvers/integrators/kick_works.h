#pragma once

#include <span>
#include <vector>

#include "core/world/world.h"
#include "solvers/common/step_report.h"
#include "solvers/system/constraint_system.h"

namespace taut {

/// Chosen, where nothing else is said.
struct KickWorksTuning {
  /// Part of the kinetic energy by which projections onto joints and impacts may seem to add to it: what the
  /// tolerance of rates leaves.
  static constexpr double kUnseenEnergy = 1e-9;
};

/// Works of what acts in kicks, for the ledger.  In a kick from momenta p₀ to p₁ impulses do their work
/// against the mean twists ½ M⁻¹ (p₀ + p₁): those that act together add up to the change of kinetic energy
/// exactly.                                                                        (solvers/simulator,
/// "Energy")
class KickWorks {
 public:
  /// `springs`: whether force laws have them.
  KickWorks(const World& world, const ConstraintSystem& system, Springs springs);

  /// A kick at the poses of `state`, for which the system's masses are.
  struct Kick {
    const State& state;
    std::span<const Wrench> from, to;  ///< momenta
    std::span<const double> jacobian, lambda;
  };
  /// Works of forces f that act for h/2, of the impulses Jᵀλ and of drivers among them.
  void add(const Kick& kick, std::span<const Wrench> forces, double h, StepWorks& works);
  /// Adds the work of an impulse from → to by itself.
  void add_between(std::span<const Wrench> from, std::span<const Wrench> to, double& work) const;
  /// An energy [J] that bodies with these momenta were given; 0 if that is within round-off of what they
  /// have.
  double if_seen(double energy, std::span<const Wrench> momenta) const;
  /// J ½ M⁻¹ (p₀ + p₁), mean rates of the rows.
  void mean_rates(std::span<const Wrench> from, std::span<const Wrench> to, std::span<const double> jacobian,
                  std::span<double> out);

  enum class Bodies { kAll, kSplit };
  /// Σ ½ Lᵀ I_W⁻¹ L of all bodies, or of those with three different moments, whose free flow is split and
  /// keeps it to the third order only.
  double spin_energy(std::span<const Wrench> momenta, std::span<const Pose> poses, Bodies which) const;
  /// What the free flow of those has changed it by on the way between these poses.
  double split_flow(std::span<const Wrench> momenta, std::span<const Pose> from,
                    std::span<const Pose> to) const;

 private:
  /// Σ ½ pᵀ M⁻¹ p
  double kinetic_energy(std::span<const Wrench> momenta) const;
  template <typename Visit>
  void with_mean_twists(std::span<const Wrench> from, std::span<const Wrench> to, Visit&& visit) const;
  /// ½ M⁻¹ (p₀ + p₁) of a body.
  Twist mean_twist(int b, const Wrench& from, const Wrench& to) const {
    return system_.inverse_mass(b).twist({0.5 * (from.torque + to.torque), 0.5 * (from.force + to.force)});
  }

  const World& world_;
  const ConstraintSystem& system_;
  Springs springs_;
  bool has_drivers_, has_split_flow_ = false;
  std::vector<Wrench> dissipative_;  // forces that are not conservative
  std::vector<Twist> mean_twists_;
  std::vector<double> mean_rates_;
};

}  // namespace taut
