// What reports say in the names of the World: names_of(), name_of(), text_of() of step_report.h.
#include "solvers/common/report_names.h"

#include <algorithm>

#include "core/constraints/rows.h"

namespace taut {
namespace {

std::string label(const World& world, const Contradiction::Bound& bound) {
  const char* kinds[] = {"lower limit of ", "upper limit of ", "motor of "};
  return std::string(kinds[static_cast<int>(bound.kind)])
      .append(world.joint(bound.axis.joint).type())
      .append(" ")
      .append(world.axis_label(bound.axis));
}

}  // namespace

std::vector<std::string> names_of(const Contradiction& contradiction, const World& world) {
  std::vector<std::string> names;
  for (JointId joint : contradiction.joints)
    names.push_back(std::string(world.joint(joint).type()) + " " + world.name(joint));
  for (const Contradiction::Bound& bound : contradiction.bounds) names.push_back(label(world, bound));
  for (const Contradiction::Touch& touch : contradiction.contacts)
    names.push_back("contact of " + world.name(touch.a) + " and " + world.name(touch.b));
  return names;
}

std::string name_of(const Culprit& culprit, const World& world) {
  const auto law = [&] {
    std::vector<BodyId> bodies = world.force(culprit.force).bodies();
    std::string text;
    for (std::size_t i = 0; i < bodies.size(); ++i) text += (i > 0 ? " and " : "") + world.name(bodies[i]);
    return text;
  };
  switch (culprit.kind) {
    case Culprit::Kind::kJoint:
      return std::string(world.joint(culprit.axis.joint).type()) + " " + world.name(culprit.axis.joint);
    case Culprit::Kind::kAxis:
      return std::string(world.joint(culprit.axis.joint).type()) + " " + world.axis_label(culprit.axis);
    case Culprit::Kind::kSpring:
      return "spring between " + law();
    case Culprit::Kind::kContact:
      return "contact of " + world.name(culprit.a) + " and " + world.name(culprit.b);
    case Culprit::Kind::kForce: {
      const std::string bodies = law();
      return "force law " + std::to_string(culprit.force.index) + (bodies.empty() ? "" : " on " + bodies);
    }
    case Culprit::Kind::kBody:
      return "body " + world.name(culprit.a);
  }
  return "";
}

std::string list_of(const std::vector<std::string>& names) {
  constexpr std::size_t kShown = 8;
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < (names.size() > kShown ? kShown - 1 : kShown); ++i)
    text += (i > 0 ? ", " : "") + names[i];
  if (names.size() > kShown) text += " … " + names.back() + ", " + std::to_string(names.size()) + " in all";
  return text;
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
