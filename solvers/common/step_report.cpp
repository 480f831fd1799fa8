#include "solvers/common/step_report.h"

namespace taut {

std::string_view to_string(Status status) {
  switch (status) {
    case Status::kSuccess:
      return "success";
    case Status::kInexact:
      return "inexact";
    case Status::kNotConverged:
      return "not converged";
    case Status::kContradiction:
      return "contradiction";
    case Status::kNotFinite:
      return "not finite";
    case Status::kInterrupted:
      return "interrupted";
    case Status::kCrowded:
      return "crowded";
  }
  return "unknown";
}

StageTimes& StageTimes::operator+=(const StageTimes& other) {
  for (auto stage :
       {&StageTimes::forces, &StageTimes::positions, &StageTimes::assembly, &StageTimes::factorization,
        &StageTimes::velocities, &StageTimes::analysis, &StageTimes::total})
    this->*stage += other.*stage;
  return *this;
}

EnergyLedger& EnergyLedger::operator+=(const EnergyLedger& next) {
  for (auto term :
       {&EnergyLedger::kinetic, &EnergyLedger::potential, &EnergyLedger::springs, &EnergyLedger::motors,
        &EnergyLedger::drivers, &EnergyLedger::friction, &EnergyLedger::limits, &EnergyLedger::contacts,
        &EnergyLedger::damping, &EnergyLedger::forces, &EnergyLedger::breaking, &EnergyLedger::stabilisation,
        &EnergyLedger::stiffness, &EnergyLedger::integration})
    this->*term += next.*term;
  return *this;
}

}  // namespace taut
