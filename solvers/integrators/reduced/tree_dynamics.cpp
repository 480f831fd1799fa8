#include "solvers/integrators/reduced/tree_dynamics.h"

#include <vector>

#include "core/base/check.h"
#include "core/constraints/rows.h"
#include "solvers/integrators/reduced/closed_tree.h"
#include "solvers/system/mass_matrix.h"

namespace taut {

struct TreeDynamics::Impl {
  explicit Impl(const World& world)
      : rows(world, Rows::AxisRows::kLeftOut), mass(world), tree(world, rows, mass) {
    lambda.assign(rows.row_count(), 0);
  }

  Rows rows;
  MassMatrix mass;
  ClosedTree tree;
  std::vector<double> lambda;
};

TreeDynamics::TreeDynamics(const World& world) : impl_(std::make_unique<Impl>(world)) {}
TreeDynamics::~TreeDynamics() = default;

void TreeDynamics::linearize(const State& state) { impl_->tree.linearize(state); }

int TreeDynamics::freedoms() const { return impl_->tree.freedoms(); }

void TreeDynamics::accelerate(const State& state, std::span<const Wrench> forces, Method method,
                              std::span<Twist> accelerations) {
  impl_->tree.accelerate(state, forces, method, accelerations, impl_->lambda);
}

std::span<const double> TreeDynamics::multipliers(JointId joint) const {
  if (joint.index < 0 || joint.index >= impl_->rows.joint_count()) fail("joint", "is none", joint.index);
  const Rows::JointRows& block = impl_->rows.joints()[joint.index];
  return std::span(impl_->lambda).subspan(block.first_row, block.equality_count);
}

}  // namespace taut
