#pragma once

#include <span>
#include <vector>

namespace taut {

class Archive;

/// When a row counts as dependent, both relative to its own S_rr.
struct RankTolerance {
  double shift;      ///< ε of S_ε: dependent rows leave a pivot of about this size
  double dependent;  ///< pivots below this count as dependent
};
/// Chosen, where nothing else is said.
struct RankTuning {
  /// For stepping: directions that are softer than 1e-8 of a row's own are left alone.  Multipliers along
  /// them would be huge forces that mend gaps far below the tolerance, as in a flat grid of joints that has
  /// just begun to bend.
  static constexpr RankTolerance kStepping{1e-8, 1e-6};
  /// For counting freedoms in one pose, where no impulses follow: as small as the round-off of pivots allows.
  static constexpr RankTolerance kCounting{1e-11, 1e-8};
  /// The shift of the second factorisation over that of the first, and what is left of a pivot at least that
  /// does not follow the shift: between that and 1.  Chosen.
  static constexpr double kSecondShift = 1.0 / 16, kStays = 0.5;
  /// Full-rank factorisations after which the shift is dropped again.  Chosen.
  static constexpr int kStreak = 100;
};

/// What the pivots of S say of its rank: which rows depend on others, how soft the independent ones are, and
/// whether the next factorisation begins with the shift ε.  (solvers/system, "Dependent rows")
///
/// The pivot of a dependent row is a multiple of ε, and the multiple grows with the length of the dependence:
/// 10⁸ ε for a bridge of 1000 hinges.  No threshold tells such pivots from small independent ones, but two
/// shifts do: the former follow the shift, the latter stay.  That count takes two factorisations more, and is
/// kept until the number of small pivots changes.
///
/// Pivots are relative to S_rr and in the order of elimination; `row_at` is the row at each place of it.
class RankEstimate {
 public:
  explicit RankEstimate(RankTolerance tolerance) : tolerance_(tolerance), counted_shift_(tolerance.shift) {}
  /// Room for so many rows.
  void reserve(int rows);

  const RankTolerance& tolerance() const { return tolerance_; }
  double shift() const { return tolerance_.shift; }
  void set_shift(double shift) { tolerance_.shift = shift; }
  /// The next factorisation begins with the shift.
  bool shifts() const { return shift_next_; }
  /// Factorisations begin with the shift from now on, until 100 in a row have met full rank.
  void demand_shift() { shift_next_ = true; }
  /// As demand_shift(), counted from here, after one without the shift that met dependent rows.
  void found_dependence();
  /// Counts one of the 100 if the last factorisation met full rank.
  void found_rank();

  /// Dependent rows and condition by the threshold, of a factor that could be made.
  void inspect(std::span<const double> pivots, std::span<const int> row_at);
  /// Nothing is known of a factor that could not be made but its condition so far.
  void forget_rows() { dependent_rows_.clear(); }
  /// Nothing is known of a factor that shows no pivots of rows, its condition neither.
  void forget();
  /// Rows from here on are others.
  void forget_rows_from(int row);

  /// The count by two shifts: of pivots of the larger one, then of those of the smaller one.
  void begin_count(std::span<const double> pivots);
  void end_count(std::span<const double> pivots, std::span<const int> row_at);
  /// The last count is of this shift.
  bool counts() const { return tolerance_.shift == counted_shift_; }
  /// Whether the number of small pivots differs from the one at the last call.
  bool small_pivots_changed();
  void keep_count() { counted_rows_ = dependent_rows_; }
  void use_kept_count() { dependent_rows_ = counted_rows_; }

  int deficiency() const { return static_cast<int>(dependent_rows_.size()); }
  std::span<const int> dependent_rows() const { return dependent_rows_; }
  /// (largest / smallest pivot) of the independent rows: a lower bound of the condition of the scaled S; 0:
  /// not known.
  double condition() const { return condition_; }

  /// To or from bytes (checkpoint_memory.cpp): what the next factorisation begins with.
  void transfer_shift(Archive& archive);
  /// To or from bytes: what the last factorisation found.
  void transfer_findings(Archive& archive, int rows);

 private:
  RankTolerance tolerance_;
  std::vector<int> dependent_rows_;
  double condition_ = 1;
  std::vector<int> counted_rows_;  // the dependent rows when small_pivots_ last changed
  int small_pivots_ = 0;
  double counted_shift_;
  std::vector<double> large_pivots_;  // those of the larger shift
  bool shift_next_ = false;
  int full_rank_streak_ = 0;
};

}  // namespace taut
