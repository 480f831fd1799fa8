#pragma once

#include <algorithm>
#include <utility>

#include "core/base/check.h"
#include "core/constraints/wide_parts.h"
#include "core/world/world.h"

namespace taut {

/// A linear relation between free axes of joints that are there already, in one row
/// (core/joints, Eq. 14):
///   φ = Σ c_k θ_k − offset [unit of the last axis], closed where it is made.
/// The base of Gear, RackAndPinion, Differential and Driver.  Angles count turns.  Its bodies are those of
/// the axes; B is the second body of the last axis.  c_k λ acts along axis k, from the first body of its
/// joint on the second.
class AxisCoupling : public Joint {
 public:
  using Terms = std::vector<std::pair<AxisId, double>>;  ///< axes and their factors c_k

  /// @throws std::invalid_argument if an axis is not in the world or a factor not finite or 0.
  AxisCoupling(const World& world, const std::string& name, const Terms& terms)
      : Joint(bodies_of(world, terms)) {
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

  void append_rows(RowSink& rows) const override { rows.add(coupling_); }
  Vec3 reaction_point_B() const override { return Vec3::Zero(); }
  int axes_needed() const override { return axes_needed_; }
  std::vector<JointId> couples() const override { return couples_; }

 protected:
  row_parts::Coupling coupling_;  ///< its one row

 private:
  static std::vector<BodyId> bodies_of(const World& world, const Terms& terms) {
    std::vector<BodyId> bodies;
    for (const auto& [axis, factor] : terms)
      for (int body : world.axis_info(axis).bodies)
        if (std::find(bodies.begin(), bodies.end(), BodyId{body}) == bodies.end()) bodies.push_back({body});
    const BodyId last{world.axis_info(terms.back().first).bodies[1]};
    std::iter_swap(bodies.begin() + 1, std::find(bodies.begin(), bodies.end(), last));
    return bodies;
  }
  int axes_needed_ = 0;
  std::vector<JointId> couples_;
};

}  // namespace taut
