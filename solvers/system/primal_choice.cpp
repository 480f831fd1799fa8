#include "solvers/system/primal_choice.h"

namespace taut {
namespace {

/// Chosen, where nothing else is said.
struct PrimalChoiceTuning {
  /// Contact rows from which on the bodies may be the smaller system.  Half: 3.6 times the factorisations of
  /// a top-heavy stack, and up to 200 times the Newton steps of shapes at rest.
  static constexpr int kManyContactRows = 150;
  /// Axes with Coulomb friction from which on the active set has to give way to solves through the bodies.
  /// Twice: 2.2 times the back-solves of a net with friction.
  static constexpr int kManyFrictionAxes = 150;
};

/// What the dense blocks of S alone cost in a factor: each body has one of all its rows, and each row is in
/// about two of them.
double flops_of_dense_blocks(const Rows& rows, const MassMatrix& mass) {
  double flops = 0;
  for (int b = 0; b < rows.body_count(); ++b) {
    if (mass[b].fixed) continue;
    double height = 0;
    for (int s : rows.sides_of(b)) height += rows.sides()[s].row_count;
    flops += height * height * height / 6;
  }
  return flops;
}

}  // namespace

PrimalChoice::PrimalChoice(const World& world, const Rows& rows) {
  for (const Rows::AxisRow& row : rows.axis_rows())
    friction_axes_ += row.axis() && world.axis_properties(*row.axis()).friction.has_value();
}

void PrimalChoice::decide(const LinearizedRows& rows, PrimalSystem& primal) {
  primal_ = primal_pays(rows, primal);
}

bool PrimalChoice::primal_pays(const LinearizedRows& rows, PrimalSystem& primal) const {
  const bool friction_dominated = friction_axes_ >= PrimalChoiceTuning::kManyFrictionAxes;
  if (!friction_dominated &&
      rows.row_count() - rows.rows().first_contact_row() < PrimalChoiceTuning::kManyContactRows)
    return false;
  const double flops = primal.order(rows).flops;
  return friction_dominated || flops_of_dense_blocks(rows.rows(), rows.mass()) >= flops;
}

}  // namespace taut
