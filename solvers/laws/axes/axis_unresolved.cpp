#include "solvers/laws/axes/axis_unresolved.h"

#include <algorithm>
#include <cmath>

#include "solvers/system/constraint_system.h"

namespace taut {
namespace {

/// Equality rows of a joint that leaves one freedom, and of one that leaves none.
constexpr int kAllButOne = 5, kAll = 6;
struct AxisUnresolvedTuning {
  /// Rows of a joint of which no more than this part is left across the others depend on them.
  /// Chosen.
  static constexpr double kDependent = 1e-6;
  /// A spring that is not resolved turns no body by more than this in a step [rad].  Chosen.
  static constexpr double kTurn = 0.2;
};

/// The bodies of a joint that nothing else holds, along one of its axes.
struct Pair {
  double effective_mass = 0;
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
    if (rest.norm() > AxisUnresolvedTuning::kDependent * W.norm()) held.col(count++) = rest.normalized();
  }
  const Row left = across(row_of_W(row - joint.first_row));
  Pair pair{.effective_mass = 1 / left.squaredNorm()};
  for (int s = 0; s < joint.side_count; ++s) {
    const int body = rows.sides()[joint.first_side + s].body;
    const Vec3 w = system.inverse_mass(body).rotation * left.template segment<3>(6 * s);
    pair.turning = std::max(pair.turning, pair.effective_mass * w.norm());
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

/// A spring or soft limit where it is at θ₀.
struct Stretched {
  double stiffness = 0;  ///< k [N·m/rad or N/m]; 0: none
  double stretch = 0;    ///< d [rad or m]
};

Stretched spring_of(const AxisProperties& p, double theta) {
  if (!p.spring) return {};
  const double stretch = theta - p.spring->rest;
  return {p.spring->table ? p.spring->table->slope(stretch) : p.spring->stiffness, stretch};
}

Stretched soft_limit_of(const AxisProperties& p, double theta) {
  if (!has_soft_limit(p)) return {};
  return {1 / p.limits->compliance, beyond(*p.limits, theta)};
}

/// Slope beyond that of the midpoint rule, or of implicit Euler in a single kick: see (solvers/laws, Eq. 3).
double excess_of(const Pair& pair, double hh, const Stretched& at, bool single_kick) {
  const double hhk = hh * at.stiffness;
  const double turn = std::max(AxisUnresolvedTuning::kTurn, pair.turning * std::abs(at.stretch)) /
                      AxisUnresolvedTuning::kTurn;
  if (single_kick) return std::max(0.0, (turn - 1) * hhk - pair.effective_mass);
  return std::max(0.25 * (hhk - pair.effective_mass), (0.5 * turn - 0.25) * hhk - pair.effective_mass);
}

/// A body that can move in one way only against one that is fixed has the same effective mass everywhere, and
/// so have bodies that are pulled at their centres, and one that cannot turn against one that is fixed.
bool has_constant_effective_mass(const AxisTable& table, const Rows& rows, std::size_t i) {
  const World& world = table.world();
  const Rows::AxisRow& row = table.rows()[i];
  if (const Rows::SpringRow* of_spring = row.spring()) {
    const LineSpring& spring = *world.force(of_spring->spring).spring();
    const auto is_lever = [&](BodyId b, const Vec3& p) { return !world.is_fixed(b) && !p.isZero(0); };
    return !is_lever(spring.a, spring.p_AP) && !is_lever(spring.b, spring.p_BQ);
  }
  const JointId joint = *row.joint();
  const std::span<const BodyId> bodies = world.joint(joint).bodies();
  if (std::none_of(bodies.begin(), bodies.end(), [&](BodyId b) { return world.is_fixed(b); })) return false;
  const Rows::JointRows& of = rows.joints()[joint.index];
  int rigid = 0, rotations = 0;
  for (int k = 0; k < of.equality_count; ++k) {
    rigid += rows.is_equality(of.first_row + k);
    rotations += rows.is_equality(of.first_row + k) && rows.row(of.first_row + k).angular;
  }
  return rigid == kAllButOne || rotations == 3;
}

}  // namespace

bool find_unresolved(const AxisTable& table, std::span<AxisLaw> axes, double h, ConstraintSystem& system,
                     bool single_kick) {
  bool any = false;
  const double hh = h * h;
  for (AxisLaw& axis : axes) axis.springs.excess = axis.springs.limit_excess = 0;
  for (const int i : table.sprung()) {
    AxisSpringLaw& springs = axes[i].springs;
    const AxisStart& start = axes[i].start;
    if (table.released(i) || start.effective_mass == 0) continue;
    const AxisProperties& p = table.properties(i);
    const Stretched spring = spring_of(p, start.theta), limit = soft_limit_of(p, start.theta);
    if (hh * std::max(spring.stiffness, limit.stiffness) <= start.effective_mass ||
        has_constant_effective_mass(table, system.rows(), i))
      continue;
    const Pair pair = pair_of(system, table.row(i));
    const bool stiff_spring = hh * spring.stiffness > pair.effective_mass;
    const bool stiff_limit = hh * limit.stiffness > pair.effective_mass;
    if (stiff_spring) springs.excess = excess_of(pair, hh, spring, single_kick);
    if (stiff_limit) springs.limit_excess = excess_of(pair, hh, limit, single_kick);
    any = any || stiff_spring ||
          (stiff_limit && (limit.stretch != 0 || beyond(*p.limits, start.theta + h * start.rate) != 0));
  }
  return any;
}

}  // namespace taut
