#include "solvers/step_report.h"

#include "core/rows.h"

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

std::vector<std::string> names_of(std::span<const DependentRow> rows, const World& world) {
  std::vector<std::string> names;
  if (rows.empty()) return names;
  const Rows all(world);
  for (const DependentRow& row : rows) {
    const Rows::JointRows& joint = all.joints()[row.joint.index];
    if (row.row >= joint.row_count) continue;  // it has left since
    names.push_back(std::string(world.joint(row.joint).type()) + " " + world.name(row.joint) + ": " +
                    all.row_name(joint.first_row + row.row));
  }
  return names;
}

}  // namespace taut
