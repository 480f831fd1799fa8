#pragma once

#include <array>
#include <span>
#include <vector>

#include "solvers/system/constraint_system.h"

namespace taut {

class Archive;

/// The factor of a ConstraintSystem, made good for row states that differ in a few rows from those that it
/// was made for, by a dense Schur complement of those rows (solvers/system, "Changed rows").  The system must
/// outlive it; a new factorisation is noticed, and what was gathered for the old one is dropped.
class RowUpdates {
 public:
  /// So many rows at most can differ, now and before, from one factorisation to the next.
  static constexpr int kMaxRows = 32;

  explicit RowUpdates(ConstraintSystem& system);

  /// From now on the solves are those for these states.  Costs one back-solve for each row that differs for
  /// the first time.  False if the present factor cannot serve, because that would take more than `budget`
  /// back-solves (−1: none, and no changed row either) or kMaxRows rows, or because the changed matrix is
  /// nearer to singular than that factor can stand: then call ConstraintSystem::factorize() and this again.
  [[nodiscard]] bool set_states(std::span<const double> states, int budget);

  /// x ← (S + Σ)⁺ x on the rows that are not masked, 0 on the others.
  void solve(std::span<double> x);
  /// x ← (S + Σ)_ε⁻¹ x likewise, with the shift of the present factor.
  void solve_shifted(std::span<double> x);
  /// Rows whose states differ from the factored ones.
  int changed_rows() const { return count_; }

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive);

 private:
  struct Column {
    int row;
    bool masked;  ///< in the factor: the column is S_ε⁻¹ S e_r instead of S_ε⁻¹ e_r
  };
  double factored_state(int row) const { return base_.empty() ? 0 : base_[row]; }
  void forget_old_factor();
  int find_column(int row) const;
  int add_column(int row);
  /// S_ε⁻¹ u of a column.
  std::span<const double> solved(int column) const {
    return std::span(solved_).subspan(static_cast<std::size_t>(column) * scratch_.size(), scratch_.size());
  }
  bool factor_complement();
  void take_border(std::span<double> x);
  void solve_complement();
  void put_border(std::span<double> x) const;
  double& gram(int i, int j) { return gram_[i * kMaxRows + j]; }

  ConstraintSystem& system_;
  std::span<const double> base_;  ///< states of the factor
  std::vector<double> states_;
  long version_ = -1;
  std::vector<Column> columns_;           ///< gathered for this factor
  std::vector<double> solved_, scratch_;  ///< solved_: one column of row_count() entries behind the other
  std::vector<double> gram_, diagonal_;  ///< u_iᵀ S_ε⁻¹ u_j less what couples u_i and u_j themselves; S_rr
  std::array<int, kMaxRows> changed_{};  ///< columns in use: masked ones first
  int count_ = 0;
  std::array<double, kMaxRows * kMaxRows> complement_{};  ///< its L D Lᵀ, lower triangle
  std::array<double, kMaxRows> border_{};
};

}  // namespace taut
