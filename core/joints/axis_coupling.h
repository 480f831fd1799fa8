#pragma once

#include <utility>

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
  AxisCoupling(const World& world, const std::string& name, const Terms& terms);

  void append_rows(RowSink& rows) const override;
  Vec3 reaction_point_B() const override;
  int axes_needed() const override { return axes_needed_; }
  std::vector<JointId> couples() const override { return couples_; }
  /// Its axes, by their ids in the world that it was made for, and their factors.
  const Terms& terms() const { return terms_; }

 protected:
  row_parts::Coupling coupling_;  ///< its one row

 private:
  int axes_needed_ = 0;
  std::vector<JointId> couples_;
  Terms terms_;
};

}  // namespace taut
