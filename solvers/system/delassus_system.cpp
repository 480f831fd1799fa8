#include "solvers/system/delassus_system.h"

#include <algorithm>

namespace taut {

DelassusSystem::DelassusSystem(const LinearizedRows& rows, FactorChoice choice, const FactorMeans& means)
    : DelassusSystem(
          rows, order_blocks(joint_graph(rows.rows(), rows.mass()), rows.lasts() ? means.orders : nullptr),
          choice, means) {}

DelassusSystem::DelassusSystem(const LinearizedRows& rows, const BlockOrdering& ordering, FactorChoice choice,
                               const FactorMeans& means)
    : factor_(make_factor(choice, ordering, rows.row_count(), means)),
      matrix_(rows.rows(), rows.mass(), ordering, factor_->triangle()) {
  factor_->analyze(matrix_.matrix());
  const int n = rows.row_count();
  ordered_.assign(n, 0.0);
  masked_weighted_.reserve(rows.rows().whole_size());
  row_at_position_.resize(n);
  for (int r = 0; r < n; ++r) row_at_position_[matrix_.position_of_row()[r]] = r;
}

void DelassusSystem::assemble(const LinearizedRows& rows, const Rows::BodyChunk& chunk) {
  matrix_.assemble(rows.rows(), rows.jacobian(), rows.mass_roots(), chunk.settled_begin, chunk.settled_end);
  assembled_version_ = rows.weight_version();
}

void DelassusSystem::assemble(LinearizedRows& rows, const RowStates& states, double shift) {
  if (assembled_version_ == rows.weight_version() && states.all_free() && shift == 0) return;
  assembled_version_ = -1;
  if (!states.all_free())
    matrix_.assemble(rows.rows(), masked_weighted(rows, states), shift, states.values());
  else if (rows.full_roots().empty())
    matrix_.assemble<InverseMassRoot>(rows.rows(), rows.jacobian(), rows.mass_roots(), shift);
  else
    matrix_.assemble<FullMassRoot>(rows.rows(), rows.jacobian(), rows.full_roots(), shift);
}

/// A copy of W whose masked rows are zero: S of it has the pattern of S and only a diagonal there.
std::span<const double> DelassusSystem::masked_weighted(LinearizedRows& rows, const RowStates& states) {
  const std::span<const double> W = rows.weighted();
  masked_weighted_.assign(W.begin(), W.end());
  for (const Rows::Side& side : rows.rows().sides())
    for (int i = 0; i < side.row_count; ++i)
      if (states[side.first_row + i] == kMasked)
        std::fill_n(masked_weighted_.begin() + side.whole + 6 * i, 6, 0.0);
  return masked_weighted_;
}

void DelassusSystem::solve(std::span<double> x) {
  const std::span<const int> position = matrix_.position_of_row();
  for (std::size_t r = 0; r < x.size(); ++r) ordered_[position[r]] = x[r];
  factor_->solve(ordered_);
  for (std::size_t r = 0; r < x.size(); ++r) x[r] = ordered_[position[r]];
}

}  // namespace taut
