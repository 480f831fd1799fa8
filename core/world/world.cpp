#include "core/world/world.h"

#include <sstream>

#include "core/base/check.h"
#include "core/constraints/rows.h"
#include "core/world/diagnostics.h"

namespace taut {
namespace {

/// Rigid limits that axes of a joint are beyond by more than a tolerance: they come back at a bounded rate.
void add_passed_limits(const World& world, JointId joint, double tolerance, std::vector<Problem>& problems) {
  for (int k = 0; k < world.axis_count(joint) && world.is_attached(joint); ++k) {
    const AxisId axis{joint, k};
    const std::optional<AxisLimits>& limits = world.axis_properties(axis).limits;
    if (!limits || limits->compliance > 0) continue;
    const double value = world.axis_value(axis);
    const bool low = value < limits->lower - tolerance;
    if (!low && !(value > limits->upper + tolerance)) continue;
    std::ostringstream message;
    message << "axis " << world.axis_info(axis).name << " starts at " << value << ", "
            << (low ? "below its lower limit " : "above its upper limit ")
            << (low ? limits->lower : limits->upper);
    problems.push_back({std::string(world.joint(joint).type()) + " " + world.name(joint), message.str()});
  }
}

}  // namespace

World::World() {
  BodySpec ground;
  ground.name = "ground";
  ground.fixed = true;
  add_body(ground);
}

std::vector<Problem> World::validate(double gap_tolerance) const {
  std::vector<Problem> problems;
  const Rows rows(*this);
  std::vector<double> phi(rows.row_count());
  rows.residual(state_, phi);
  const std::vector<Gap> gaps = joint_gaps(rows, phi);
  for (int j = 0; j < joint_count(); ++j) {
    std::ostringstream message;
    // Written so that a gap that is not a number counts as open.
    if (!(gaps[j].metres <= gap_tolerance)) message << "is open at the start by " << gaps[j].metres << " m";
    if (!(gaps[j].radians <= gap_tolerance))
      message << (message.tellp() > 0 ? " and " : "is open at the start by ") << gaps[j].radians << " rad";
    if (message.tellp() > 0)
      problems.push_back({std::string(joints_[j].type()) + " " + name(JointId{j}), message.str()});
    add_passed_limits(*this, JointId{j}, gap_tolerance, problems);
  }
  return problems;
}

}  // namespace taut
