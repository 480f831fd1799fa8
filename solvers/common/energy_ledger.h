#pragma once

#include <string_view>

namespace taut {

/// Where the energy of a step went [J], E = kinetic + potential + springs:
///   E_end − E_start = motors + drivers + friction + limits + contacts + damping + forces + breaking
///                     + events + stabilisation + stiffness + integration = changes of the kinetic, the
///                     potential and the springs' energy,
/// which closes to round-off, since every term is the work of impulses against the mean of the rates before
/// and after them.
struct EnergyLedger {
  double start = 0;      ///< E before the step
  double kinetic = 0;    ///< change of the kinetic energy
  double potential = 0;  ///< change of the potential energy of gravity and other force laws
  double springs = 0;    ///< change of what springs, soft limits and soft joints store
  double motors = 0;     ///< work of motors of axes
  double drivers = 0;    ///< work of joints that follow the time
  double friction = 0;   ///< work of Coulomb, rolling and spinning friction in axes and contacts
  double limits = 0;     ///< work of rigid limits: losses of impacts
  double contacts = 0;   ///< work of normal impulses of contacts: losses of impacts
  double damping = 0;    ///< work of dampers and viscous friction of axes and joints
  double forces = 0;     ///< work of force laws that are not conservative, beyond their own potential
  double breaking = 0;   ///< energy of springs in joints that broke
  /// What events changed at once: energy of springs that left or came with joints, the potential of another
  /// gravity, and what a joint took that was attached to moving bodies, as a plastic impact does.
  double events = 0;
  double stabilisation = 0;  ///< by closing joints and making velocities tangent before the step
  double stiffness = 0;      ///< taken by implicit geometric stiffness
  /// What is left: work of ideal joints and conservative forces that is not undone by their potential.
  double integration = 0;

  /// Adds all but the start.
  EnergyLedger& operator+=(const EnergyLedger& next);
  /// E_end − E_start by what is stored; total() but for round-off.
  double change() const { return kinetic + potential + springs; }
  double total() const;  ///< E_end − E_start by what acted
  /// The part of total() that no motor, driver, friction, limit, contact, damper, force, break or event
  /// explains, but the method: stabilisation + stiffness + integration.
  double unexplained() const { return stabilisation + stiffness + integration; }
};

/// A term of the ledger.
struct LedgerTerm {
  std::string_view name;         ///< as in reports of the program
  double EnergyLedger::*amount;  ///< the member [J]
  bool stored = false;           ///< a term of change(), else of total()
};
/// All terms of an EnergyLedger but its start, in the order of reports.
inline constexpr LedgerTerm kLedgerTerms[] = {
    {"kinetic", &EnergyLedger::kinetic, true},
    {"potential", &EnergyLedger::potential, true},
    {"springs", &EnergyLedger::springs, true},
    {"motors", &EnergyLedger::motors},
    {"drivers", &EnergyLedger::drivers},
    {"friction", &EnergyLedger::friction},
    {"limits", &EnergyLedger::limits},
    {"contacts", &EnergyLedger::contacts},
    {"damping", &EnergyLedger::damping},
    {"forces", &EnergyLedger::forces},
    {"breaking", &EnergyLedger::breaking},
    {"events", &EnergyLedger::events},
    {"stabilisation", &EnergyLedger::stabilisation},
    {"stiffness", &EnergyLedger::stiffness},
    {"integration", &EnergyLedger::integration},
};

}  // namespace taut
