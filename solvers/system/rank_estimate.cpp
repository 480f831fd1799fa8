#include "solvers/system/rank_estimate.h"

#include <algorithm>
#include <utility>

namespace taut {
void RankEstimate::reserve(int rows) {
  dependent_rows_.reserve(rows);
  counted_rows_.reserve(rows);
  large_pivots_.reserve(rows);
}

void RankEstimate::found_dependence() {
  demand_shift();
  full_rank_streak_ = 0;
}

void RankEstimate::found_rank() {
  full_rank_streak_ = dependent_rows_.empty() ? full_rank_streak_ + 1 : 0;
  if (full_rank_streak_ >= RankTuning::kStreak) shift_next_ = false;
}

void RankEstimate::inspect(std::span<const double> pivots, std::span<const int> row_at) {
  double smallest = 1, largest = 0;
  for (std::size_t i = 0; i < pivots.size(); ++i) {
    const double ratio = pivots[i];
    if (!(ratio > tolerance_.dependent)) {
      dependent_rows_.push_back(row_at[i]);
      continue;
    }
    smallest = std::min(smallest, ratio);
    largest = std::max(largest, ratio);
  }
  condition_ = largest > 0 ? largest / smallest : 1;
}

void RankEstimate::forget() {
  dependent_rows_.clear();
  condition_ = 0;
}

void RankEstimate::forget_rows_from(int first) {
  for (auto* rows : {&dependent_rows_, &counted_rows_})
    std::erase_if(*rows, [&](int row) { return row >= first; });
}

void RankEstimate::begin_count(std::span<const double> pivots) {
  large_pivots_.assign(pivots.begin(), pivots.end());
}

void RankEstimate::end_count(std::span<const double> pivots, std::span<const int> row_at) {
  dependent_rows_.clear();
  for (std::size_t i = 0; i < pivots.size(); ++i)
    if (pivots[i] < RankTuning::kStays * large_pivots_[i]) dependent_rows_.push_back(row_at[i]);
}

bool RankEstimate::small_pivots_changed() {
  return std::exchange(small_pivots_, deficiency()) != deficiency();
}

}  // namespace taut
