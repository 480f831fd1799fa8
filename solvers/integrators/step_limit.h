#pragma once

#include <limits>
#include <span>
#include <vector>

#include "core/base/union_find.h"
#include "core/world/world.h"
#include "solvers/common/settings.h"
#include "solvers/complementarity/stage_solver.h"
#include "solvers/laws/breaking.h"
#include "solvers/system/constraint_system.h"
#include "solvers/system/inverse_mass_root.h"

namespace taut {

class Archive;

/// Bound on the fastest frequency [rad/s] of M q̈ = −K q, with K the blocks of geometric stiffness of the
/// joint loads: the largest ω with ω² = |M⁻¹K| over the bodies.  For ball joints K is block diagonal and the
/// bound rigorous; a row of rods of mass m and length L under tension H gives ω² = 12 H / (m L).
/// `roots` are those of M⁻¹ = A Aᵀ.        (solvers/integrators, "Tension")
double fastest_transverse_frequency(std::span<const InverseMassRoot> roots,
                                    std::span<const StiffnessBlocks> stiffness);

/// The longest step from a state: ω h ≤ max_tension_number, with ω the fastest transverse frequency under the
/// loads of the rows, and a rotation below max_rotation of every body.           (solvers/integrators,
/// "Tension")
class StepLimit {
 public:
  /// All of them must outlive it.
  StepLimit(const World& world, ConstraintSystem& system, const Settings& settings, const AxisForces& axes,
            const Breaking& breaking, const StageSolver& stages);

  /// From the forces of the rows [N, N·m] at a state.
  void update(const State& state, std::span<const double> force_multipliers);
  /// That of both, where the other is from before.
  void tighten(double step, double omega) {
    step_ = std::min(step_, step);
    omega_ = std::max(omega_, omega);
  }
  double step() const { return step_; }    ///< [s]
  double omega() const { return omega_; }  ///< [rad/s]
  /// Friction has let go of an axis, and bodies that it held to the ground were left out.
  bool misses_freed_bodies() const;
  /// Of each body, geometric stiffness K of the loads.
  const std::vector<StiffnessBlocks>& stiffness() const { return stiffness_; }
  /// The body whose tension asks for the shortest step.
  BodyId stiffest() const;

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive);
  /// The stiffness is made anew; the rest stays as it was.
  void restore_stiffness(const State& state, std::span<const double> force_multipliers);

 private:
  void find_held_bodies();
  bool is_held(int body);
  void clear_held_bodies(int begin, int end);

  const World& world_;
  ConstraintSystem& system_;
  const Settings& settings_;
  const AxisForces& axes_;
  const Breaking& breaking_;
  const StageSolver& stages_;
  bool may_leave_out_ = false;
  double omega_ = 0, step_ = std::numeric_limits<double>::infinity();
  bool leaves_out_ = false;
  std::vector<StiffnessBlocks> stiffness_;
  std::vector<char> holding_rows_;
  UnionFind stuck_together_;  // bodies
};

}  // namespace taut
