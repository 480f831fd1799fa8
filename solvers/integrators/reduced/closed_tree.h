#pragma once

#include <limits>
#include <span>
#include <vector>

#include "solvers/integrators/reduced/articulated_tree.h"
#include "solvers/integrators/reduced/beyond_rows.h"

namespace taut {

class Archive;

/// The tree with rows beyond it, c of them, that hold by multipliers of their own: those of joints that close
/// loops or have more than two bodies, which are cut, and of axes those that hold().  Of what the tree does
/// by itself, a₀,
///
///     a = a₀ + R λ,   A λ + b = 0,   b = J_c a₀ + γ_c,   A = J_c R,   M⁻¹-response R = a₀ of J_cᵀ      (1)
///
/// where each column of R is a recursion, O(n), or a back-solve with H: O(c n + c³) in all.  Where these rows
/// depend on each other λ is of least norm.  By Gauss' principle the a of (1) is the least change in the
/// metric M; with J V + φ_t in place of γ, and without forces, it is that of velocities which closes them,
/// with φ the move that closes all joints in one step of Newton's method.  Without such rows it is the tree.
/// (solvers/integrators, "Reduced coordinates")
class ClosedTree {
 public:
  using Method = ArticulatedTree::Method;
  using Vector6 = ArticulatedTree::Vector6;

  /// An axis row that holds.
  struct Held {
    int row = 0;
    double rate = 0, acceleration = 0;  ///< of its coordinate
    double position = kAnywhere;        ///< where it stays, if it does
    friend bool operator==(const Held&, const Held&) = default;
  };
  static constexpr double kAnywhere = std::numeric_limits<double>::infinity();
  /// @see ArticulatedTree
  ClosedTree(const World& world, const Rows& rows, const MassMatrix& mass);
  ClosedTree(const ClosedTree&) = delete;
  ClosedTree& operator=(const ClosedTree&) = delete;

  /// Beside joints these rows hold from now on.
  void hold(std::span<const Held> rows);
  /// Of joints that are cut, which come first.
  int cut_rows() const { return cut_rows_; }
  bool is_tree() const { return beyond_.empty(); }
  /// Rows beyond the tree depend on each other where all are closed, or it is not known yet.
  bool may_be_redundant() const { return !is_tree() && deficit_.rows != 0; }

  void linearize(const State& state) { tree_.linearize(state); }
  std::span<const double> jacobian() const { return tree_.jacobian(); }
  int freedoms() const { return tree_.freedoms(); }

  /// V̇ of all bodies under these wrenches and λ that makes it: of equality rows in place of their entries, of
  /// rows that hold() added to them.
  void accelerate(const State& state, std::span<const Wrench> forces, Method method,
                  std::span<Twist> accelerations, std::span<double> lambda);
  /// In two parts, between which λ of the rows beyond the tree is chosen by whoever has laws for them.
  const BeyondRows& begin_acceleration(const State& state, std::span<const Wrench> forces, Method method);
  void end_acceleration(const dense::Vector& beyond, std::span<Twist> accelerations,
                        std::span<double> lambda);
  /// An impact in two parts: b are the rates of these rows, held ones less their own, before it.  Impulses of
  /// all rows are added to theirs.
  const BeyondRows& begin_impact(const State& state);
  void end_impact(const dense::Vector& beyond, State& state, std::span<double> impulses);

  /// ArticulatedTree's, with the rows beyond the tree by (1), all together.  @{
  [[nodiscard]] bool close_positions(State& state, double tolerance, int least, int& iterations);
  void close_velocities(State& state);
  void project_velocities(State& state);  /// @}

  /// f(body, J) for each body that a row acts on, with the six entries of J that it has there.
  template <typename Function>
  void for_each_side(int row, Function f) const {
    const Rows::JointRows& block = rows_.joints()[rows_.row(row).block];
    for (int s = block.first_side; s < block.first_side + block.side_count; ++s) {
      const Rows::Side& side = rows_.sides()[s];
      f(side.body, Rows::block_row(side, tree_.jacobian(), row - block.first_row));
    }
  }

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive);

 private:
  void find_free(Method method, std::span<const Vector6> bias, std::span<const double> rates,
                 std::span<const Held> beyond);
  void find_responses(const State& state, Method method, std::span<const Held> beyond);
  double free_response(int row, const State& state) const;
  void add_responses(const dense::Vector& lambda, std::span<const Held> beyond);
  double rate_of(int row, std::span<const Vector6> a) const;
  void add_bias(int row, double lambda, std::span<Vector6> bias) const;
  double widest_gap(const Configuration& at);
  bool move(State& state);

  const Rows& rows_;
  const MassMatrix& mass_;
  ArticulatedTree tree_;
  int cut_rows_ = 0;
  bool follows_time_ = false;
  std::vector<Held> beyond_;  // cut rows, then those that hold()
  std::vector<Held> placed_;  // … of them, those that stay somewhere
  std::vector<int> equalities_;
  BeyondRows problem_;
  RankDeficit deficit_;                   // of beyond_
  std::vector<Vector6> a_, bias_, none_;  // by body
  std::vector<std::vector<Vector6>> responses_;
  std::vector<double> gamma_, phi_, rates_;
};

}  // namespace taut
