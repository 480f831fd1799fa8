#include "solvers/system/primal_system.h"

#include <algorithm>

#include "solvers/common/stopwatch.h"

namespace taut {

void PrimalSystem::forget_pattern() {
  matrix_.reset();
  ordering_.reset();
  ++version_;
}

const BlockOrdering& PrimalSystem::order(const LinearizedRows& rows) {
  if (!ordering_) {
    ordering_ = order_blocks(body_graph(rows.rows(), rows.mass(), body_of_node_),
                             rows.lasts() ? means_.orders : nullptr);
    factor_ = make_factor(choice_, *ordering_, 6 * static_cast<int>(body_of_node_.size()), means_);
  }
  return *ordering_;
}

void PrimalSystem::analyze(const LinearizedRows& rows) {
  const BlockOrdering& ordering = order(rows);
  matrix_ =
      std::make_unique<PrimalMatrix>(rows.rows(), rows.mass(), factor_->triangle(), ordering, body_of_node_);
  factor_->analyze(matrix_->matrix());
  ordered_.assign(matrix_->matrix().size(), 0.0);
}

bool PrimalSystem::factorize(std::span<const double> weighted, std::span<const double> D, StageTimes& times) {
  {
    const Stopwatch watch(times.assembly);
    matrix_->assemble(weighted, D);
  }
  const Stopwatch watch(times.factorization);
  ++version_;
  return factor_->factorize(matrix_->matrix()) < 0;
}

void PrimalSystem::solve(std::span<double> v) {
  const std::span<const int> position = matrix_->position_of_body();
  for (std::size_t b = 0; b < position.size(); ++b)
    if (position[b] >= 0) std::copy_n(v.begin() + 6 * b, 6, ordered_.begin() + position[b]);
  factor_->solve(ordered_);
  for (std::size_t b = 0; b < position.size(); ++b)
    if (position[b] >= 0) std::copy_n(ordered_.begin() + position[b], 6, v.begin() + 6 * b);
}

std::span<const double> PrimalSystem::regularize(LinearizedRows& rows, const RowStates& states,
                                                 double shift) {
  inverse_compliance_.resize(rows.row_count());
  rows.effective_masses(inverse_compliance_);
  for (int r = 0; r < rows.row_count(); ++r) {
    double& d = inverse_compliance_[r];
    const double diagonal = d > 0 ? 1 / d : 1, state = states[r];
    d = state == kMasked ? 0 : 1 / (state + shift * (diagonal + state));
  }
  return inverse_compliance_;
}

void PrimalSystem::solve_rows(LinearizedRows& rows, std::span<double> x) {
  body_values_.resize(6 * static_cast<std::size_t>(rows.mass().size()));
  rates_.resize(x.size());
  for (std::size_t r = 0; r < x.size(); ++r) x[r] *= inverse_compliance_[r];
  rows.apply_Wt(x, body_values_);
  solve(body_values_);
  rows.apply_W(body_values_, rates_);
  for (std::size_t r = 0; r < x.size(); ++r) x[r] -= inverse_compliance_[r] * rates_[r];
}

}  // namespace taut
