#pragma once

#include <span>
#include <vector>

#include "core/world/world.h"
#include "solvers/system/constraint_system.h"

namespace taut {

/// The bodies in phase space through the stages of a step: poses q, momenta p = M V [N·m·s, N·s] in world
/// axes about the centres of mass, zero for fixed bodies, and the forces f on them.
///
///   start          state, momenta, forces
///   kick, drift    kicked = p, trial_poses = q₁
///   accepted       state at the end with momenta that become p₁; start_poses and start_momenta
class Phase {
 public:
  /// `springs`: whether force laws have those between bodies.  World and system must outlive it.
  Phase(const World& world, const ConstraintSystem& system, Springs springs);

  /// V = M⁻¹ p of the bodies that move, with the masses of the system.
  void twists_from(std::span<const Wrench> momenta);
  /// f at the state.
  void find_forces() { world_.forces(state, forces, springs_); }
  void find_forces(const State& at) { world_.forces(at, forces, springs_); }
  bool forces_depend_on_velocity() const { return world_.forces_depend_on_velocity(springs_); }
  /// p + h/2 f of body b, at the end of the drift.
  void second_kick(int b, double h) { momenta[b] = kicked[b] + 0.5 * h * forces[b]; }
  /// Of all bodies that move.
  void second_kick(double h);
  /// p + Jᵀμ, with the Jacobian of the system.
  void add_impulses(std::span<const double> mu);
  /// What a step of h from the present state leads to, while it is tried: `trial_poses`.
  Configuration trial_end(double h) const;
  /// Once it is accepted: the new state, with axes that hold at `start_poses` still.
  Configuration accepted_end() const;
  /// The end of the drift is the state from now on.
  void accept(double h);
  /// Back to before accept(); what was accepted is a trial again.
  void take_back();
  /// The last step ended at this time to the last bit.
  void set_time(double time) {
    linearized_time = state.time;
    state.time = time;
  }
  /// Momenta are, and the state is one that a World takes.
  bool finite() const;

  State state;  ///< twists are those of momenta
  std::vector<Wrench> momenta, start_momenta;
  std::vector<Wrench> forces;
  std::vector<Wrench> kicked;  ///< p between the kicks
  std::vector<Pose> trial_poses, start_poses;
  double start_time = 0;
  double linearized_time = 0;  ///< of J at the end of the last step, which set_time() has rounded anew

 private:
  const World& world_;
  const ConstraintSystem& system_;
  Springs springs_;
};

}  // namespace taut
