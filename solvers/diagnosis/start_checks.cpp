#include "solvers/diagnosis/start_checks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "collision/contact_finder.h"
#include "core/math/dense.h"
#include "solvers/common/setting_checks.h"
#include "solvers/laws/contact_cache.h"
#include "solvers/system/constraint_system.h"

namespace taut {
namespace {

/// Chosen, where nothing else is said.
struct StartChecksTuning {
  /// Rates below are left to a step, too [m/s or rad/s].
  static constexpr double kRateTolerance = 1e-9;
  /// Part of a sum that is no round-off of what was typed into a file, with some six digits.
  static constexpr double kTypedPart = 1e-6;
  /// Solves that refine the impulses which would stop forbidden rates.  Chosen.
  static constexpr int kPasses = 4;
  /// ω h [rad] at which the leapfrog and semi-implicit Euler begin to grow.
  static constexpr double kExplicitLimit = 2;
};

/// J V + φ_t of the rows of joints that are off by more than round-off, 0 of all others.
std::vector<double> forbidden_rates(const Rows& rows, std::span<const double> J, const State& state) {
  std::vector<double> rates(rows.row_count()), driven(rows.row_count());
  rows.add_rate(state, driven);
  for (const Rows::JointRows& joint : rows.joints())
    for (int r = joint.first_row; r < joint.first_row + joint.equality_count; ++r) {
      if (!rows.is_equality(r)) continue;
      double sum = 0, parts = 0;
      for (int s = joint.first_side; s < joint.first_side + joint.side_count; ++s) {
        const Rows::Side& side = rows.sides()[s];
        const Twist& V = state.twists[side.body];
        const Eigen::Matrix<double, 6, 1> block = Rows::block_row(side, J, r - joint.first_row);
        sum += block.head<3>().dot(V.w) + block.tail<3>().dot(V.v);
        parts +=
            block.head<3>().cwiseAbs().dot(V.w.cwiseAbs()) + block.tail<3>().cwiseAbs().dot(V.v.cwiseAbs());
      }
      const double rate = sum + driven[r];
      if (parts > 0 &&
          std::abs(rate) > std::max(StartChecksTuning::kRateTolerance,
                                    StartChecksTuning::kTypedPart * (parts + std::abs(driven[r]))))
        rates[r] = rate;
    }
  return rates;
}

/// What a unit force at point p_BP changes of its velocity, world axes [1/kg].
Mat3 mobility(const World& world, const MassMatrix& mass, BodyId body, const Vec3& p_BP) {
  if (!world.moves(body)) return Mat3::Zero();
  const Pose& pose = world.pose(body);
  const Vec3 r = pose.q * p_BP;
  Mat3 m = mass[body.index].inverse_mass * Mat3::Identity();
  for (int k = 0; k < 3; ++k)
    m.col(k) += mass.angular_velocity(body.index, pose, r.cross(Vec3::Unit(k))).cross(r);
  return m;
}

double frequency(const World& world, const MassMatrix& mass, const LineSpring& spring) {
  const Mat3 m = mobility(world, mass, spring.a, spring.p_AP) + mobility(world, mass, spring.b, spring.p_BQ);
  const Vec3 line = world.pose(spring.b).point(spring.p_BQ) - world.pose(spring.a).point(spring.p_AP);
  const double length = line.norm();
  const AxisSpring& law = spring.law;
  const double stiffness = law.table ? law.table->slope(length - law.rest) : law.stiffness;
  const bool may_meet = spring.is_centred() || length == 0;
  const double along =
      may_meet ? dense::symmetric_eigenvalues3(m)[2] : line.dot(m * line) / (length * length);
  return std::sqrt(std::max(0.0, stiffness * along));
}

/// Bodies whose deepest contact is beyond what least(contact) says, deepest first.
template <typename Least>
std::vector<StartOverlap> overlaps_beyond(const Least& least, const World& world) {
  std::map<std::pair<BodyId, BodyId>, double> depths;
  ContactFinder finder({.margin = 0, .threads = 1});
  for (const Contact& contact : finder.find(world)) {
    if (!(-contact.gap > least(contact))) continue;
    double& depth = depths[std::minmax(contact.A, contact.B)];
    depth = std::max(depth, -contact.gap);
  }
  std::vector<StartOverlap> found;
  for (const auto& [pair, depth] : depths) found.push_back({pair.first, pair.second, depth});
  std::stable_sort(found.begin(), found.end(),
                   [](const StartOverlap& a, const StartOverlap& b) { return a.depth > b.depth; });
  return found;
}

}  // namespace

ForbiddenVelocity forbidden_velocity(const World& world) {
  ForbiddenVelocity found;
  const State& state = world.state();
  const bool rests = std::all_of(state.twists.begin(), state.twists.end(),
                                 [](const Twist& V) { return V.w.isZero(0) && V.v.isZero(0); });
  if (rests) return found;
  ConstraintSystem system(world, FactorChoice::kAuto);
  system.linearize(state);
  const Rows& rows = system.rows();
  const std::vector<double> rates = forbidden_rates(rows, system.jacobian(), state);
  std::vector<std::pair<double, int>> worst;
  for (int j = 0; j < static_cast<int>(rows.joints().size()); ++j) {
    const auto first = rates.begin() + rows.joints()[j].first_row;
    const double rate = std::accumulate(first, first + rows.joints()[j].equality_count, 0.0,
                                        [](double most, double r) { return std::max(most, std::abs(r)); });
    if (rate > 0) worst.push_back({-rate, j});
  }
  if (worst.empty()) return found;
  std::sort(worst.begin(), worst.end());
  for (const auto& [rate, j] : worst) found.joints.push_back({j});

  StageTimes times;
  system.set_mass(state.poses);
  system.release_bounded_rows();
  system.factorize(times);
  // S λ = −rates, refined: dependent rows make one solve inexact.
  std::vector<double> impulses(rates.size()), delta(rates.size()), reached(rates.size());
  for (int pass = 0; pass < StartChecksTuning::kPasses; ++pass) {
    for (std::size_t r = 0; r < rates.size(); ++r) delta[r] = -rates[r] - reached[r];
    system.clear_bounded_rows(delta);
    system.solve(delta);
    for (std::size_t r = 0; r < rates.size(); ++r) impulses[r] += delta[r];
    system.multiply(impulses, reached);
  }
  std::vector<Wrench> wrenches(system.mass().size());
  rows.apply_transpose(system.jacobian(), impulses, wrenches);
  for (int b = 0; b < system.mass().size(); ++b) {
    if (system.mass()[b].fixed) continue;
    const Vec3 spin = system.mass().angular_velocity(b, state.poses[b], wrenches[b].torque);
    found.spin = std::max(found.spin, spin.norm());
    found.speed = std::max(found.speed, system.mass()[b].inverse_mass * wrenches[b].force.norm());
  }
  return found;
}

std::vector<SpringFrequency> too_fast_springs(const World& world, double h) {
  std::vector<SpringFrequency> found;
  const MassMatrix mass(world);
  for (const ForceId id : world.springs())
    if (const double omega = frequency(world, mass, *world.force(id).spring());
        omega * h > StartChecksTuning::kExplicitLimit)
      found.push_back({id, omega});
  std::stable_sort(found.begin(), found.end(),
                   [](const SpringFrequency& a, const SpringFrequency& b) { return a.omega > b.omega; });
  return found;
}

std::vector<StartOverlap> start_overlaps(const World& world) {
  return overlaps_beyond([&](const Contact& contact) { return overlap_depth(world, contact); }, world);
}

std::vector<StartOverlap> overlaps_deeper_than(double depth, const World& world) {
  return overlaps_beyond([&](const Contact&) { return depth; }, world);
}

UnsupportedPairs unsupported_pairs(const World& world) {
  constexpr std::size_t kFirst = 100;
  // Convex shapes have contacts with everything.
  std::vector<ShapeId> others;
  const Shape ground = HalfSpace{}, surface = TriangleMesh{};
  for (int i = 0; i < world.shape_count(); ++i) {
    const Shape& shape = *world.shape({i}).shape;
    if (!have_contacts(shape, ground) || !have_contacts(shape, surface)) others.push_back({i});
  }
  UnsupportedPairs found;
  for (std::size_t i = 0; i < others.size(); ++i)
    for (std::size_t k = i + 1; k < others.size(); ++k) {
      const ShapeId a = others[i], b = others[k];
      if (have_contacts(*world.shape(a).shape, *world.shape(b).shape) || !world.may_collide(a, b)) continue;
      ++found.count;
      if (found.first.size() < kFirst) found.first.emplace_back(a, b);
    }
  return found;
}

Crowd start_crowd(const World& world, const Settings& settings, double dt) {
  if (!settings.contacts || has_no_laws(settings.integrator)) return {};
  ContactFinder finder({.margin = settings.contact_margin,
                        .threads = settings.threads,
                        .max_contacts = settings.max_contacts});
  finder.find(world, dt);
  return finder.report().crowd;
}

double coarsest_position(const World& world) {
  double farthest = 0;
  for (const Pose& pose : world.state().poses) farthest = std::max(farthest, pose.p.cwiseAbs().maxCoeff());
  return std::nextafter(farthest, std::numeric_limits<double>::infinity()) - farthest;
}

}  // namespace taut
