#include <algorithm>

#include "solvers/axis_forces.h"
#include "solvers/constraint_system.h"

// Springs of axes that are too stiff for the step.  (solvers/README, "Axes")
namespace taut {
namespace {

/// Equality rows of a joint that leaves one freedom, and of one that leaves none.
constexpr int kAllButOne = 5, kAll = 6;
/// Rows of a joint of which no more than this part is left across the others depend on them.
constexpr double kDependent = 1e-6;
/// A spring that is not resolved turns no body by more than this in a step [rad].
constexpr double kTurn = 0.2;

/// Two bodies of a joint that nothing else holds, along one of its axes.
struct Pair {
  double inertia = 0;
  double turning = 0;  ///< of the body that turns more, over the way along the axis [rad per m or rad]
};

/// What the rows of the joint that are equalities leave of W_r is A⁻¹ times the twists by a unit impulse.
Pair pair_of(ConstraintSystem& system, int row) {
  using Row = Eigen::Matrix<double, 12, 1>;
  const Rows& rows = system.rows();
  const Rows::JointRows& joint = rows.joints()[rows.row(row).joint];
  const std::span<const double> weighted = system.weighted();
  const auto row_of_W = [&](int k) {
    Row W = Row::Zero();
    for (int s = 0; s < joint.side_count; ++s) {
      const Rows::Side& side = rows.sides()[joint.first_side + s];
      if (system.inverse_mass(side.body).moves())
        W.segment<6>(6 * s) =
            Eigen::Map<const Eigen::Matrix<double, 6, 1>>(weighted.data() + side.whole + 6 * k);
    }
    return W;
  };
  Eigen::Matrix<double, 12, kAll> held;  // orthonormal
  int count = 0;
  const auto across = [&](Row W) {
    for (int pass = 0; pass < 2; ++pass)  // the second takes off what round-off has left
      for (int c = 0; c < count; ++c) W -= held.col(c).dot(W) * held.col(c);
    return W;
  };
  for (int k = 0; k < joint.equality_count; ++k) {
    if (!rows.is_equality(joint.first_row + k)) continue;  // softened
    const Row W = row_of_W(k), rest = across(W);
    if (rest.norm() > kDependent * W.norm()) held.col(count++) = rest.normalized();
  }
  const Row left = across(row_of_W(row - joint.first_row));
  Pair pair{.inertia = 1 / left.squaredNorm()};
  for (int s = 0; s < joint.side_count; ++s) {
    const int body = rows.sides()[joint.first_side + s].body;
    const Vec3 w = system.inverse_mass(body).rotation * left.segment<3>(6 * s);
    pair.turning = std::max(pair.turning, pair.inertia * w.norm());
  }
  return pair;
}

}  // namespace

/// The larger of (h²k − m)/4, beyond ω h = 1, and of what lets the axis go back by a part of its stretch
/// only.
void AxisForces::find_unresolved(ConstraintSystem& system) {
  if (!has_springs_) return;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    Axis& axis = axes_[i];
    const AxisProperties& p = properties(i);
    axis.excess = 0;
    const bool soft = rows_[i].axis.axis < 0 && rows_[i].spring.index < 0;
    if (soft || !p.spring || released_[i] || axis.inertia == 0) continue;
    const double stretch = axis.theta0 - p.spring->rest;
    const double hhk = h_ * h_ * (p.spring->table ? p.spring->table->slope(stretch) : p.spring->stiffness);
    if (hhk <= axis.inertia || has_constant_inertia(system.rows(), i)) continue;
    const Pair pair = pair_of(system, rows_[i].row);
    if (!(hhk > pair.inertia)) continue;
    const double turn = std::max(kTurn, pair.turning * std::abs(stretch));
    axis.excess = std::max(0.25 * (hhk - pair.inertia), (0.5 * turn / kTurn - 0.25) * hhk - pair.inertia);
  }
}

/// A body that can move in one way only against one that is fixed has the same inertia everywhere, and so
/// have bodies that are pulled at their centres.
bool AxisForces::has_constant_inertia(const Rows& rows, std::size_t i) const {
  if (rows_[i].spring.index >= 0) {
    const LineSpring& spring = *world_.force(rows_[i].spring).spring();
    const auto is_lever = [&](BodyId b, const Vec3& p) { return !world_.is_fixed(b) && !p.isZero(0); };
    return !is_lever(spring.a, spring.p_AP) && !is_lever(spring.b, spring.p_BQ);
  }
  const JointId joint = rows_[i].axis.joint;
  const std::span<const BodyId> bodies = world_.joint(joint).bodies();
  return rows.joints()[joint.index].equality_count == kAllButOne && !world_.compliance(joint) &&
         std::any_of(bodies.begin(), bodies.end(), [&](BodyId b) { return world_.is_fixed(b); });
}

}  // namespace taut
