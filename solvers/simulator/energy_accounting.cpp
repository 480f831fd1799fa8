#include "solvers/simulator/energy_accounting.h"

#include "core/world/diagnostics.h"

namespace taut {

EnergyAccounting::Energies EnergyAccounting::measure(const World& world, const State& state, double kinetic) {
  Energies energies{kinetic, 0, world.spring_energy(state), 0};
  energies.potential = world.potential_energy(state) - energies.springs;
  if (world.has_dissipative_forces(springs_)) {
    scratch_.assign(world.body_count(), Wrench{});
    energies.dissipative = world.add_dissipative_forces(state, scratch_, springs_);
  }
  return energies;
}

void EnergyAccounting::begin(const World& world, const World& seen, StepReport& report) {
  start_ = end_versions_ == versions(world) ? end_
                                            : measure(seen, seen.state(), kinetic_energy(seen, seen.state()));
  first_ = start_;
  report.ledger.start = start_.total();
  stabilisation_ = 0;
}

void EnergyAccounting::start(const World& world, const State& state) {
  const double before = start_.total();
  start_ = measure(world, state, kinetic_energy(world, state));
  stabilisation_ += start_.total() - before;
}

void EnergyAccounting::close(const World& world, StepReport& report, bool by_works) {
  end_ = measure(world, world.state(), report.kinetic_energy);
  end_versions_ = versions(world);
  report.potential_energy = end_.potential;
  report.spring_energy = end_.springs;
  EnergyLedger& ledger = report.ledger;
  ledger.kinetic = end_.kinetic - first_.kinetic;
  ledger.potential = end_.potential - first_.potential;
  ledger.springs = end_.springs - first_.springs;
  if (!by_works) {  // an integrator that knows no works
    ledger.integration = end_.total() - ledger.start;
    return;
  }
  double lost = 0;  // stored in joints that broke
  for (const BreakEvent& event : report.breaks) lost += event.energy;
  const AxisImpulse& axes = report.works.axes;
  const double dissipative = end_.dissipative - start_.dissipative;
  ledger.stabilisation = stabilisation_;
  double ideal = report.works.constraint - report.works.drivers;  // and of what stores energy
  for (const auto& [part, column, term] : kAxisParts) (term ? ledger.*term : ideal) += axes.*part;
  ledger.drivers = report.works.drivers;
  ledger.friction += report.works.contacts.friction;
  ledger.contacts = report.works.contacts.normal;
  ledger.forces = report.works.dissipative + dissipative;
  ledger.breaking = -lost;
  ledger.stiffness = report.works.stiffness;
  // To what the free flow has left there comes what no other term has.
  ledger.integration += ideal + (report.works.forces - report.works.dissipative) +
                        (end_.stored() + lost - start_.stored()) - dissipative;
}

}  // namespace taut
