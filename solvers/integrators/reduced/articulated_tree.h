#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "core/constraints/rows.h"
#include "core/world/world.h"
#include "solvers/integrators/reduced/tree_dynamics.h"
#include "solvers/system/mass_matrix.h"

namespace taut {

/// Chosen, where nothing else is said.
struct TreeTuning {
  /// Newton steps of a joint, or of all together, at most; near the tolerance each squares the gap.
  static constexpr int kMaxClosings = 20;
};

/// The tree of TreeDynamics by itself, by rows and masses from elsewhere: what closes its joints, and its
/// answers, of which ClosedTree makes the motion.  Symbols are those of tree_dynamics.h, (1).
/// (solvers/integrators, "Reduced coordinates")
class ArticulatedTree {
 public:
  using Method = TreeDynamics::Method;
  using Vector6 = Eigen::Matrix<double, 6, 1>;

  /// `rows` and `mass` are those of the world, with the topology that it has, and must outlive it; equality
  /// rows hold but those of joints that are cut, others do not.
  ArticulatedTree(const World& world, const Rows& rows, const MassMatrix& mass);
  ~ArticulatedTree();
  ArticulatedTree(const ArticulatedTree&) = delete;
  ArticulatedTree& operator=(const ArticulatedTree&) = delete;

  /// The joints that are in no branch, by their index in Rows::joints().
  const std::vector<int>& cuts() const { return cuts_; }
  /// (1), without c, at a state.  What follows refers to that.
  void linearize(const State& state);
  /// J of all rows at the state of linearize().
  std::span<const double> jacobian() const { return jacobian_; }
  /// Number of speeds u.
  int freedoms() const;
  /// Closes all joints from the roots to the leaves, each body with all that hangs on it against its parent,
  /// by Newton's method q ← q ⊕ (−J_b⁺ φ), at least `least` times, until |φ| is within the tolerance.  False
  /// if it does not come to that.  Needs and leaves no linearize().
  [[nodiscard]] bool close_positions(State& state, double tolerance, int least, int& iterations);
  /// Makes velocities obey J V + φ_t = 0 from the roots to the leaves, at the state of linearize():
  /// V ← V − J_b⁺ (J V + φ_t), exactly.
  void close_velocities(State& state) const;

  // Answers, at the state of linearize().
  /// Inertias of the bodies, and what either method makes of them.
  void prepare(const State& state, Method method);
  /// ω × Iω − f of each body.
  void biases(const State& state, std::span<const Wrench> forces, std::span<Vector6> bias) const;
  /// The a of least |a|²_M + 2 a·bias with J a + rates = 0 for the rows of the tree; no rates: 0.
  void respond(Method method, std::span<const Vector6> bias, std::span<const double> rates,
               std::span<Vector6> a);
  /// λ of the rows of the tree that makes this a under this bias, added to their entries.
  void add_reactions(std::span<const Vector6> a, std::span<const Vector6> bias, std::span<double> lambda);
  /// Whether a body is of the tree, and so moves.
  bool moves(int body) const { return branch_of_[body] >= 0; }

 private:
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  using Rows6 = Eigen::Matrix<double, Eigen::Dynamic, 6, 0, 6, 6>;
  using OwnMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;

  /// A row of a branch, and where it is in the Jacobian.
  struct TreeRow {
    int row = 0, in_block = 0, side = 0, parent_side = 0;
  };
  struct Branch {
    int body = 0, parent = 0;
    int first = 0, count = 0;  ///< of held_
    bool attached() const { return count > 0; }
  };
  struct Motion;       // (1) in one state
  struct Articulated;  // what the recursion carries to the roots
  struct Lagrange;     // G, M G and H

  Vector6 block_rates(const Branch& branch, const Motion& motion, std::span<const double> rates) const;
  void decompose(const Branch& branch, Motion& motion, bool with_null_space);
  void factorize(std::size_t k);
  void carry_to_parent(std::size_t k);
  const Vector6& carry_on(std::size_t k);
  Eigen::MatrixXd speeds_to_bodies() const;
  double open_gap(std::size_t k, const Configuration& at);
  bool close_joint(std::size_t k, const Configuration& at, Pose& pose);
  std::span<const double> open_rates(const State& state) const;

  const Rows& rows_;
  const MassMatrix& mass_;
  bool follows_time_ = false;
  std::vector<Branch> branches_;  // parents before their children
  std::vector<TreeRow> held_;
  std::vector<int> blocks_, first_block_;  // of branches, to be looked at one by one
  std::vector<int> branch_of_;             // of a body; −1: it does not move
  std::vector<Motion> motions_;            // by branch
  std::vector<Articulated> articulated_;   // by branch
  std::unique_ptr<Lagrange> lagrange_;
  std::vector<Matrix6> inertias_;  // by branch
  std::vector<int> cuts_;
  std::vector<Vector6> a_, carried_;  // by body
  std::vector<double> jacobian_, phi_;
  std::vector<Pose> before_;
  mutable std::vector<double> rates_;
  mutable std::vector<Twist> twists_before_;
};

}  // namespace taut
