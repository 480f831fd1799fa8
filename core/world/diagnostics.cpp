#include "core/world/diagnostics.h"

#include <cmath>

#include "core/constraints/rows.h"

namespace taut {
namespace {

/// Squares of a joint's gap [m², rad²].
Gap squared_gap(const Rows& rows, const Rows::JointRows& joint, std::span<const double> phi) {
  Gap square;
  for (int r = joint.first_row; r < joint.first_row + joint.equality_count; ++r) {
    const Rows::Unit unit = rows.gap_unit(r);
    if (unit != Rows::Unit::kNone)
      (unit == Rows::Unit::kRadian ? square.radians : square.metres) += phi[r] * phi[r];
  }
  return square;
}

Gap root(const Gap& square) { return {std::sqrt(square.metres), std::sqrt(square.radians)}; }

}  // namespace

std::vector<Gap> joint_gaps(const Rows& rows, std::span<const double> phi) {
  std::vector<Gap> gaps;
  gaps.reserve(rows.joints().size());
  for (const Rows::JointRows& joint : rows.joints()) gaps.push_back(root(squared_gap(rows, joint, phi)));
  return gaps;
}

Gap max_gap(const Rows& rows, std::span<const double> phi) {
  Gap worst;
  for (const Rows::JointRows& joint : rows.joints()) {
    const Gap gap = squared_gap(rows, joint, phi);
    // Written so that a NaN, once met, stays.
    if (!(gap.metres <= worst.metres) && worst.metres == worst.metres) worst.metres = gap.metres;
    if (!(gap.radians <= worst.radians) && worst.radians == worst.radians) worst.radians = gap.radians;
  }
  return root(worst);
}

Vec3 angular_momentum_about_centre(const MassProperties& mass, const Pose& pose, const Vec3& w) {
  return pose.q * (mass.inertia_B() * (pose.q.conjugate() * w));
}

double kinetic_energy(const World& world, const State& state) {
  double energy = 0;
  for (int b = 0; b < world.body_count(); ++b) {
    if (world.is_fixed(BodyId{b})) continue;
    const MassProperties& mass = world.mass_properties(BodyId{b});
    const Twist& V = state.twists[b];
    energy += 0.5 * mass.mass() * V.v.squaredNorm() +
              0.5 * V.w.dot(angular_momentum_about_centre(mass, state.poses[b], V.w));
  }
  return energy;
}

double total_energy(const World& world, const State& state) {
  return kinetic_energy(world, state) + world.potential_energy(state);
}

Vec3 linear_momentum(const World& world, const State& state) {
  Vec3 momentum = Vec3::Zero();
  for (int b = 0; b < world.body_count(); ++b)
    if (!world.is_fixed(BodyId{b})) momentum += world.mass_properties(BodyId{b}).mass() * state.twists[b].v;
  return momentum;
}

Vec3 angular_momentum(const World& world, const State& state, const Vec3& about) {
  Vec3 momentum = Vec3::Zero();
  for (int b = 0; b < world.body_count(); ++b) {
    if (world.is_fixed(BodyId{b})) continue;
    const MassProperties& mass = world.mass_properties(BodyId{b});
    momentum += (state.poses[b].p - about).cross(mass.mass() * state.twists[b].v) +
                angular_momentum_about_centre(mass, state.poses[b], state.twists[b].w);
  }
  return momentum;
}

}  // namespace taut
