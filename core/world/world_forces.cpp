#include <cassert>

#include "core/base/check.h"
#include "core/world/world.h"
#include "core/world/world_parts.h"

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
  parts_->identity.require_free();
  check_force(*this, force.get());
  wake_or_all(force->bodies());
  if (detail::has_rows(*force)) ++parts_->versions.topology;
  parts_->forces.add(std::move(force));
  ++parts_->versions.state;
  return {force_count() - 1};
}

void World::set_force(ForceId id, std::shared_ptr<const Force> force) {
  parts_->identity.require_free();
  const int index = parts_->forces.checked(id);
  check_force(*this, force.get());
  const Force& before = parts_->forces[index];
  wake_or_all(before.bodies());
  wake_or_all(force->bodies());
  if (detail::has_rows(before) || detail::has_rows(*force))
    ++(detail::has_same_rows(before, *force) ? parts_->versions.axes : parts_->versions.topology);
  parts_->forces.set(index, std::move(force));
  ++parts_->versions.state;
}

void World::set_gravity(const Vec3& gravity) {
  parts_->identity.require_free();
  require_all_finite("gravity", gravity);
  gravity_ = gravity;
  wake_all();
  ++parts_->versions.state;
}

void World::forces(const State& state, std::span<Wrench> wrenches, Springs springs) const {
  assert(static_cast<int>(wrenches.size()) == body_count());
  assert(state.poses.size() == state_.poses.size() && state.twists.size() == state_.twists.size());
  const Hold held = hold();
  for (int b = 0; b < body_count(); ++b) {
    wrenches[b].torque.setZero();
    wrenches[b].force =
        parts_->bodies.is_fixed(b) ? Vec3(Vec3::Zero()) : Vec3(parts_->bodies.mass(b).mass() * gravity_);
  }
  parts_->forces.accumulate(state, wrenches, springs);
}

double World::add_dissipative_forces(const State& state, std::span<Wrench> wrenches, Springs springs) const {
  const Hold held = hold();
  return parts_->forces.accumulate_dissipative(state, wrenches, springs);
}

double World::potential_energy(const State& state) const {
  const Hold held = hold();
  double energy = 0;
  for (int b = 0; b < body_count(); ++b)
    if (!parts_->bodies.is_fixed(b)) energy -= parts_->bodies.mass(b).mass() * gravity_.dot(state.poses[b].p);
  for (const auto& force : parts_->forces.all()) energy += force->potential_energy(state);
  for (int j = 0; j < joint_count(); ++j)
    if (parts_->joints.is_attached(j)) energy += spring_energy_of({j}, state);
  return energy;
}

double World::spring_energy(const State& state) const {
  const Hold held = hold();
  double energy = parts_->forces.spring_energy(state);
  for (int j = 0; j < joint_count(); ++j)
    if (parts_->joints.is_attached(j)) energy += spring_energy_of({j}, state);
  return energy;
}

std::span<const ForceId> World::springs() const { return parts_->forces.springs(); }

int World::force_count() const { return parts_->forces.count(); }
const Force& World::force(ForceId id) const { return parts_->forces[parts_->forces.checked(id)]; }
bool World::forces_depend_on_velocity(Springs springs) const {
  return parts_->forces.depend_on_velocity(springs);
}
bool World::has_dissipative_forces(Springs springs) const { return parts_->forces.are_dissipative(springs); }

}  // namespace taut
