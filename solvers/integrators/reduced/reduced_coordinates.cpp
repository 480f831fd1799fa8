#include "solvers/integrators/reduced/reduced_coordinates.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/state/reach.h"
#include "core/world/diagnostics.h"
#include "solvers/common/setting_checks.h"
#include "solvers/common/stopwatch.h"
#include "solvers/integrators/step_limit.h"

namespace taut {

namespace {

/// Parts of the sizes of a step, and counts.  Chosen, where nothing else is said.
struct MidpointTuning {
  /// The equation is solved when this is left, or, where round-off is more, when passes gain nothing any more
  /// and no more than the second is left.
  static constexpr double kTolerance = 1e-13, kRoundOff = 1e-10;
  /// A pass that leaves more than this part of the error has gained nothing; after so many of them it ends.
  /// kGain: twice fails at chains.
  static constexpr double kGain = 0.7;
  static constexpr int kPatience = 3, kMostPasses = 100;
  /// Newton steps of a joint at least: to round-off, or else passes see steps of the size of the tolerance.
  /// Half fails at a chain in long steps.
  static constexpr int kClosings = 2;
  /// Least sizes of a step, by which it is not asked for more than round-off allows: a rotation [rad], and a
  /// part of the distance of bodies from the origin.
  static constexpr double kLeast = 1e-3;
};

/// Of Runge–Kutta.  Chosen, where nothing else is said.
struct TrialTuning {
  /// A step in which ω h grows beyond this times max_tension_number is taken again, with an ω that is larger
  /// by no more than the second, since that of an unstable step means nothing.  It is stable up to 2.8.
  static constexpr double kTension = 2, kGrowth = 2;
};

/// Of events.  Chosen, where nothing else is said.
struct AxisEventTuning {
  /// Steps that look for one; it is found as well when this part of the step is left between two of them.
  static constexpr int kTrials = 60;
  /// The margin that is looked for, between −1 and 0.
  static constexpr double kAim = -0.5;
  /// Events of a step.
  static constexpr int kMost = 10000;
  /// An event is located where it is known to this part of the step.
  static constexpr double kNear = 1e-13;
  /// A trial is at least this part of what is left away from its ends.
  static constexpr double kInside = 1e-4;
};

/// Largest rotation and displacement of bodies, or of their rates.
struct Sizes {
  double turn = 0, shift = 0;
  void add(const Vec3& w, const Vec3& v) {
    turn = std::max(turn, w.norm());
    shift = std::max(shift, v.norm());
  }
};

bool are_finite(std::span<const Wrench> forces) {
  return std::all_of(forces.begin(), forces.end(),
                     [](const Wrench& f) { return f.torque.allFinite() && f.force.allFinite(); });
}

}  // namespace

ReducedCoordinates::ReducedCoordinates(const World& world, ConstraintSystem& system, const Settings& settings)
    : Scheme(world, system.rows(), settings),
      world_(world),
      system_(system),
      settings_(settings),
      tree_(world, system.rows(), system.mass()),
      method_(is_lagrangian(settings.integrator) ? ClosedTree::Method::kLagrangian
                                                 : ClosedTree::Method::kRecursive),
      flow_(world, system.rows()),
      modes_(world, system.rows()),
      runge_kutta_(world.body_count()),
      follows_time_(system.rows().depends_on_time()) {
  for (auto* wrenches : {&forces_, &dissipative_, &axis_wrenches_, &momenta_})
    wrenches->resize(world.body_count());
  stiffness_.resize(world.body_count());
  roots_.resize(world.body_count());
  for (auto* twists : {&acceleration_, &moves_, &changes_}) twists->resize(world.body_count());
  for (auto* values : {&lambda_, &impulses_, &impulses_before_, &theta_, &rates_, &tau_, &driven_})
    values->assign(system.row_count(), 0.0);
}

/// Velocities that joints forbid are taken away as an impact would.
void ReducedCoordinates::start(const State& state, Velocities velocities, SubstepReport& report) {
  state_ = state;
  course_.settled = false;
  modes_.forget();
  tree_.hold({});
  if (velocities == Velocities::kGiven) {
    const Stopwatch watch(report.times.velocities);
    tree_.linearize(state_);
    tree_.project_velocities(state_);
    tree_.close_velocities(state_);
  }
  if (settings_.tension == TensionPolicy::kIgnore) return;
  accelerate(state_, report, acceleration_);
  omega_ = tension_of(state_);
}

/// The fastest transverse frequency at a state, from the forces that were found last, near it; 0 if nobody
/// wants to know.
double ReducedCoordinates::tension_of(const State& state) {
  if (settings_.tension == TensionPolicy::kIgnore) return 0;
  const MassMatrix& mass = system_.mass();
  for (int b = 0; b < mass.size(); ++b) {
    stiffness_[b] = {};
    if (mass[b].fixed) continue;
    roots_[b].rotation = mass.principal_axes(b, state.poses[b]) * mass[b].root_inverse_moments.asDiagonal();
    roots_[b].translation = std::sqrt(mass[b].inverse_mass);
  }
  system_.rows().stiffness(state, lambda_, stiffness_);
  return fastest_transverse_frequency(roots_, stiffness_);
}

/// After a trial whose end is `next_`: tension has grown so much in it that it was too long.
bool ReducedCoordinates::is_unstable(double h, double omega) {
  if (settings_.tension != TensionPolicy::kSubstep) return false;
  const double most = TrialTuning::kTension * settings_.max_tension_number;
  if (h * omega <= most) return false;
  const double largest = TrialTuning::kGrowth * most / h;
  omega_ = std::isfinite(omega) ? std::min(omega, largest) : largest;
  return true;
}

void ReducedCoordinates::begin(double dt) {
  flow_.begin();
  std::fill(impulses_.begin(), impulses_.end(), 0.0);
  modes_.refresh();
  course_ = {.length = dt, .start = state_.time};
}

double ReducedCoordinates::step_limit() const {
  double fastest = 0;
  for (const Twist& V : state_.twists) fastest = std::max(fastest, V.w.squaredNorm());
  double limit = fastest > 0 ? settings_.max_rotation / std::sqrt(fastest) : Scheme::step_limit();
  if (settings_.tension == TensionPolicy::kSubstep && omega_ > 0)
    limit = std::min(limit, settings_.max_tension_number / omega_);
  return limit;
}

Scheme::Outcome ReducedCoordinates::advance(double h, SubstepReport& report) {
  stall_ = Stall::kNone;
  not_finite_ = 0;
  const double expected = std::exchange(course_.event, 0), used = omega_;
  if (!begin_trial(report)) return give_up();
  double omega = 0;
  if (make_step(h, report)) omega = end_trial(h, expected, report);
  if (stall_ != Stall::kNone || course_.event > 0) {
    std::swap(impulses_, impulses_before_);
    flow_.roll_back();
    if (stall_ != Stall::kNone) course_.settled = false;
    return stall_ == Stall::kNone ? Outcome::kImpact : give_up();
  }
  system_.rows().update_axes(next_, next_.axes);
  modes_.report(flow_.reports());
  if (settings_.report_energy) close_works(report.works);
  std::swap(state_, next_);
  report.substeps = 1;
  report.tension_number = h * used;
  omega_ = omega;
  return Outcome::kDone;
}

bool ReducedCoordinates::begin_trial(SubstepReport& report) {
  if (!course_.settled) {
    if (std::isnan(course_.kinetic) && settings_.report_energy)
      course_.kinetic = kinetic_energy(world_, state_);
    if (!settle(state_, report)) return false;
    course_.settled = true;
  }
  impulses_before_ = impulses_;
  flow_.begin_substep();
  return true;
}

/// Whether the next state may be taken: else something stalls, or an event is within the step.  Where one is
/// at its end modes are those from there on.  @returns the fastest transverse frequency there.
double ReducedCoordinates::end_trial(double h, double expected, SubstepReport& report) {
  const double margin = margin_of_next(report), omega = tension_of(next_);
  if (is_unstable(h, omega))
    stall_ = Stall::kTension;
  else if (margin < -1 && h != expected)
    locate_event(h, margin, report);
  else if (margin < 0)
    settle(next_, report);
  return omega;
}

/// From the state to the next one in the modes that there are; false, with why, if it fails.
bool ReducedCoordinates::make_step(double h, SubstepReport& report) {
  next_ = state_;
  const bool closed = is_midpoint(settings_.integrator) ? midpoint(h, report) : runge_kutta(h, report);
  if (closed && !is_finite(next_)) stall_ = Stall::kNotFinite;
  // What blows up under forces that are finite was unstable.
  if (stall_ == Stall::kNotFinite && are_finite(forces_) && is_unstable(h, INFINITY))
    stall_ = Stall::kTension;
  return closed && stall_ == Stall::kNone;
}

Scheme::Outcome ReducedCoordinates::give_up() {
  return stall_ == Stall::kTension     ? Outcome::kUnstable
         : stall_ == Stall::kNotFinite ? Outcome::kNotFinite
                                       : Outcome::kStalled;
}

/// AxisModes' at the next state.
double ReducedCoordinates::margin_of_next(SubstepReport& report) {
  if (modes_.empty()) return INFINITY;
  accelerate(next_, report, acceleration_);
  return modes_.margin(theta_, rates_, lambda_, tau_);
}

/// Where within a step of h the first inequality ends, by steps of other lengths from its start: regula falsi
/// in Illinois' form on the margin, with bisection among it, since what is first may change.
void ReducedCoordinates::locate_event(double h, double margin, SubstepReport& report) {
  double left = 0, right = h, below = margin - AxisEventTuning::kAim, above = -below;
  int kept = 0;  // the end that the last trial has kept, −1 or 1
  for (int trial = 0; trial < AxisEventTuning::kTrials && right - left > AxisEventTuning::kNear * h;
       ++trial) {
    const double width = right - left, inside = AxisEventTuning::kInside * width;
    const double part = trial % 3 == 2 ? 0.5 : above / (above - below);
    const double at = std::clamp(left + part * width, left + inside, right - inside);
    impulses_ = impulses_before_;
    flow_.roll_back();
    if (!make_step(at, report)) return;
    const double here = margin_of_next(report);
    if (here >= 0) {
      left = at;
      above = std::isfinite(here) ? here - AxisEventTuning::kAim : -below;
      if (std::exchange(kept, 1) == 1) below *= 0.5;
    } else {
      right = at;
      if (here >= -1) break;
      below = here - AxisEventTuning::kAim;
      if (std::exchange(kept, -1) == -1) above *= 0.5;
    }
  }
  course_.event = right;
  if (++course_.events > AxisEventTuning::kMost) stall_ = Stall::kLaws;
}

/// What axes strike and what they do from here on; what is held newly is closed there.
bool ReducedCoordinates::settle(State& state, SubstepReport& report) {
  if (modes_.empty()) {
    tree_.hold({});
    return true;
  }
  strike(state);
  const std::vector<ClosedTree::Held> before(modes_.held().begin(), modes_.held().end());
  if (!choose_modes(state, report)) return false;
  return std::equal(before.begin(), before.end(), modes_.held().begin(), modes_.held().end()) ||
         close(state, report);
}

/// θ and θ̇ of axes, at which the tree is linearised.
void ReducedCoordinates::read_axes(const State& state) {
  system_.rows().residual(state, theta_);
  system_.rows().apply(tree_.jacobian(), state.twists, rates_);
}

/// Impacts at limits, by Newton's law, simultaneous; where that would gain energy, with one restitution for
/// all, with which it cannot: ½ Σ Λ (w⁺ + w⁻) = −½ (1 − e)/(1 + e) |ΔV|²_M.
void ReducedCoordinates::strike(State& state) {
  tree_.linearize(state);
  read_axes(state);
  if (!modes_.begin_impact(theta_, rates_, state.time - course_.start, course_.length)) return;
  tree_.hold(modes_.candidates());
  const BeyondRows& rows = tree_.begin_impact(state);
  const auto cuts = static_cast<std::size_t>(tree_.cut_rows());
  dense::Vector impulse, after, means;
  const auto solve = [&] {
    laws_.set(tree_.cut_rows(), modes_.laws());
    if (!solve_laws(rows, laws_.laws, laws_.segments, impulse, after)) stall_ = Stall::kLaws;
    means = 0.5 * (after + rows.b);
    for (std::size_t i = 0; i < modes_.candidates().size(); ++i)
      means[cuts + i] += modes_.candidates()[i].rate;
  };
  solve();
  double gained = 0;
  for (std::size_t i = cuts; i < laws_.laws.size(); ++i)
    if (laws_.laws[i].bounded()) gained += impulse[i] * means[i];
  if (gained > 0) {
    modes_.use_least_restitution();
    solve();
  }
  tree_.end_impact(impulse, state, impulses_);
  modes_.end_impact(impulse.data() + cuts, means.data() + cuts, flow_.reports());
}

void ReducedCoordinates::BeyondLaws::set(int cuts, std::span<const RowLaw> of_axes) {
  laws.assign(cuts, RowLaw::equality());
  laws.insert(laws.end(), of_axes.begin(), of_axes.end());
  segments.assign(laws.size(), 1);
}

/// Of what is on its step: held, or let go to the side that its acceleration goes.
bool ReducedCoordinates::choose_modes(State& state, SubstepReport& report) {
  const auto cuts = static_cast<std::size_t>(tree_.cut_rows());
  tree_.linearize(state);
  read_axes(state);
  modes_.begin_choice(theta_, rates_);
  for (bool again = true; again && stall_ == Stall::kNone;) {
    tree_.hold(modes_.candidates());
    find_acting(state, report);
    const BeyondRows& rows = tree_.begin_acceleration(state, axis_wrenches_, method_);
    dense::Vector lambda, rates;
    laws_.set(tree_.cut_rows(), modes_.laws());
    if (!solve_laws(rows, laws_.laws, laws_.segments, lambda, rates))
      stall_ = are_finite(forces_) ? Stall::kLaws : Stall::kNotFinite;
    again = modes_.choose(std::span(laws_.segments).subspan(cuts));
  }
  tree_.hold(modes_.held());
  return stall_ == Stall::kNone;
}

/// With the work of axes among that of all joints; what kinetic energy has changed by beside both is `flow`.
void ReducedCoordinates::close_works(StepWorks& works) {
  const double kinetic = kinetic_energy(world_, next_), of_axes = flow_.work();
  works.constraint += of_axes - std::exchange(course_.axis_work, of_axes);
  works.flow = kinetic - std::exchange(course_.kinetic, kinetic) - works.forces - works.constraint;
}

std::span<const Wrench> ReducedCoordinates::momenta() const {
  for (int b = 0; b < world_.body_count(); ++b)
    momenta_[b] = system_.mass().momentum(b, state_.poses[b], state_.twists[b]);
  return momenta_;
}

std::span<const double> ReducedCoordinates::present_forces() {
  SubstepReport report;
  accelerate(state_, report, acceleration_);
  return lambda_;
}

bool ReducedCoordinates::is_finite(const State& state) {
  not_finite_ = 0;
  for (int b = 0; b < world_.body_count(); ++b) {
    if (within_reach(state.poses[b], state.twists[b]) && state.poses[b].q.coeffs().allFinite()) continue;
    not_finite_ = b;
    return false;
  }
  return true;
}

std::string ReducedCoordinates::stall_reason() const {
  const std::string down = " with sub-steps down to dt/" + std::to_string(settings_.max_substeps);
  return (stall_ == Stall::kIteration ? "the implicit midpoint rule could not be solved"
          : stall_ == Stall::kLaws    ? "limits, friction and motors could not be met together"
          : stall_ == Stall::kTension ? "tension is too stiff: a shorter step, or larger masses, help;"
                                      : "positions could not be closed") +
         down;
}

/// V̇ and the forces of all rows at a state, at which the tree is linearised from now on.
void ReducedCoordinates::accelerate(const State& state, SubstepReport& report,
                                    std::span<Twist> accelerations) {
  {
    const Stopwatch watch(report.times.assembly);
    tree_.linearize(state);
  }
  find_forces(state, report, accelerations);
}

/// Forces, accelerations and λ where the tree is linearised already.
void ReducedCoordinates::find_forces(const State& state, SubstepReport& report,
                                     std::span<Twist> accelerations) {
  find_acting(state, report);
  const Stopwatch watch(report.times.velocities);
  if (flow_.empty()) return tree_.accelerate(state, forces_, method_, accelerations, lambda_);
  tree_.accelerate(state, axis_wrenches_, method_, accelerations, lambda_);
  modes_.give_forces(rates_, lambda_, tau_, flow_.forces());
}

/// What acts on bodies but for what holds: forces, and those of axes with them.
void ReducedCoordinates::find_acting(const State& state, SubstepReport& report) {
  {
    const Stopwatch watch(report.times.forces);
    world_.forces(state, forces_);
  }
  if (flow_.empty()) return;
  const Stopwatch watch(report.times.velocities);
  axis_wrenches_ = forces_;
  add_axis_forces(state);
}

void ReducedCoordinates::add_axis_forces(const State& state) {
  read_axes(state);
  flow_.find(state.time, theta_, rates_, tau_);
  modes_.add_forces(rates_, tau_);
  for (const Rows::AxisRow& axis : system_.rows().axis_rows()) {
    lambda_[axis.row] = tau_[axis.row];
    tree_.for_each_side(axis.row, [&](int body, const ClosedTree::Vector6& J) {
      axis_wrenches_[body].torque += tau_[axis.row] * J.head<3>();
      axis_wrenches_[body].force += tau_[axis.row] * J.tail<3>();
    });
  }
}

/// What acts at a stage, which stands for this time [s].
void ReducedCoordinates::accumulate_work(const State& stage, double time, SubstepReport& report) {
  for (std::size_t r = 0; r < lambda_.size(); ++r) impulses_[r] += time * lambda_[r];
  flow_.add(time);
  if (!settings_.report_energy) return;
  StepWorks& works = report.works;
  const auto work_of = [&](std::span<const Wrench> wrenches) {
    double power = 0;
    for (int b = 0; b < world_.body_count(); ++b)
      if (!system_.mass()[b].fixed) power += dot(wrenches[b], stage.twists[b]);
    return time * power;
  };
  works.forces += work_of(forces_);
  if (world_.has_dissipative_forces()) {
    std::fill(dissipative_.begin(), dissipative_.end(), Wrench{});
    world_.add_dissipative_forces(stage, dissipative_);
    works.dissipative += work_of(dissipative_);
  }
  if (!follows_time_) return;
  std::fill(driven_.begin(), driven_.end(), 0.0);
  system_.rows().add_rate(stage, driven_);
  double power = 0;
  for (std::size_t r = 0; r < driven_.size(); ++r) power -= lambda_[r] * driven_[r];
  works.drivers += time * power;
  works.constraint += time * power;
}

/// Joints closed from the roots to the leaves, and velocities that they allow.
bool ReducedCoordinates::close(State& state, SubstepReport& report) {
  const Stopwatch watch(report.times.positions);
  const int least = is_midpoint(settings_.integrator) ? MidpointTuning::kClosings : 1;
  if (!tree_.close_positions(state, settings_.position_tolerance, least, report.newton_iterations)) {
    stall_ = is_finite(state) ? Stall::kJoints : Stall::kNotFinite;
    return false;
  }
  tree_.linearize(state);
  tree_.close_velocities(state);
  return true;
}

/// Where rows beyond the tree depend on each other, so do their stages by no more than round-off only if they
/// are closed.
bool ReducedCoordinates::runge_kutta(double h, SubstepReport& report) {
  bool closed = true;
  runge_kutta_.advance(
      system_.mass(), next_, h,
      [&](const State& stage, double weight, std::span<Twist> accelerations) {
        accelerate(stage, report, accelerations);
        accumulate_work(stage, weight * h, report);
      },
      [&](State& stage) {
        if (tree_.may_be_redundant()) closed = closed && close(stage, report);
      });
  next_.time += h;
  return closed && close(next_, report);
}

/// An explicit Euler step of h, closed: Ψ_h.
bool ReducedCoordinates::shift(const State& from, std::span<const Twist> accelerations, double h, State& to,
                               SubstepReport& report) {
  to = from;
  move_poses(system_.mass(), from.poses, from.twists, h, to.poses);
  add_twists(from.twists, h, accelerations, to.twists);
  to.time = from.time + h;
  return close(to, report);
}

/// Ψ_{h/2} of the state in the middle, of which Ψ_{−h/2} is the start: symmetric, whatever Ψ is.
bool ReducedCoordinates::midpoint(double h, SubstepReport& report) {
  if (!solve_midpoint(h, report)) return false;
  accumulate_work(middle_, h, report);
  const bool closed = shift(middle_, acceleration_, 0.5 * h, next_, report);
  next_.time = state_.time + h;
  return closed;
}

/// By adding to the middle what its Ψ_{−h/2} lacks of the start.
bool ReducedCoordinates::solve_midpoint(double h, SubstepReport& report) {
  std::fill(acceleration_.begin(), acceleration_.end(), Twist{});
  if (!shift(state_, acceleration_, 0.5 * h, middle_, report)) return false;
  double best = INFINITY;
  for (int pass = 0, in_vain = 0; pass < MidpointTuning::kMostPasses; ++pass) {
    find_forces(middle_, report, acceleration_);
    if (!shift(middle_, acceleration_, -0.5 * h, back_, report)) return false;
    const double error = midpoint_error(h);
    if (error <= MidpointTuning::kTolerance) return true;
    if (!std::isfinite(error)) {
      (void)is_finite(back_);
      stall_ = Stall::kNotFinite;
      return false;
    }
    in_vain = error > MidpointTuning::kGain * best ? in_vain + 1 : 0;
    best = std::min(best, error);
    if (in_vain == MidpointTuning::kPatience) {
      if (error <= MidpointTuning::kRoundOff) return true;
      break;
    }
    move_poses(system_.mass(), middle_.poses, moves_, 1, middle_.poses);
    add_twists(middle_.twists, 1, changes_, middle_.twists);
    if (!close(middle_, report)) return false;
  }
  stall_ = Stall::kIteration;
  return false;
}

/// What the way back from the middle lacks of the start, and how much that is, relative.
double ReducedCoordinates::midpoint_error(double h) {
  Sizes error, step, place;
  for (int b = 0; b < world_.body_count(); ++b) {
    if (system_.mass()[b].fixed) continue;
    moves_[b] = {log_so3(state_.poses[b].q * back_.poses[b].q.conjugate()),
                 state_.poses[b].p - back_.poses[b].p};
    changes_[b] = {state_.twists[b].w - back_.twists[b].w, state_.twists[b].v - back_.twists[b].v};
    error.add(moves_[b].w, moves_[b].v);
    error.add(h * changes_[b].w, h * changes_[b].v);
    step.add(h * state_.twists[b].w, h * state_.twists[b].v);
    step.add(h * h * acceleration_[b].w, h * h * acceleration_[b].v);
    place.add(Vec3::Zero(), state_.poses[b].p);
  }
  const double turn = error.turn / (step.turn + MidpointTuning::kLeast);
  const double size = step.shift + MidpointTuning::kLeast * place.shift;
  const double shift = error.shift == 0 ? 0 : error.shift / size;
  return turn + shift;  // NaN of either stays
}

}  // namespace taut
