#include <cassert>

#include "core/base/check.h"
#include "core/world/world.h"

// Gravity, force laws, and the energies that they state.
namespace taut {
namespace {

void check_force(const World& world, const Force* force) {
  if (!force) fail("force", "must not be null", "null");
  for (BodyId body : force->bodies())
    if (body.index < 0 || body.index >= world.body_count()) fail("force", "no such body", body.index);
}

}  // namespace

ForceId World::add_force(std::shared_ptr<const Force> force) {
  identity_.require_free();
  check_force(*this, force.get());
  wake_or_all(force->bodies());
  if (detail::has_rows(*force)) ++versions_.topology;
  forces_.add(std::move(force));
  ++versions_.state;
  return {force_count() - 1};
}

void World::set_force(ForceId id, std::shared_ptr<const Force> force) {
  identity_.require_free();
  const int index = forces_.checked(id);
  check_force(*this, force.get());
  const Force& before = forces_[index];
  wake_or_all(before.bodies());
  wake_or_all(force->bodies());
  if (detail::has_rows(before) || detail::has_rows(*force))
    ++(detail::has_same_rows(before, *force) ? versions_.axes : versions_.topology);
  forces_.set(index, std::move(force));
  ++versions_.state;
}

void World::set_gravity(const Vec3& gravity) {
  identity_.require_free();
  require_all_finite("gravity", gravity);
  gravity_ = gravity;
  wake_all();
  ++versions_.state;
}

void World::forces(const State& state, std::span<Wrench> wrenches, Springs springs) const {
  assert(static_cast<int>(wrenches.size()) == body_count());
  assert(state.poses.size() == state_.poses.size() && state.twists.size() == state_.twists.size());
  const Hold held = hold();
  for (int b = 0; b < body_count(); ++b) {
    wrenches[b].torque.setZero();
    wrenches[b].force = bodies_.is_fixed(b) ? Vec3(Vec3::Zero()) : Vec3(bodies_.mass(b).mass() * gravity_);
  }
  forces_.accumulate(state, wrenches, springs);
}

double World::add_dissipative_forces(const State& state, std::span<Wrench> wrenches, Springs springs) const {
  const Hold held = hold();
  return forces_.accumulate_dissipative(state, wrenches, springs);
}

double World::potential_energy(const State& state) const {
  const Hold held = hold();
  double energy = 0;
  for (int b = 0; b < body_count(); ++b)
    if (!bodies_.is_fixed(b)) energy -= bodies_.mass(b).mass() * gravity_.dot(state.poses[b].p);
  for (const auto& force : forces_.all()) energy += force->potential_energy(state);
  for (int j = 0; j < joint_count(); ++j)
    if (joints_.is_attached(j)) energy += spring_energy_of({j}, state);
  return energy;
}

double World::spring_energy(const State& state) const {
  const Hold held = hold();
  double energy = forces_.spring_energy(state);
  for (int j = 0; j < joint_count(); ++j)
    if (joints_.is_attached(j)) energy += spring_energy_of({j}, state);
  return energy;
}

std::span<const ForceId> World::springs() const { return forces_.springs(); }

}  // namespace taut
