#include <algorithm>

#include "solvers/laws/axis_forces.h"
#include "solvers/system/constraint_system.h"

// Springs of axes that are too stiff for the step.  (solvers/laws, "Axes")
//
// The midpoint rule keeps the energy of a spring as long as S_rr is the same in both kicks.  Elsewhere
// directions and levers turn with the bodies, and λ²(S₁ − S₀)/2 is work that no potential returns: where
// h²k > m, so that λ is as large as the momentum, a part (S₁ − S₀)/S of the spring's energy in each step.
// The excess e of (solvers/laws, Eq. 3) is a force from nearer the end of the step in the first kick and an
// implicit damper in the second.  For h²k/m → ∞ both eigenvalues of a step tend to 0, and with S constant
// the energy changes by
//
//     −Σ (2 e w² + e θ̇₁²) − ½ (e θ̇₁)ᵀ S (e θ̇₁) ≤ 0,
//
// so that e may differ from step to step and from axis to axis.  Its second bound lets an axis that is
// stretched by d ≥ d₁ return by no more than d₁, however short the step: the midpoint rule would go as far
// beyond the rest, and Newton's method does not follow bodies around within a step.  e acts on rates alone,
// so what rests on such a spring has no velocity.  What e takes is booked as integration.  Where the inertia
// is constant (one freedom against a fixed body, springs between centres) the midpoint rule stays.
namespace taut {
namespace {

/// Equality rows of a joint that leaves one freedom, and of one that leaves none.
constexpr int kAllButOne = 5, kAll = 6;
/// Rows of a joint of which no more than this part is left across the others depend on them.
constexpr double kDependent = 1e-6;
/// A spring that is not resolved turns no body by more than this in a step [rad].
constexpr double kUnresolvedTurn = 0.2;

/// The bodies of a joint that nothing else holds, along one of its axes.
struct Pair {
  double inertia = 0;
  double turning = 0;  ///< of the body that turns more, over the way along the axis [rad per m or rad]
};

/// What the rows of the joint that are equalities leave of W_r is A⁻¹ times the twists by a unit impulse.
/// `kSize` is 6 times the bodies of the joint, or dynamic.
template <int kSize>
Pair pair_of(ConstraintSystem& system, int row) {
  using Row = Eigen::Matrix<double, kSize, 1>;
  const Rows& rows = system.rows();
  const Rows::JointRows& joint = rows.joints()[rows.row(row).block];
  const std::span<const double> weighted = system.weighted();
  const auto row_of_W = [&](int k) {
    Row W = Row::Zero(6 * joint.side_count);
    for (int s = 0; s < joint.side_count; ++s) {
      const Rows::Side& side = rows.sides()[joint.first_side + s];
      if (system.inverse_mass(side.body).moves())
        W.template segment<6>(6 * s) =
            Eigen::Map<const Eigen::Matrix<double, 6, 1>>(weighted.data() + side.whole + 6 * k);
    }
    return W;
  };
  // Orthonormal.
  Eigen::Matrix<double, kSize, kSize == Eigen::Dynamic ? Eigen::Dynamic : kAll> held(
      6 * joint.side_count, std::max<Eigen::Index>(kAll, joint.equality_count));
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
    const Vec3 w = system.inverse_mass(body).rotation * left.template segment<3>(6 * s);
    pair.turning = std::max(pair.turning, pair.inertia * w.norm());
  }
  return pair;
}

/// Of joints of two bodies, and of pulleys, gears and the like, which have more.
Pair pair_of(ConstraintSystem& system, int row) {
  const Rows& rows = system.rows();
  const Rows::JointRows& joint = rows.joints()[rows.row(row).block];
  return joint.side_count == 2 && joint.equality_count <= kAll ? pair_of<12>(system, row)
                                                               : pair_of<Eigen::Dynamic>(system, row);
}

/// Of a spring at a stretch.
double stiffness_of(const AxisSpring& spring, double stretch) {
  return spring.table ? spring.table->slope(stretch) : spring.stiffness;
}

/// Slope beyond that of the midpoint rule, or of implicit Euler in a single kick: see (solvers/laws, Eq. 3).
double excess_of(const Pair& pair, double hhk, double stretch, bool single_kick) {
  const double turn = std::max(kUnresolvedTurn, pair.turning * std::abs(stretch)) / kUnresolvedTurn;
  if (single_kick) return std::max(0.0, (turn - 1) * hhk - pair.inertia);
  return std::max(0.25 * (hhk - pair.inertia), (0.5 * turn - 0.25) * hhk - pair.inertia);
}

}  // namespace

bool AxisForces::find_unresolved(ConstraintSystem& system, bool single_kick) {
  bool any = false;
  if (!has_springs_) return false;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    Axis& axis = axes_[i];
    const AxisProperties& p = properties(i);
    axis.excess = axis.limit_excess = 0;
    if (released_[i] || axis.inertia == 0) continue;
    const double stretch = p.spring ? axis.theta0 - p.spring->rest : 0;
    const double past = has_soft_limit(p) ? beyond(*p.limits, axis.theta0) : 0;
    const double spring = p.spring ? stiffness_of(*p.spring, stretch) : 0;
    const double limit = has_soft_limit(p) ? 1 / p.limits->compliance : 0;
    const double hh = h_ * h_;
    if (hh * std::max(spring, limit) <= axis.inertia || has_constant_inertia(system.rows(), i)) continue;
    const Pair pair = pair_of(system, rows_[i].row);
    if (hh * spring > pair.inertia) axis.excess = excess_of(pair, hh * spring, stretch, single_kick);
    if (hh * limit > pair.inertia) axis.limit_excess = excess_of(pair, hh * limit, past, single_kick);
    any = any || hh * spring > pair.inertia ||
          (hh * limit > pair.inertia && (past != 0 || beyond(*p.limits, axis.theta0 + h_ * axis.rate0) != 0));
  }
  return any;
}

/// A body that can move in one way only against one that is fixed has the same inertia everywhere, and so
/// have bodies that are pulled at their centres, and one that cannot turn against one that is fixed.
bool AxisForces::has_constant_inertia(const Rows& rows, std::size_t i) const {
  if (rows_[i].spring.index >= 0) {
    const LineSpring& spring = *world_.force(rows_[i].spring).spring();
    const auto is_lever = [&](BodyId b, const Vec3& p) { return !world_.is_fixed(b) && !p.isZero(0); };
    return !is_lever(spring.a, spring.p_AP) && !is_lever(spring.b, spring.p_BQ);
  }
  const JointId joint = rows_[i].axis.joint;
  const std::span<const BodyId> bodies = world_.joint(joint).bodies();
  if (std::none_of(bodies.begin(), bodies.end(), [&](BodyId b) { return world_.is_fixed(b); })) return false;
  const Rows::JointRows& of = rows.joints()[joint.index];
  int rigid = 0, rotations = 0;
  for (int k = 0; k < of.equality_count; ++k) {
    rigid += rows.is_equality(of.first_row + k);
    rotations += rows.is_equality(of.first_row + k) && rows.row(of.first_row + k).angular;
  }
  return rigid == kAllButOne || rotations == 3;
}

}  // namespace taut
