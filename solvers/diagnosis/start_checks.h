#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "collision/narrow/contact.h"
#include "core/world/world.h"
#include "solvers/common/settings.h"

/// What can be said of a world before its first step.
namespace taut {

/// Velocities that joints forbid.  Where a step begins with J V + φ_t = 0 they are taken away by the least
/// impulses, without a trace in its report.
struct ForbiddenVelocity {
  double speed = 0, spin = 0;   ///< largest change of a body's v [m/s] and ω [rad/s]
  std::vector<JointId> joints;  ///< those with |J V + φ_t| of more than 1e-6 of what adds up to it
  bool empty() const { return joints.empty(); }
};
/// Rows that only drivers move, from rest, do not count.
ForbiddenVelocity forbidden_velocity(const World& world);

/// A spring between bodies and the frequency ω [rad/s] with which it and they alone swing, along its line or,
/// if its ends may meet, in the direction that is fastest.
struct SpringFrequency {
  ForceId spring;
  double omega = 0;
};
/// Those of the present state with ω h > 2, fastest first: schemes that take springs as forces gain energy
/// from them without end.
std::vector<SpringFrequency> too_fast_springs(const World& world, double h);

/// Two bodies that are in each other by `depth` [m], the deepest of their contacts.
struct StartOverlap {
  BodyId a, b;
  double depth = 0;
};
/// Those of the present state by more than a hundredth of the radius of gyration of the smaller one, deepest
/// first.  Steps take them apart at no more than 1 m/s.
std::vector<StartOverlap> start_overlaps(const World& world);
/// Those of the present state by more than `depth` [m], deepest first.
std::vector<StartOverlap> overlaps_deeper_than(double depth, const World& world);

/// Pairs of shapes that may touch and have no law for it: they pass through each other.
struct UnsupportedPairs {
  std::vector<std::pair<ShapeId, ShapeId>> first;  ///< the first 100
  std::int64_t count = 0;
};
/// Wherever they are.
UnsupportedPairs unsupported_pairs(const World& world);

/// More contacts, or pairs near each other, than the first step of dt takes on; empty: it does.
Crowd start_crowd(const World& world, const Settings& settings, double dt);

/// The distance [m] of neighbouring numbers at the coordinate of a body that is farthest from 0: no joint can
/// be closed much better.
double coarsest_position(const World& world);

}  // namespace taut
