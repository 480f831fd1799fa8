#include "solvers/system/row_updates.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "solvers/system/rank_estimate.h"

namespace taut {
namespace {

double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

RowUpdates::RowUpdates(ConstraintSystem& system) : system_(system) {
  const std::size_t n = system.row_count();
  states_.assign(n, 0.0);
  scratch_.assign(n, 0.0);
  solved_.assign(n * kMaxRows, 0.0);
  gram_.assign(kMaxRows * kMaxRows, 0.0);
  diagonal_.assign(kMaxRows, 0.0);
  columns_.reserve(kMaxRows);
}

void RowUpdates::forget_old_factor() {
  if (version_ == system_.factor_version()) return;
  version_ = system_.factor_version();
  base_ = system_.factored_states();
  columns_.clear();
}

int RowUpdates::find_column(int row) const {
  for (std::size_t i = 0; i < columns_.size(); ++i)
    if (columns_[i].row == row) return static_cast<int>(i);
  return -1;
}

/// One back-solve: u = e_r for a row that is in the factor, S e_r on the rows of the factor for one that is
/// not.
int RowUpdates::add_column(int row) {
  const int n = system_.row_count(), j = static_cast<int>(columns_.size());
  columns_.push_back({row, factored_state(row) == kMasked});
  const std::span<double> z(solved_.data() + static_cast<std::size_t>(j) * n, n);
  std::fill(scratch_.begin(), scratch_.end(), 0.0);
  scratch_[row] = 1;
  if (columns_[j].masked) {
    std::copy(scratch_.begin(), scratch_.end(), z.begin());
    system_.multiply(z, scratch_);
    diagonal_[j] = scratch_[row];
    for (int i = 0; i <= j; ++i) gram(i, j) = columns_[i].masked ? -scratch_[columns_[i].row] : 0;
    for (int r = 0; r < n; ++r)
      if (factored_state(r) == kMasked) scratch_[r] = 0;
  } else {
    for (int i = 0; i <= j; ++i) gram(i, j) = 0;
  }
  std::copy(scratch_.begin(), scratch_.end(), z.begin());
  system_.solve_shifted(z);
  for (int i = 0; i <= j; ++i) {
    gram(i, j) += dot(scratch_, solved(i));
    gram(j, i) = gram(i, j);
  }
  return j;
}

bool RowUpdates::set_states(std::span<const double> states, int budget) {
  if (!system_.factored()) return false;
  assert(states.size() == states_.size());
  if (!system_.usable()) return false;
  forget_old_factor();
  std::copy(states.begin(), states.end(), states_.begin());
  count_ = 0;
  int missing = 0, changed = 0;
  for (std::size_t r = 0; r < states.size(); ++r) {
    if (states[r] == factored_state(static_cast<int>(r))) continue;
    if (++changed > kMaxRows) return false;
    if (find_column(static_cast<int>(r)) < 0) ++missing;
  }
  if (changed == 0) return true;
  if (missing > budget || missing + columns_.size() > kMaxRows) return false;
  for (const bool masking : {true, false})  // so that the pivots of the others are those of the new matrix
    for (std::size_t r = 0; r < states.size(); ++r) {
      if (states[r] == factored_state(static_cast<int>(r)) || (states[r] == kMasked) != masking) continue;
      const int known = find_column(static_cast<int>(r));
      changed_[count_++] = known >= 0 ? known : add_column(static_cast<int>(r));
    }
  return factor_complement();
}

/// B − Uᵀ S_ε⁻¹ U with B_ii = −1/d for a row whose Σ changes by d, S_ε,rr for one that joins.  Symmetric and
/// quasi-definite: L D Lᵀ exists in any order.
bool RowUpdates::factor_complement() {
  const double stretch = 1 + system_.factored_shift();
  const auto entry = [this](int i, int j) -> double& { return complement_[i * kMaxRows + j]; };
  for (int i = 0; i < count_; ++i) {
    const int row = columns_[changed_[i]].row;
    for (int j = 0; j <= i; ++j) entry(i, j) = -gram(changed_[i], changed_[j]);
    double smallest = 0;  // a pivot below this: nearly dependent, or lost to cancellation
    if (columns_[changed_[i]].masked) {
      // gram already holds −S_rr
      const double diagonal = stretch * (diagonal_[changed_[i]] + states_[row]);
      entry(i, i) += diagonal - diagonal_[changed_[i]];
      smallest = system_.singular() ? 0 : RankTuning::kStepping.dependent * diagonal;
    } else if (states_[row] != kMasked) {
      const double inverse = 1 / (stretch * (states_[row] - factored_state(row)));
      entry(i, i) -= inverse;
      smallest = -RankTuning::kStepping.dependent * inverse;
    }
    for (int k = 0; k < i; ++k) {
      double l = entry(i, k);
      for (int j = 0; j < k; ++j) l -= entry(i, j) * entry(j, j) * entry(k, j);
      entry(i, k) = l / entry(k, k);
    }
    for (int k = 0; k < i; ++k) entry(i, i) -= entry(i, k) * entry(i, k) * entry(k, k);
    const double pivot = entry(i, i);
    if (!std::isfinite(pivot) || pivot == 0) return false;
    if (smallest > 0 ? pivot <= smallest : columns_[changed_[i]].masked && pivot <= 0) return false;
  }
  return true;
}

void RowUpdates::solve_shifted(std::span<double> x) {
  take_border(x);
  system_.solve_shifted(x);
  solve_complement();
  put_border(x);
}

/// f ← x without the rows that change or are masked, border ← g − Uᵀ S_ε⁻¹ f.
void RowUpdates::take_border(std::span<double> x) {
  for (int i = 0; i < count_; ++i)
    border_[i] = columns_[changed_[i]].masked ? x[columns_[changed_[i]].row] : 0;
  for (std::size_t r = 0; r < x.size(); ++r)
    if (states_[r] == kMasked || factored_state(static_cast<int>(r)) == kMasked) x[r] = 0;
  for (int i = 0; i < count_; ++i) border_[i] -= dot(solved(changed_[i]), x);
}

/// border ← ν = K⁻¹ border.
void RowUpdates::solve_complement() {
  const auto entry = [this](int i, int j) { return complement_[i * kMaxRows + j]; };
  for (int i = 0; i < count_; ++i)
    for (int j = 0; j < i; ++j) border_[i] -= entry(i, j) * border_[j];
  for (int i = 0; i < count_; ++i) border_[i] /= entry(i, i);
  for (int i = count_ - 1; i >= 0; --i)
    for (int j = i + 1; j < count_; ++j) border_[i] -= entry(j, i) * border_[j];
}

/// x ← x − S_ε⁻¹ U ν, and the entries of rows that joined or left.
void RowUpdates::put_border(std::span<double> x) const {
  for (int i = 0; i < count_; ++i) {
    const std::span<const double> z = solved(changed_[i]);
    for (std::size_t r = 0; r < x.size(); ++r) x[r] -= border_[i] * z[r];
  }
  for (int i = 0; i < count_; ++i) {
    const Column& column = columns_[changed_[i]];
    if (column.masked)
      x[column.row] = border_[i];
    else if (states_[column.row] == kMasked)
      x[column.row] = 0;
  }
}

void RowUpdates::solve(std::span<double> x) {
  if (!system_.usable()) {
    std::fill(x.begin(), x.end(), std::numeric_limits<double>::quiet_NaN());
    return;
  }
  solve_shifted(x);
  if (!system_.singular()) return;
  system_.multiply(x, scratch_);
  for (std::size_t r = 0; r < x.size(); ++r)
    x[r] = states_[r] == kMasked ? 0 : scratch_[r] + (states_[r] > 0 ? states_[r] * x[r] : 0);
  solve_shifted(x);
}

}  // namespace taut
