#include "solvers/integrators/kick_works.h"

#include <cmath>

namespace taut {

KickWorks::KickWorks(const World& world, const ConstraintSystem& system, Springs springs)
    : world_(world), system_(system), springs_(springs), has_drivers_(system.rows().depends_on_time()) {
  mean_twists_.resize(world.body_count());
  for (int b = 0; b < system.mass().size(); ++b)
    has_split_flow_ = has_split_flow_ || (!system.mass()[b].fixed && system.mass()[b].symmetry_axis < 0);
}

/// Calls `visit(b, ½ (V₀ + V₁))` for the moving bodies.
template <typename Visit>
void KickWorks::with_mean_twists(std::span<const Wrench> from, std::span<const Wrench> to,
                                 Visit&& visit) const {
  for (int b = 0; b < world_.body_count(); ++b)
    if (system_.inverse_mass(b).moves()) visit(b, mean_twist(b, from[b], to[b]));
}

void KickWorks::add(const Kick& kick, std::span<const Wrench> forces, double h, StepWorks& works) {
  double of_joints = 0, of_forces = 0;
  with_mean_twists(kick.from, kick.to, [&](int b, const Twist& V) {
    const Wrench force = 0.5 * h * forces[b];
    of_forces += dot(force, V);
    of_joints += dot(kick.to[b] - kick.from[b] - force, V);
  });
  works.constraint += of_joints;
  works.forces += of_forces;
  if (world_.has_dissipative_forces(springs_)) {
    dissipative_.assign(world_.body_count(), Wrench{});
    world_.add_dissipative_forces(kick.state, dissipative_, springs_);
    with_mean_twists(kick.from, kick.to,
                     [&](int b, const Twist& V) { works.dissipative += 0.5 * h * dot(dissipative_[b], V); });
  }
  if (!has_drivers_) return;
  mean_rates_.resize(system_.row_count());
  mean_rates(kick.from, kick.to, kick.jacobian, mean_rates_);
  for (int r = 0; r < system_.row_count(); ++r)
    if (system_.rows().row(r).store->depends_on_time()) works.drivers += kick.lambda[r] * mean_rates_[r];
}

void KickWorks::add_between(std::span<const Wrench> from, std::span<const Wrench> to, double& work) const {
  with_mean_twists(from, to, [&](int b, const Twist& V) { work += dot(to[b] - from[b], V); });
}

double KickWorks::kinetic_energy(std::span<const Wrench> momenta) const {
  double energy = 0;
  with_mean_twists(momenta, momenta, [&](int b, const Twist& V) { energy += 0.5 * dot(momenta[b], V); });
  return energy;
}

double KickWorks::if_seen(double energy, std::span<const Wrench> momenta) const {
  return std::abs(energy) > KickWorksTuning::kUnseenEnergy * kinetic_energy(momenta) ? energy : 0;
}

void KickWorks::mean_rates(std::span<const Wrench> from, std::span<const Wrench> to,
                           std::span<const double> jacobian, std::span<double> out) {
  for (int b = 0; b < world_.body_count(); ++b) mean_twists_[b] = mean_twist(b, from[b], to[b]);
  system_.rows().apply(jacobian, mean_twists_, out);
}

double KickWorks::split_flow(std::span<const Wrench> momenta, std::span<const Pose> from,
                             std::span<const Pose> to) const {
  if (!has_split_flow_) return 0;
  return spin_energy(momenta, to, Bodies::kSplit) - spin_energy(momenta, from, Bodies::kSplit);
}

double KickWorks::spin_energy(std::span<const Wrench> momenta, std::span<const Pose> poses,
                              Bodies which) const {
  double energy = 0;
  for (int b = 0; b < world_.body_count(); ++b) {
    const MassMatrix::Body& body = system_.mass()[b];
    if (body.fixed || (which == Bodies::kSplit && body.symmetry_axis >= 0)) continue;
    const Quat q = body.principal ? poses[b].q : Quat(poses[b].q * system_.mass().inertia(b).q_BP);
    const Vec3 m = q.conjugate() * momenta[b].torque;
    energy += 0.5 * m.cwiseAbs2().dot(body.inverse_moments);
  }
  return energy;
}

}  // namespace taut
