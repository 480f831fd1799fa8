#pragma once

#include <span>
#include <vector>

#include "core/state/state.h"
#include "core/world/world.h"

/// Laws that a run is judged by: energies and momenta (core/world, Eq. 2), joint gaps.
namespace taut {

class Rows;

/// How far a joint is open: norm of its translation rows and of its rotation rows.  Axis rows and rows that a
/// compliance softens do not count.
struct Gap {
  double metres = 0;   ///< largest ‖φ‖ of its translation rows
  double radians = 0;  ///< largest ‖φ‖ of its rotation rows
};

/// Gaps of all joints from the residual φ of all rows [m or rad]: one entry per joint of `rows`.
std::vector<Gap> joint_gaps(const Rows& rows, std::span<const double> phi);
/// Largest gap over all joints, from φ as for joint_gaps(), without allocating.  A residual that is not a
/// number shows as a gap that is not one.
Gap max_gap(const Rows& rows, std::span<const double> phi);

/// Angular momentum about the centre of mass [N·m·s], world axes: I_W ω = R_WB I_B R_BW ω.
Vec3 angular_momentum_about_centre(const MassProperties& mass, const Pose& pose, const Vec3& w);

/// Kinetic energy of all bodies [J]: Σ ½ m v² + ½ ω·Iω.
double kinetic_energy(const World& world, const State& state);
/// Kinetic energy plus gravity's and the force laws' potential [J].
double total_energy(const World& world, const State& state);
/// Linear momentum of all bodies [N·s], world axes: Σ m v.
Vec3 linear_momentum(const World& world, const State& state);
/// Angular momentum of all bodies about a world point [N·m·s]: Σ (p − about) × m v + I ω.
Vec3 angular_momentum(const World& world, const State& state, const Vec3& about = Vec3::Zero());

}  // namespace taut
