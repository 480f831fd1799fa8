#include "solvers/integrators/velocity_projection.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/base/shared_loop.h"
#include "core/constraints/row_products.h"
#include "solvers/common/max_abs.h"
#include "solvers/integrators/kick_works.h"

namespace taut {
namespace {

/// Without a unit: parts and counts.  Chosen, where nothing else is said.  (solvers/integrators, "RATTLE")
struct VelocityProjectionTuning {
  /// Passes with S_ε⁻¹ at most.
  static constexpr int kMaxVelocityPasses = 6;
  /// A part of the rates that each pass leaves is summed up if it is no more than this, and has been the same
  /// to that part of itself in so many sub-steps in a row.
  static constexpr double kMostLeftOver = 0.2, kAlike = 0.05;
  static constexpr int kSteady = 20;

  // Conjugate gradients, where passes are not enough.
  /// Rates [m/s or rad/s] that are left behind: a taut row without sag has some that no finite impulse takes
  /// away.
  static constexpr double kLeftBehind = 1e-6;
  /// They end after so many steps, or where this part is left of what they started with, in the square of the
  /// norm of S_ε⁻¹: round-off.
  static constexpr int kMaxConjugate = 60;
  static constexpr double kDescended = 1e-20;
  /// Impulses grow at most so many times.  Six passes give a direction that rows hold with σ the part 6 σ/ε
  /// of its impulse: those with σ < ε/18,000 are taken for dependent.  Light bodies between heavy ones need
  /// 1,100; rows that disagree are seen from 4,600 on.
  static constexpr double kMostGrowth = 3000;
  /// Passes after them, since their steps along weak directions, which are long, leave round-off along
  /// others.
  static constexpr int kLastPasses = 3;
};

}  // namespace

VelocityProjection::VelocityProjection(ConstraintSystem& system, const Settings& settings,
                                       const Breaking& breaking, Phase& phase, RowValues& values)
    : system_(system),
      settings_(settings),
      breaking_(breaking),
      phase_(phase),
      values_(values),
      last_rates_(values.joint_rates.size(), 0.0) {}

void VelocityProjection::clear_loose_rows(std::span<double> rows) const {
  breaking_.clear_rows(rows);
  system_.clear_bounded_rows(rows);
}

bool VelocityProjection::accepts(double velocity_residual) const {
  return velocity_residual <=
         (system_.singular() ? VelocityProjectionTuning::kLeftBehind : settings_.velocity_tolerance);
}

bool VelocityProjection::project(double h, SubstepReport& report) {
  const std::vector<double>& rates = values_.joint_rates;
  std::fill(values_.mu.begin(), values_.mu.end(), 0.0);
  twists_and_rates([this, h](int b) {
    if (h != 0) phase_.second_kick(b, h);
  });
  for (int pass = 0; pass < VelocityProjectionTuning::kMaxVelocityPasses; ++pass) {
    const double sum =
        pass > 0 && steady_count_ >= VelocityProjectionTuning::kSteady ? 1 / (1 - contraction_) : 1;
    if (pass == 1) last_rates_ = rates;
    const bool closed = refine(sum, report);
    if (pass == 1) watch_contraction(sum);
    if (closed) return true;
  }
  if (report.velocity_residual > VelocityProjectionTuning::kLeftBehind) project_by_descent(report);
  return false;
}

/// μ ← μ − `sum` S_ε⁻¹ (J V + φ_t).
/// @returns whether rates are within their tolerance then.
bool VelocityProjection::refine(double sum, SubstepReport& report) {
  std::vector<double>& correction = values_.correction;
  for (int r = 0; r < system_.row_count(); ++r) correction[r] = -sum * values_.joint_rates[r];
  system_.solve_shifted(correction);
  push(correction, 1);
  for (int r = 0; r < system_.row_count(); ++r) values_.mu[r] += correction[r];
  report.velocity_residual = max_abs(values_.joint_rates);
  return report.velocity_residual <= settings_.velocity_tolerance;
}

/// Conjugate gradients and passes after them; given up if rates are no less then, if bodies have gained
/// energy, as no projection gives them, or if impulses have grown beyond measure: dependent rows disagree
/// where joints are open, as they are halfway through a step from velocities that joints forbid.
void VelocityProjection::project_by_descent(SubstepReport& report) {
  const std::vector<Wrench> momenta = phase_.momenta;
  const std::vector<double> mu = values_.mu;
  const double left = report.velocity_residual, energy = doubled_kinetic_energy();
  descend(report);
  for (int pass = 0; pass < VelocityProjectionTuning::kLastPasses; ++pass)
    if (refine(1, report)) break;
  const bool gained = !system_.rows().depends_on_time() &&
                      doubled_kinetic_energy() > energy * (1 + KickWorksTuning::kUnseenEnergy);
  const bool immense = max_abs(values_.mu) > VelocityProjectionTuning::kMostGrowth * max_abs(mu);
  if (report.velocity_residual < left && !gained && !immense) return;
  phase_.momenta = momenta;
  values_.mu = mu;
  twists_and_rates([](int) {});
  report.velocity_residual = left;
}

double VelocityProjection::doubled_kinetic_energy() const {
  double sum = 0;
  for (int b = 0; b < std::ssize(phase_.momenta); ++b)
    if (system_.inverse_mass(b).moves()) sum += dot(phase_.momenta[b], phase_.state.twists[b]);
  return sum;
}

/// What the passes have left, of several directions that rows hold weakly, by conjugate gradients on
/// S μ = −(J V + φ_t) with S_ε⁻¹ before it: as many steps as there are such directions.
void VelocityProjection::descend(SubstepReport& report) {
  const int rows = system_.row_count();
  const Eigen::Map<const Eigen::VectorXd> rates(values_.joint_rates.data(), rows);
  Eigen::Map<Eigen::VectorXd> mu(values_.mu.data(), rows);
  std::vector<double> direction(rows);
  Eigen::Map<Eigen::VectorXd> along(direction.data(), rows);
  Eigen::VectorXd before = Eigen::VectorXd::Zero(rows), ascent(rows);
  double first = 0, height = 0;  // −(J V + φ_t)·S_ε⁻¹ (J V + φ_t), at first and now
  for (int step = 0; step < VelocityProjectionTuning::kMaxConjugate; ++step) {
    ascent = -rates;
    system_.solve_shifted({ascent.data(), static_cast<std::size_t>(rows)});
    const double keep = step > 0 ? std::max(ascent.dot(before - rates) / height, 0.0) : 0;
    height = -ascent.dot(rates);
    if (step == 0) first = height;
    if (!(height > VelocityProjectionTuning::kDescended * first)) return;
    along = ascent + keep * along;
    before = rates;
    push(direction, 1);
    const double curvature = along.dot(rates - before);
    const double length = curvature > 0 ? -along.dot(before) / curvature : 0;
    push(direction, length - 1);
    mu += length * along;
    report.velocity_residual = max_abs(values_.joint_rates);
    if (report.velocity_residual <= settings_.velocity_tolerance || !(curvature > 0)) return;
  }
}

/// p += `by` Jᵀ times these.
void VelocityProjection::push(std::span<const double> impulses, double by) {
  twists_and_rates([this, impulses, by](int b) {
    phase_.momenta[b] =
        phase_.momenta[b] + by * detail::wrench_on(system_.rows(), b, system_.jacobian(), impulses);
  });
}

/// Momenta as `change` makes them of each body that moves, then twists and J V + φ_t: each joint as soon as
/// the twists of its bodies are there, while its Jacobian is still near.
template <typename Change>
void VelocityProjection::twists_and_rates(Change change) {
  const Rows& rows = system_.rows();
  State& state = phase_.state;
  const auto twist = [&](int b) {
    if (!system_.inverse_mass(b).moves()) return;
    change(b);
    state.twists[b] = system_.inverse_mass(b).twist(phase_.momenta[b]);
  };
  const auto rates = [&](const Rows::JointRows& joint) {
    detail::rates_of(rows, joint, system_.jacobian(), state.twists, values_.joint_rates);
  };
  const int bodies = static_cast<int>(state.poses.size());
  if (const detail::LoopThreads& threads = system_.loop_threads()) {
    detail::for_ranges(threads, bodies, [&](int begin, int end) {
      for (int b = begin; b < end; ++b) twist(b);
    });
    detail::for_ranges(threads, bodies, [&](int begin, int end) {
      for (int b = begin; b < end; ++b)
        for (int j : rows.joints_due(b)) rates(rows.joints()[j]);
    });
  } else {
    for (int b = 0; b < bodies; ++b) {
      twist(b);
      for (int j : rows.joints_due(b)) rates(rows.joints()[j]);
    }
  }
  rows.add_rate(state, values_.joint_rates);
  clear_loose_rows(values_.joint_rates);
}

/// What the second pass leaves of its rates, or would have left without `sum`, as a part of them.
void VelocityProjection::watch_contraction(double sum) {
  double before = 0, after = 0;
  for (int r = 0; r < system_.row_count(); ++r) {
    before += last_rates_[r] * last_rates_[r];
    after += last_rates_[r] * values_.joint_rates[r];
  }
  const double left = before > 0 ? 1 - (1 - after / before) / sum : 0;
  const bool alike = left > 0 && left <= VelocityProjectionTuning::kMostLeftOver &&
                     std::abs(left - contraction_) <= VelocityProjectionTuning::kAlike * left;
  steady_count_ = alike ? steady_count_ + 1 : 0;
  contraction_ = left;
}

}  // namespace taut
