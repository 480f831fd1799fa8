#pragma once

#include <limits>
#include <span>
#include <vector>

#include "core/constraints/rows.h"

namespace taut {

class Archive;

/// State of a row whose multiplier is given from outside: it leaves the system.
inline constexpr double kMasked = std::numeric_limits<double>::infinity();

/// What each row is in (S + Σ) λ = x: free (0), compliant (Σ_r > 0, rate per impulse) or masked (kMasked).
/// (solvers/system, "Row states")
class RowStates {
 public:
  /// Room for so many rows.
  void reserve(int rows) { states_.reserve(rows); }
  /// All rows free.
  void clear() { states_.clear(); }
  /// One number per row; an empty span: all rows free.
  void set(std::span<const double> states);
  /// All axis and contact rows masked: the joints alone.
  void mask_bounded(const Rows& rows);

  bool all_free() const { return states_.empty(); }
  bool any_free() const;
  /// One number per row; empty if all rows are free.
  std::span<const double> values() const { return states_; }
  double operator[](int row) const { return states_.empty() ? 0 : states_[row]; }

  /// x_r ← 0 on masked rows.
  void clear_masked(std::span<double> x) const;
  /// out ← out + Σ x, and 0 on masked rows.
  void add_compliance(std::span<const double> x, std::span<double> out) const;

  /// To or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive, int rows);

 private:
  std::vector<double> states_;  // empty: all free
};

}  // namespace taut
