#include "solvers/step_report.h"

#include <algorithm>

#include "core/rows.h"
#include "solvers/contradiction.h"

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

std::string name_of(const std::pair<ShapeId, ShapeId>& pair, const World& world) {
  const auto one = [&](ShapeId id) {
    const ShapeRecord& record = world.shape(id);
    return shape_name(*record.shape) + (" of " + world.name(record.body));
  };
  return one(pair.first) + " and " + one(pair.second);
}

std::string text_of(const Crowd& crowd, const World& world) {
  std::vector<std::string> names;  // a body may have several of the shapes
  for (const ShapeId shape : crowd.shapes) {
    const std::string& name = world.name(world.shape(shape).body);
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return "more than " + std::to_string(crowd.most) +
         " contacts or pairs of shapes near each other, which is beyond max_contacts; bodies " +
         list_of(names) + " have most of them: they lie in one place, or a step takes them past many others";
}

}  // namespace taut
