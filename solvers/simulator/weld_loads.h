#pragma once

#include <map>
#include <span>
#include <vector>

#include "core/constraints/rows.h"
#include "core/merging/merged_world.h"
#include "solvers/common/contact_report.h"
#include "solvers/laws/contact_cache.h"

namespace taut {

/// What the joints of a group that moves as one bear, from Newton's and Euler's equations of its members:
///
///     Σ welds of B = M_B V̇_B + (ω × I ω, 0) − (laws, other joints and contacts on B)
///
/// Along the tree from its leaves the sum is one weld's.  Where welds form loops it leaves the load open; of
/// all that it allows the one with the least Σ S_rr λ_r² is taken, S_rr = J_r M⁻¹ J_rᵀ of row r, as the
/// factor does for joints that hold each other.
/// (solvers/simulator, "Merged bodies")
class WeldLoads {
 public:
  /// For the present topology of the source, whose bodies `merged` has merged.
  WeldLoads(const World& source, const MergedWorld& merged);

  /// All rows of the source.
  const Rows& rows() const { return rows_; }
  bool is_weld(JointId joint) const {  // also for joints that came later
    return joint.index < std::ssize(is_weld_) && is_weld_[joint.index];
  }

  /// What acts in the merged world: multipliers of its rows times `scale`.
  struct Impulses {
    const Rows& rows;
    std::span<const double> multipliers;
    double scale = 1;
  };
  /// From the accelerations V̇ of the bodies of the merged world in its present state.
  void solve_present(std::span<const Twist> accelerations, const Impulses& joints,
                     std::span<const ContactCache::Slot> contacts);
  /// From the change of momenta over a step of dt from the state `start` of the source to the present one of
  /// the merged world, with the laws' mean over the two: good to first order in dt.
  void solve_mean(const State& start, double dt, const Impulses& joints,
                  std::span<const ContactReport> contacts);
  /// The state of the source that was last solved for.
  const State& state() const { return state_; }
  /// Wrench of the weld on its body B about B's centre of mass then [N·m, N].
  const Wrench& on_B(JointId weld) const { return loads_[weld.index]; }

 private:
  void start();
  void take_rows(const Rows::JointRows& own, const Rows::JointRows& there, const Impulses& joints);
  static Springs laws_of(const Impulses& joints) {
    return joints.rows.spring_count() > 0 ? Springs::kLeftOut : Springs::kIncluded;
  }
  void take_joints(const Impulses& joints);
  void take_contact_rows(const Impulses& joints, std::span<const ContactCache::Slot> contacts);
  void balance(const MergedGroup& group);
  void split_loads(const MergedGroup& group);
  void split_loops(const MergedGroup& group);
  using Block = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
  Eigen::Map<const Block> block(JointId weld, int s) const;
  int end(JointId weld, int s) const;
  Eigen::Matrix<double, 6, 1> stiffness(JointId weld) const;
  Eigen::VectorXd loop_displacements(std::span<const JointId> welds, const std::map<int, int>& place) const;
  Wrench moved(const Wrench& wrench, BodyId from, BodyId to) const;
  Eigen::Matrix<double, 6, 6> inverse_mass(int body) const;
  Wrench momentum(BodyId body, const State& state) const;

  const MergedWorld& merged_;
  Rows rows_;
  std::vector<BodyId> owner_of_shape_;
  std::vector<char> is_weld_;
  std::vector<char> spring_is_within_;  // one carrier, by World::springs()
  std::vector<JointId> welds_;
  struct Ends {
    BodyId a, b;
  };
  std::vector<Ends> ends_;        // of all joints
  State state_;                   // of the source
  std::vector<double> jacobian_;  // there
  std::vector<Wrench> required_;  // by each member from its welds
  std::vector<Wrench> laws_;
  std::vector<Wrench> loads_;  // by joint
};

}  // namespace taut
