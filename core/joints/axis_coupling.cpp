#include "core/joints/axis_coupling.h"

#include <algorithm>
#include <utility>

#include "core/base/check.h"

namespace taut {
namespace {

std::vector<BodyId> bodies_of(const World& world, const AxisCoupling::Terms& terms) {
  std::vector<BodyId> bodies;
  for (const auto& [axis, factor] : terms)
    for (int body : world.axis_info(axis).bodies)
      if (std::find(bodies.begin(), bodies.end(), BodyId{body}) == bodies.end()) bodies.push_back({body});
  const BodyId last{world.axis_info(terms.back().first).bodies[1]};
  std::iter_swap(bodies.begin() + 1, std::find(bodies.begin(), bodies.end(), last));
  return bodies;
}

}  // namespace

AxisCoupling::AxisCoupling(const World& world, const std::string& name, const Terms& terms)
    : Joint(bodies_of(world, terms)), terms_(terms) {
  for (const auto& [axis, factor] : terms) {
    require_finite(name + " factor of " + world.axis_label(axis), factor);
    if (factor == 0) fail(name + " factor of " + world.axis_label(axis), "must not be 0", factor);
    const AxisInfo& info = world.axis_info(axis);
    row_parts::Coupling::Term term{factor, info.coordinate, {}};
    if (info.bodies.size() > row_parts::Coupling::kMaxBodies)
      fail(name + " axis " + world.axis_label(axis), "has too many bodies", info.bodies.size());
    for (int body : info.bodies)
      term.sides.push_back(
          static_cast<int>(std::find(bodies().begin(), bodies().end(), BodyId{body}) - bodies().begin()));
    coupling_.terms.push_back(std::move(term));
    coupling_.offset += factor * world.axis_value(axis);
    axes_needed_ = std::max(axes_needed_, world.axis_index(axis) + 1);
    couples_.push_back(axis.joint);
  }
  coupling_.is_angle = world.axis_info(terms.back().first).angular;
}

void AxisCoupling::append_rows(RowSink& rows) const { rows.add(coupling_); }

Vec3 AxisCoupling::reaction_point_B() const { return Vec3::Zero(); }

}  // namespace taut
