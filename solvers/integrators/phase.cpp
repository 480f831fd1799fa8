#include "solvers/integrators/phase.h"

#include <cmath>
#include <utility>

#include "core/constraints/row_products.h"
#include "core/state/reach.h"

namespace taut {

Phase::Phase(const World& world, const ConstraintSystem& system, Springs springs)
    : world_(world), system_(system), springs_(springs) {
  for (auto* wrenches : {&momenta, &start_momenta, &forces, &kicked}) wrenches->resize(world.body_count());
}

void Phase::twists_from(std::span<const Wrench> momenta_now) {
  for (int b = 0; b < world_.body_count(); ++b)
    if (system_.inverse_mass(b).moves()) state.twists[b] = system_.inverse_mass(b).twist(momenta_now[b]);
}

void Phase::add_impulses(std::span<const double> mu) {
  for (int b = 0; b < world_.body_count(); ++b)
    if (system_.inverse_mass(b).moves())
      momenta[b] = momenta[b] + detail::wrench_on(system_.rows(), b, system_.jacobian(), mu);
}

Configuration Phase::trial_end(double h) const {
  return {trial_poses, state.time + h, state.axes, state.poses};
}

Configuration Phase::accepted_end() const { return {state.poses, state.time, state.axes, start_poses}; }

void Phase::accept(double h) {
  std::swap(start_poses, state.poses);
  std::swap(state.poses, trial_poses);
  std::swap(momenta, start_momenta);
  start_time = state.time;
  state.time += h;
}

void Phase::take_back() {
  std::swap(trial_poses, state.poses);
  std::swap(state.poses, start_poses);
  std::swap(momenta, start_momenta);
  state.time = start_time;
}

/// A sum is finite if and, short of overflow, only if all its terms are.
bool Phase::finite() const {
  double sum = 0;
  bool near = true;
  for (int b = 0; b < world_.body_count(); ++b) {
    sum += std::abs(momenta[b].torque.sum()) + std::abs(momenta[b].force.sum()) +
           std::abs(state.poses[b].q.coeffs().sum());
    near = near && within_reach(state.poses[b], state.twists[b]);
  }
  return near && std::isfinite(sum);
}

void Phase::second_kick(double h) {
  for (int b = 0; b < world_.body_count(); ++b)
    if (system_.inverse_mass(b).moves()) second_kick(b, h);
}

}  // namespace taut
