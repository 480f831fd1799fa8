#include "solvers/integrators/close_joints.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/math/dense.h"
#include "core/state/reach.h"
#include "solvers/common/max_abs.h"
#include "solvers/integrators/gauss_newton.h"

namespace taut {
namespace {

/// Without a unit: parts and counts.  Chosen, where nothing else is said.
struct ClosingTuning {
  /// Newton steps at most, none of which turns a body by more than BodyMovesTuning does.
  static constexpr int kMaxClosings = 60;
  /// It ends after so many steps more that leave more than the second, which is a part of the smallest gap.
  static constexpr int kPatience = 10;
  static constexpr double kInVain = 0.9;

  // Messages.
  /// Joints contradict each other if no motion takes away more than this part of the largest gap.
  static constexpr double kStuckGap = 0.01;
  /// Joints with less than this part of the largest share do not belong to the contradiction.
  static constexpr double kStuckShare = 1e-3;
  /// Sets of more joints are not made smaller: each trial costs a dense eigenvalue problem.
  static constexpr std::size_t kDenseSetLimit = 24;
  /// In that, eigenvalues below this part of the largest are 0, and a set contradicts itself if more than the
  /// second, which is a part of |φ|, lies along their vectors.
  static constexpr double kNoEigenvalue = 1e-9, kContradicting = 0.05;
};

/// A body whose inverse mass overflows is nowhere even if nothing pushes it.
bool is_somewhere(const Pose& pose) { return within(pose.p) && pose.q.coeffs().allFinite(); }

/// Whether the rows of these joints alone leave a residual that no motion reduces: dense, for small sets.
bool contradict(const ConstraintSystem& system, std::span<const double> phi, const std::vector<int>& joints) {
  const Rows& rows = system.rows();
  std::vector<int> row_of, joint_of;
  for (int j : joints)
    for (int i = 0; i < rows.joints()[j].equality_count; ++i)
      row_of.push_back(rows.joints()[j].first_row + i), joint_of.push_back(j);
  const auto n = static_cast<Eigen::Index>(row_of.size());
  std::map<int, Eigen::Index> column_of;  // the bodies that these joints touch
  for (int j : joints)
    for (int s = rows.joints()[j].first_side; s < rows.joints()[j].first_side + rows.joints()[j].side_count;
         ++s)
      column_of.emplace(rows.sides()[s].body, 6 * static_cast<Eigen::Index>(column_of.size()));
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(n, 6 * static_cast<Eigen::Index>(column_of.size()));
  Eigen::VectorXd r(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Rows::JointRows& joint = rows.joints()[joint_of[i]];
    r[i] = phi[row_of[i]];
    for (int s = joint.first_side; s < joint.first_side + joint.side_count; ++s) {
      const Rows::Side& side = rows.sides()[s];
      if (system.mass()[side.body].fixed) continue;
      const Eigen::Matrix<double, 6, 1> J =
          Rows::block_row(side, system.jacobian(), row_of[i] - joint.first_row);
      const InverseMassRoot& A = system.mass_roots()[side.body];
      const Eigen::Index column = column_of[side.body];
      W.block<1, 3>(i, column) = J.head<3>().transpose() * A.rotation;
      W.block<1, 3>(i, column + 3) = J.tail<3>().transpose() * A.translation;
    }
  }
  const auto [values, vectors] = dense::symmetric_eigenpairs(dense::product(W, W.transpose()));
  const double cutoff = ClosingTuning::kNoEigenvalue * std::max(values.maxCoeff(), 1e-300);
  double stuck = 0;
  for (Eigen::Index k = 0; k < n; ++k)
    if (values[k] < cutoff) stuck += std::pow(vectors.col(k).dot(r), 2);
  return std::sqrt(stuck) > ClosingTuning::kContradicting * r.norm();
}

/// Which limits hold while joints are closed: those that an axis was beyond, until they would pull.  Motors
/// are no part of that.
class PassedLimits {
 public:
  PassedLimits(const ConstraintSystem& system, std::span<const AxisForces::Bound> limits)
      : limits_(limits), side_(limits.size(), 0), states_(system.row_count(), 0.0) {
    for (const Rows::AxisRow& axis : system.rows().axis_rows()) states_[axis.row] = kMasked;
    std::fill(states_.begin() + system.rows().first_contact_row(), states_.end(), kMasked);
    theta_.resize(limits.size());
  }
  /// Of φ with the coordinates of axes, the gaps that are to be closed.
  void read(const ConstraintSystem& system, std::span<double> phi) {
    for (std::size_t i = 0; i < limits_.size(); ++i) theta_[i] = phi[limits_[i].row];
    system.clear_bounded_rows(phi);
    for (std::size_t i = 0; i < limits_.size(); ++i) {
      const double excess = limits_[i].excess(theta_[i]);
      if (excess != 0) side_[i] = excess > 0 ? 1 : -1;
      states_[limits_[i].row] = side_[i] == 0 ? kMasked : 0;
      if (side_[i] != 0)
        phi[limits_[i].row] = theta_[i] - (side_[i] > 0 ? limits_[i].upper : limits_[i].lower);
    }
  }
  std::span<const double> row_states() const { return states_; }
  /// Lets go of those that these impulses would have pull.
  void drop(std::span<const double> impulses) {
    for (std::size_t i = 0; i < limits_.size(); ++i)
      if (side_[i] * impulses[limits_[i].row] > 0) side_[i] = 0;
  }

