#include "core/world/world.h"

#include <sstream>

#include "core/base/check.h"
#include "core/constraints/rows.h"
#include "core/world/diagnostics.h"
#include "core/world/world_parts.h"

namespace taut {
namespace {

/// What axes of a joint violate by more than a tolerance, as rigid limits: they come back at a bounded rate.
void add_axis_problems(const World& world, JointId joint, double tolerance, std::vector<Problem>& problems) {
  for (int k = 0; k < world.axis_count(joint) && world.is_attached(joint); ++k) {
    const AxisId axis{joint, k};
    world.axis_properties(axis).each([&](const auto& property) {
      if constexpr (requires { property.start_problem(0.0, tolerance); }) {
        const std::string message = property.start_problem(world.axis_value(axis), tolerance);
        if (message.empty()) return;
        problems.push_back({std::string(world.joint(joint).type()) + " " + world.name(joint),
                            "axis " + world.axis_info(axis).name + " " + message});
      }
    });
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
      problems.push_back({std::string(parts_->joints[j].type()) + " " + name(JointId{j}), message.str()});
    add_axis_problems(*this, JointId{j}, gap_tolerance, problems);
  }
  return problems;
}

World::Hold::Hold(const World& world) : world_(world.parts_->identity) { world_.hold(); }
World::Hold::~Hold() { world_.release(); }

std::uint64_t World::identity() const { return parts_->identity.value(); }
std::int64_t World::topology_version() const { return parts_->versions.topology; }
std::int64_t World::state_version() const { return parts_->versions.state; }
std::int64_t World::axis_version() const { return parts_->versions.axes; }
std::int64_t World::geometry_version() const { return parts_->versions.geometry; }
std::int64_t World::sleep_version() const { return parts_->versions.sleep; }

}  // namespace taut
