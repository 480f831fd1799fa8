#pragma once

#include <span>
#include <vector>

#include "core/constraints/rows.h"
#include "core/state/state.h"
#include "core/world/world.h"

/// Laws that a run is judged by: energies and momenta (core/README, Eq. 13), joint gaps.
namespace taut {

/// How far a joint is open: norm of its translation rows and of its rotation rows.  Axis rows and rows that a
/// compliance softens do not count.
struct Gap {
  double metres = 0;
  double radians = 0;
};

/// One entry per joint from the residual φ of all rows.
std::vector<Gap> joint_gaps(const Rows& rows, std::span<const double> phi);
/// Largest over all joints, without allocating.  A residual that is not a number shows as a gap that is not
/// one.
Gap max_gap(const Rows& rows, std::span<const double> phi);

/// I_W ω = R_WB I_B R_BW ω.
Vec3 angular_momentum_about_centre(const MassProperties& mass, const Pose& pose, const Vec3& w);

/// Σ ½ m v² + ½ ω·Iω [J].
double kinetic_energy(const World& world, const State& state);
/// Kinetic energy plus gravity's and the force laws' potential [J].
double total_energy(const World& world, const State& state);
/// Σ m v [N·s].
Vec3 linear_momentum(const World& world, const State& state);
/// Σ (p − about) × m v + I ω [N·m·s].
Vec3 angular_momentum(const World& world, const State& state, const Vec3& about = Vec3::Zero());

}  // namespace taut