 private:
  std::span<const AxisForces::Bound> limits_;
  std::vector<int> side_;
  std::vector<double> states_, theta_;
};

}  // namespace

bool close_joints(ConstraintSystem& system, State& state, double tolerance, SubstepReport& report,
                  std::span<const AxisForces::Bound> limits) {
  std::vector<double> delta(system.row_count());
  std::vector<Wrench> move(system.mass().size());
  std::vector<Pose>& poses = state.poses;
  std::vector<Pose> best = poses;
  PassedLimits passed(system, limits);
  double best_gap = INFINITY;
  int iteration = 0, since_best = 0;
  bool closed = false;
  const auto ask = [&](std::span<double> phi) {
    if (iteration++ == ClosingTuning::kMaxClosings) return false;
    system.rows().update_axes(state, state.axes);
    system.rows().residual(state, phi);
    passed.read(system, phi);
    const double gap = max_abs(phi);
    closed = gap <= tolerance && std::all_of(poses.begin(), poses.end(), is_somewhere);
    if (gap <= tolerance) return false;
    if (gap < ClosingTuning::kInVain * best_gap) {
      best_gap = gap;
      best = poses;
      since_best = 0;
    } else if (!std::isfinite(gap) || ++since_best > ClosingTuning::kPatience) {
      return false;
    }
    for (double& p : phi) p = -p;
    return true;
  };
  const auto factorize = [&] {
    system.set_row_states(passed.row_states());
    system.factorize(report.times);
    return true;
  };
  const auto solve = [&](std::span<double> x) {
    system.solve(x);
    passed.drop(x);
  };
  report.newton_iterations +=
      gauss_newton(system, state, poses, BodyMovesTuning::kLongestTurn, delta, move, ask, factorize, solve);
  if (!closed) poses = best;
  return closed;
}

Contradiction find_stuck_joints(const World& world, ConstraintSystem& system, const std::vector<Pose>& poses,
                                SubstepReport& report) {
  const int n = system.row_count();
  std::vector<double> phi(n), inner(n), reachable(n);
  const Configuration at(poses, world.time(), world.state().axes);
  system.linearize(at);
  system.set_mass(poses);
  system.release_bounded_rows();
  system.factorize(report.times);
  system.rows().residual(at, phi);
  system.clear_bounded_rows(phi);
  inner = phi;
  system.solve(inner);
  system.multiply(inner, reachable);
  system.clear_bounded_rows(reachable);

  Contradiction found;
  std::vector<double> share(world.joint_count(), 0.0);
  double largest = 0, size = 0;
  for (int r = 0; r < n; ++r) {
    const double stuck = phi[r] - reachable[r];
    const std::optional<JointId> joint = system.rows().joint_of(r);
    if (!joint) continue;
    double& s = share[joint->index];
    s = std::hypot(s, stuck);
    largest = std::max(largest, s);
    size = std::max(size, std::abs(phi[r]));
  }
  if (!(largest > ClosingTuning::kStuckGap * size)) return found;  // every part of the gap could be closed
  found.residual = largest;

  std::vector<int> joints;
  for (int j = 0; j < world.joint_count(); ++j)
    if (share[j] > ClosingTuning::kStuckShare * largest) joints.push_back(j);
  std::stable_sort(joints.begin(), joints.end(), [&](int a, int b) { return share[a] > share[b]; });
  if (joints.size() <= ClosingTuning::kDenseSetLimit) {
    // Deletion filter, the least involved first: whoever is not needed for the contradiction goes.
    for (std::size_t k = joints.size(); k-- > 0;) {
      std::vector<int> rest = joints;
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(k));
      if (!rest.empty() && contradict(system, phi, rest)) joints.swap(rest);
    }
  } else {
    std::sort(joints.begin(),
              joints.end());  // the order of the scene says more than shares that hardly differ
  }
  for (int j : joints) found.joints.push_back({j});
  return found;
}

}  // namespace taut
