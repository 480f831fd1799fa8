#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "solvers/system/constraint_system.h"

namespace taut {

/// Single rows of S λ, with S = W Wᵀ, while impulses change one at a time: what all of them give to the
/// bodies, Wᵀ λ, is kept.
class RowImpulses {
 public:
  /// One moving body that a row acts on, where its six numbers are in W, and which side of the joint that is.
  struct Side {
    int body, offset, side;
  };

  /// For as long as the system keeps its rows.
  explicit RowImpulses(ConstraintSystem& system) : system_(system) {
    const Rows& rows = system.rows();
    row_start_.push_back(0);
    for (const Rows::JointRows& joint : rows.joints())
      for (int i = 0; i < joint.row_count; ++i) {
        for (int s = joint.first_side; s < joint.first_side + joint.side_count; ++s)
          if (!system.mass()[rows.sides()[s].body].fixed)
            sides_.push_back({rows.sides()[s].body, rows.sides()[s].whole + 6 * i, s});
        row_start_.push_back(static_cast<int>(sides_.size()));
      }
    diagonal_.assign(rows.row_count(), 0.0);
    bodies_.assign(6 * static_cast<std::size_t>(rows.body_count()), 0.0);
  }

  /// S_rr and Wᵀ λ with the W of now.
  void gather(std::span<const double> lambda) {
    std::fill(bodies_.begin(), bodies_.end(), 0.0);
    const double* W = weighted();
    for (std::size_t r = 0; r < lambda.size(); ++r) {
      diagonal_[r] = 0;
      for (const Side& side : sides(static_cast<int>(r)))
        for (int k = 0; k < 6; ++k) {
          const double entry = W[side.offset + k];
          diagonal_[r] += entry * entry;
          bodies_[6 * side.body + k] += entry * lambda[r];
        }
    }
  }

  std::span<const Side> sides(int row) const {
    return {sides_.data() + row_start_[row], sides_.data() + row_start_[row + 1]};
  }
  /// S_rr of the last gather().
  double diagonal(int row) const { return diagonal_[row]; }
  /// b + (S λ)_r.
  double rate(int row, double b) const {
    const double* W = weighted();
    for (const Side& side : sides(row))
      for (int k = 0; k < 6; ++k) b += W[side.offset + k] * bodies_[6 * side.body + k];
    return b;
  }
  /// λ_r has changed `by` so much: for all of its bodies, or one.
  void add(int row, double by) {
    for (const Side& side : sides(row)) add(side, by);
  }
  void add(const Side& side, double by) {
    const double* W = weighted() + side.offset;
    for (int k = 0; k < 6; ++k) bodies_[6 * side.body + k] += W[k] * by;
  }

 private:
  const double* weighted() const { return system_.weighted().data(); }

  ConstraintSystem& system_;
  std::vector<int> row_start_;
  std::vector<Side> sides_;
  std::vector<double> diagonal_, bodies_;  // Wᵀ λ: 6 numbers a body
};

}  // namespace taut
