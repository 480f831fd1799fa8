#pragma once

#include <span>
#include <vector>

#include "core/math/so3.h"
#include "solvers/friction/friction_problem.h"

namespace taut {

struct ScaledFrictionTuning {
  /// μ below which a contact has no tangents.  Chosen.
  static constexpr double kNoFriction = 1e-9;
  /// Blocks whose matrix is below this part of the largest have no unit of their own: some 45
  /// units of round-off.
  static constexpr double kLeastOwnPart = 1e-14;
  /// Steps of the power method on WᵀW, for |W|₂, which end where one changes it by less than the part.
  /// Chosen.
  static constexpr int kPowerSteps = 100;
  static constexpr double kPowerAccuracy = 1e-9;
  /// What is left of Wᵀ d, as a part of |d| and of what d closes, for impulses that move nothing.  Chosen.
  static constexpr double kMovesNothing = 1e-7;
};

/// A friction problem with one unit, √J: r ← √d r and u ← u/√d with d = mean diagonal of a block, so that the
/// mean diagonal of each is 1.  Rows are equalities, then normals of contacts without friction, then cones.
class ScaledFriction {
 public:
  enum class Law { kEquality, kUnilateral, kCone };
  struct Block {
    Law law;
    int first, size;  ///< of its rows: 1, or 3 of a cone
    double mu = 0;
  };

  explicit ScaledFriction(const FrictionProblem& problem);

  int rows() const { return static_cast<int>(q_.size()); }
  const std::vector<Block>& blocks() const { return blocks_; }
  const Eigen::VectorXd& q() const { return q_; }
  double largest_q() const { return largest_q_; }
  /// d of the rows of the problem; 1 of those that are none here.
  Eigen::VectorXd units() const;

  /// W: columns and values of a row.  Rows of a block have the same columns, which are those of whole blocks.
  std::span<const int> columns(int row) const { return {columns_.data() + start_[row], row_length(row)}; }
  std::span<const double> values(int row) const { return {values_.data() + start_[row], row_length(row)}; }
  /// Where the block that begins at this row stands among its columns.
  int diagonal(const Block& block) const { return diagonal_[block.first]; }
  /// W of the block with itself.
  Mat3 diagonal_block(const Block& cone) const;

  Eigen::VectorXd rates(const Eigen::VectorXd& r) const;  ///< W r + q
  /// Impulses of the problem as these rows, and the other way round.  @{
  Eigen::VectorXd scale(const Eigen::VectorXd& r) const;
  Eigen::VectorXd unscale(const Eigen::VectorXd& r) const;  /// @}

  FrictionErrors errors(const Eigen::VectorXd& r) const;

  /// P_K(x), of all blocks.
  Eigen::VectorXd project(const Eigen::VectorXd& x) const;
  /// Whether d of the problem, with d_N ≥ 0 and d_T = 0, shows that no impulses meet the laws:  Wᵀ d = 0 and
  /// d·q < 0, so that d·u < 0 whatever the impulses, while u_N ≥ 0 and equalities have u = 0.
  bool excludes(const Eigen::VectorXd& d) const;

 private:
  std::size_t row_length(int row) const { return start_[row + 1] - start_[row]; }
  void lay_out(const FrictionProblem& problem);
  void find_units(const FrictionProblem& problem);
  std::vector<std::vector<int>> neighbours(const FrictionProblem& problem,
                                           const std::vector<int>& row_of) const;
  void take_matrix(const FrictionProblem& problem);

  int given_rows_ = 0;
  std::vector<int> given_row_;  ///< of each row
  std::vector<Block> blocks_;
  std::vector<int> start_, columns_, diagonal_;
  std::vector<double> values_, root_diagonal_;  ///< root_diagonal_ = √d of each row
  Eigen::VectorXd q_;
  double largest_q_ = 0, given_norm_of_q_ = 0;
  double norm_ = 1;  ///< |W|₂, or 1 where nothing moves
};

}  // namespace taut
