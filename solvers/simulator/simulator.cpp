#include "solvers/simulator/simulator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "core/base/check.h"
#include "core/base/flush_to_zero.h"
#include "core/base/interruption.h"
#include "core/state/same_state.h"
#include "core/world/diagnostics.h"
#include "solvers/common/motion_sums.h"
#include "solvers/common/setting_checks.h"
#include "solvers/common/stopwatch.h"
#include "solvers/diagnosis/contradiction.h"
#include "solvers/diagnosis/rank_report.h"
#include "solvers/integrators/close_joints.h"
#include "solvers/integrators/moreau_jean.h"
#include "solvers/integrators/rattle.h"
#include "solvers/linear/cholmod_factor.h"
#include "solvers/simulator/simulator_impl.h"

namespace taut {
namespace {

/// Steps in a row that ask for fewer sub-steps before there are fewer.
constexpr int kQuietSteps = 300;
/// Laws may be met inexactly in sub-steps below this part of the step, and in so many steps after such a one
/// in any.
constexpr double kHardPart = 0.6;
constexpr int kHardSteps = 10;

Gap wider(const Gap& a, const Gap& b) {
  // Written so that a NaN in either stays.
  const auto worse = [](double x, double y) { return x >= y || std::isnan(x) ? x : y; };
  return {worse(a.metres, b.metres), worse(a.radians, b.radians)};
}

}  // namespace

/// New topology: new pattern, order and symbolic factor.  New state: new start.  What contacts and friction
/// know of the steps before is kept, but where bodies were moved.
void Simulator::Impl::refresh() {
  std::unique_ptr<ConstraintSystem> old_system;  // outlives the integrator that refers to it
  std::unique_ptr<ImpulseScheme> old_scheme;
  const bool is_new = !knows_pattern();
  // What it knows after a step that failed may be anything.
  const bool knows = scheme_ && has_started() && (state_version_ >= 0 || retaken_);
  if (is_new) {
    require_none(setting_conflicts(settings_, world_));
    // What held before holds on, but where bodies were moved.
    if (knows) {
      scheme_->forget(moved_bodies());
      old_system = std::move(system_);
      old_scheme = std::move(scheme_);
    }
    make_system();
    pace_.hard_steps = 0;
    report_.times.analysis = system_->analysis_time();
  }
  if (state_version_ == world_.state_version() && recalled_.empty()) return;
  const bool goes_on = knows && !is_new;
  if (goes_on && !retaken_ && recalled_.empty() && same(world_.state(), scheme_->state()) &&
      scheme_->renew_forces()) {
    state_version_ = world_.state_version();
    return;
  }
  if (force_level_) {
    force_level_->start(world_.state(), report_);
    recalled_.clear();
  } else {
    phi_.resize(system_->row_count());  // a step that failed may have found contacts
    system_->rows().residual(world_.state(), phi_);
    const Gap gap = max_gap(system_->rows(), phi_);
    if (!std::isfinite(gap.metres + gap.radians)) {
      set_failure(Status::kNotFinite,
                  "a joint's gap is not finite at the start" + widest_gap(world_.state(), phi_, 0));
      return;
    }
    if (std::max(gap.metres, gap.radians) > settings_.position_tolerance) {
      State state = world_.state();
      if (!close_joints(*system_, state, settings_.position_tolerance, report_)) {
        report_.contradiction = find_contradiction({.world = world_, .from = state, .bounds = false});
        set_failure(report_.contradiction.empty() ? Status::kNotConverged : Status::kContradiction,
                    "the joints cannot be closed at the start" + widest_gap(state));
        return;
      }
      move_world(state);
    }
    scheme_->contact_rows().set_horizon(horizon_);
    recall_contacts();
    if (goes_on) {
      scheme_->forget(moved_bodies());
      scheme_->restart(world_.state(), report_);
    } else {
      if (old_scheme) scheme_->contact_rows().inherit(old_scheme->contact_rows());
      scheme_->start(world_.state(), report_);
      if (old_scheme) scheme_->inherit(*old_scheme);
    }
    if (scheme_->contact_rows().blind()) return fail_blind();
    retaken_ = false;
    restarted_ = true;
  }
  state_version_ = world_.state_version();
}

/// Pattern, order and integrator of the present topology, which know no state yet.
void Simulator::Impl::make_system() {
  auto system = std::make_unique<ConstraintSystem>(world_, settings_.factor, kSteppingTolerance,
                                                   Rows::AxisRows::kIncluded, springs_);
  composition_.reset();
  scheme_.reset();
  force_level_.reset();
  system_ = std::move(system);
  if (is_force_level(settings_.integrator))
    force_level_ = std::make_unique<ForceLevel>(world_, *system_, settings_);
  else if (settings_.integrator == Integrator::kMoreauJean)
    scheme_ = std::make_unique<MoreauJean>(world_, *system_, settings_);
  else
    scheme_ = std::make_unique<Rattle>(world_, *system_, settings_);
  if (scheme_) {
    scheme_->stages().name_by(source_);
    composition_.emplace(settings_.integrator, *scheme_);
  }
  phi_.assign(system_->row_count(), 0.0);
  rates_.assign(system_->row_count(), 0.0);
  reaction_multipliers_.assign(system_->row_count(), 0.0);
  topology_version_ = world_.topology_version();
  geometry_version_ = world_.geometry_version();
  sleep_version_ = world_.sleep_version();
  state_version_ = reaction_version_ = wrench_jacobian_version_ = -1;
  weld_loads_.reset();
  present_reactions_.clear();
  if (merged_ && !merged_->groups().empty()) weld_loads_ = std::make_unique<WeldLoads>(source_, *merged_);
}

/// A new state of the world, of which take_back() knows the one before.
void Simulator::Impl::move_world(const State& state) {
  if (has_moved_) return world_.set_state(state);
  undo_ = state;
  world_.exchange_state(undo_);
  has_moved_ = true;
}

/// The world as it was before the present step or question, and a new start: what the integrator knows may be
/// anything.
void Simulator::Impl::take_back(const Pace& pace, std::vector<ContactStretch> stretches) {
  for (JointId joint : broken_) {
    world_.attach(joint);
    if (merged_) source_.attach(joint);
  }
  if (has_moved_) world_.set_state(undo_);
  has_moved_ = false;
  restore_awake();
  pace_ = pace;
  recalled_ = std::move(stretches);
  state_version_ = topology_version_ = -1;
  retaken_ = false;
  start_.poses.clear();
  given_version_ = world_.state_version();
}

/// Whatever work throws, force laws or what asks whether to go on, leaves the world as it was.
template <typename Work>
void Simulator::Impl::undoable(Work work) {
  const Pace pace = pace_;
  const bool any = interrupt_ || !recalled_.empty();
  std::vector<ContactStretch> stretches = any ? contact_stretches() : std::vector<ContactStretch>();
  has_moved_ = false;
  broken_.clear();
  try {
    work();
  } catch (...) {
    take_back(pace, std::move(stretches));
    throw;
  }
}

/// The same for work that makes a report: that is the one of before again, too, or says that the user has
/// asked to end early.
template <typename Work>
void Simulator::Impl::reported(Work work) {
  try {
    undoable([&] {
      const Stopwatch watch(report_.times.total);
      const detail::InterruptScope scope(&interrupt_);
      work();
    });
  } catch (const detail::Interrupted&) {
    report_.contradiction = {};
    report_.culprits.clear();
    report_.breaks.clear();
    set_failure(Status::kInterrupted, "interrupted");
  } catch (...) {
    std::swap(report_, last_report_);
    throw;
  }
}

/// For questions between steps.
void Simulator::Impl::restart_if_needed() {
  undoable([this] { refresh(); });
}

/// An empty report, which keeps its memory; the last one is put aside.
void Simulator::Impl::begin_report() {
  std::swap(report_, last_report_);
  std::vector<DependentRow> kept = std::move(report_.dependent_rows);
  report_ = {};
  kept.clear();
  report_.dependent_rows = std::move(kept);
}

void Simulator::Impl::step(double dt) {
  require_positive("step dt", dt);
  sync_from_world();
  if (sleep_)
    collect_sleep_candidates(dt);
  else if (source_.asleep_count() > 0)  // for a simulator that is no more
    source_.wake_all(), world_.wake_all();
  begin_report();
  report_.dt = dt;
  horizon_ = dt;
  reported([&] {
    mean_reactions_.clear(), start_.poses.clear();
    if (settings_.report_energy) books_.begin(world_, moved_ ? source_ : world_, report_);
    if (sleep_) sleep_->put_to_sleep(world_, sleep_candidates_);
    while (!advance_to_end(dt))
      ;
    moved_ = false;
    if (report_.advanced()) publish_to_world();
  });
  if (!report_.advanced()) {
    if (has_moved_) world_.set_state(undo_);  // joints that were closed before the step
    restore_awake();
    given_version_ = world_.state_version();  // the user's world stays as it was
  }
  end_versions_ = versions();
  note_detection();
  report_.asleep = source_.asleep_count();
  count_work();
}

bool Simulator::Impl::knows_pattern() const {
  return topology_version_ == world_.topology_version() && geometry_version_ == world_.geometry_version() &&
         sleep_version_ == world_.sleep_version();
}

/// False if bodies woke that the step has touched, or that it could not be done without: it must be taken
/// again.
bool Simulator::Impl::advance_to_end(double dt) {
  const bool goes_on = state_version_ == world_.state_version() && knows_pattern();
  refresh();
  if (!report_.ok()) return true;
  if (settings_.report_energy && scheme_ && (!goes_on || restarted_)) books_.start(world_, scheme_->state());
  restarted_ = false;  // else a question before the step has had it started
  if (weld_loads_) merged_->expand(force_level_ ? force_level_->state() : scheme_->state(), start_);
  bool done = true;
  state_version_ = -1;  // until the end
  if (force_level_) {
    const World::Hold held = source_.hold();
    done = force_level_->advance(dt, report_) == Scheme::Outcome::kDone;
  } else {
    scheme_->contact_rows().set_horizon(dt);
    scheme_->clear_impulses();
    const World::Hold held = source_.hold();
    done = integrate(dt);
  }
  if (force_level_ && !done) fail_not_finite();
  if (sleep_ && scheme_ && wakes(done)) {
    retaken_ = done;
    forget_step();
    set_works(report_, {});
    report_.status = Status::kSuccess;
    report_.message.clear();
    report_.contradiction = {};
    report_.crowd = {};
    report_.culprits.clear();
    return false;
  }
  if (done && welds_hold())
    finish(dt);
  else
    forget_step(), start_.poses.clear();
  return true;
}

/// The world still has the state from before, and all its joints: start from there again.
void Simulator::Impl::forget_step() {
  state_version_ = -1;
  if (scheme_ && scheme_->breaking().any()) topology_version_ = -1;
}

/// Sub-steps that a step needs now.  A symplectic scheme keeps its energy only while its step stays the same,
/// so the count goes up at once and comes down only after a long quiet time.
double Simulator::Impl::choose_substeps(double dt) {
  const double needed =
      std::clamp(std::ceil(dt / composition_->step_limit() - 1e-9), 1.0, double(settings_.max_substeps));
  if (needed >= pace_.substeps) {
    pace_.substeps = needed;
    pace_.quiet = 0;
  } else {
    pace_.most_substeps = pace_.quiet == 0 ? needed : std::max(pace_.most_substeps, needed);
    if (++pace_.quiet >= kQuietSteps) {
      pace_.substeps = pace_.most_substeps;
      pace_.quiet = 0;
    }
  }
  return pace_.substeps;
}

/// Covers dt in as many equal sub-steps as tension, rotation and convergence ask for.
bool Simulator::Impl::integrate(double dt) {
  Substeps substeps(dt, choose_substeps(dt), settings_.max_substeps);
  const bool hard = pace_.hard_steps > 0;
  scheme_->stages().accept_inexact(hard ? settings_.inexact_tolerance : 0, hard);
  bool forgot = false;
  while (!substeps.done()) {
    detail::poll_interrupt();
    const double h = substeps.next(composition_->step_limit());
    const Scheme::Outcome outcome = composition_->advance(h, report_);
    switch (outcome) {
      case Scheme::Outcome::kDone:
        substeps.accept();
        break;
      case Scheme::Outcome::kImpact:
      case Scheme::Outcome::kOverload:
        substeps.end_next_at(scheme_->time_to_event());
        break;
      case Scheme::Outcome::kUnstable:
        substeps.shorten(composition_->step_limit());
        break;
      case Scheme::Outcome::kStalled:
        forgot = after_stall(substeps, hard, forgot);
        break;
      case Scheme::Outcome::kNotFinite:
        fail_not_finite();
        return false;
      case Scheme::Outcome::kBlind:
        fail_blind();
        return false;
    }
    if (substeps.exhausted()) {
      diagnose_stall(substeps.remaining(), outcome == Scheme::Outcome::kUnstable);
      return false;
    }
  }
  pace_.hard_steps = report_.status == Status::kInexact ? kHardSteps : std::max(pace_.hard_steps - 1, 0);
  return true;
}

/// Laws that could not be met: once more without impulses of contacts as a guess, then in shorter sub-steps,
/// and inexactly.  Joints: in shorter ones.  Returns whether that guess has been tried.
bool Simulator::Impl::after_stall(Substeps& substeps, bool hard, bool forgot) {
  const bool laws = !scheme_->stages().active_set_outcome().ok() && !scheme_->contacts().empty();
  if (laws) scheme_->contact_rows().forget_impulses();
  if (!laws || forgot) substeps.shorten();
  if (laws && (hard || substeps.below(kHardPart)))
    scheme_->stages().accept_inexact(settings_.inexact_tolerance, false);
  return laws || forgot;
}

/// Of joints, and of axes beyond rigid limits.
Gap Simulator::Impl::gap_of(std::span<const double> phi) const {
  const Gap joints = max_gap(system_->rows(), phi);
  return scheme_ ? wider(joints, scheme_->axes().beyond_limits(phi)) : joints;
}

/// False, and said so, if the members of merged bodies cannot be placed to the tolerance.
bool Simulator::Impl::welds_hold() {
  if (!weld_loads_) return true;
  merged_->expand(force_level_ ? force_level_->state() : scheme_->state(), given_);
  const MergedWorld::OpenWeld widest = merged_->widest_weld(source_, given_);
  if (std::max(widest.gap.metres, widest.gap.radians) <= settings_.position_tolerance) return true;
  std::ostringstream text;
  const bool angular = widest.gap.radians > widest.gap.metres;
  report_.culprits = {{.kind = Culprit::Kind::kJoint,
                       .axis = {widest.joint},
                       .share = std::max(widest.gap.metres, widest.gap.radians)}};
  text << source_.joint(widest.joint).type() << " " << source_.name(widest.joint)
       << ", which is merged away, is open by " << (angular ? widest.gap.radians : widest.gap.metres)
       << (angular ? " rad" : " m")
       << ", the round-off of its bodies' coordinates: move the scene nearer to the origin";
  set_failure(Status::kNotConverged, text.str());
  return false;
}

/// The proof of quality, from the state that the user gets.
void Simulator::Impl::finish(double dt) {
  const State& state = force_level_ ? force_level_->state() : scheme_->state();
  const double time = world_.time() + dt;
  move_world(state);
  world_.set_time(time);
  if (scheme_) scheme_->set_time(time);
  if (scheme_) detach_broken();
  state_version_ = world_.state_version();
  report_.time = time;
  if (report_.status == Status::kInexact) report_.message += list_culprits();
  for (auto* values : {&phi_, &rates_, &reaction_multipliers_}) values->resize(system_->row_count());
  if (scheme_ && scheme_->values().residual_is_current) {
    report_.gap = max_gap(system_->rows(), scheme_->values().phi);
  } else {
    system_->rows().residual(state, phi_);
    if (scheme_) scheme_->breaking().clear_rows(phi_);
    report_.gap = gap_of(phi_);
  }
  if (weld_loads_) report_.gap = wider(report_.gap, merged_->widest_weld(source_, given_).gap);
  if (force_level_) {
    system_->linearize(state);
    system_->rows().apply(system_->jacobian(), state.twists, rates_);
    system_->rows().add_rate(state, rates_);
    for (double rate : rates_)
      report_.velocity_residual = std::max(report_.velocity_residual, std::abs(rate));
  }
  if (scheme_) {
    for (const ContactSet::Place& place : scheme_->contacts().set().places()) {
      if (!place.active) continue;
      ++report_.contacts;
      report_.penetration = std::max(report_.penetration, -place.contact.gap);
    }
  }
  report_.rank_deficiency = system_->rank_deficiency();
  name_dependent_rows();
  report_.natural_residual = std::max(report_.natural_residual, report_.complementarity_residual);
  report_.condition_estimate = system_->condition_estimate();
  if (settings_.report_energy) {
    report_.constraint_work -= report_.axis_work.total() + report_.contact_work.total();
    sum_motion(state, force_level_ ? force_level_->momenta() : scheme_->momenta(), report_);
    const World::Hold held = source_.hold();
    books_.close(world_, report_, scheme_ != nullptr);
  }
  if (sleep_) sleep_->watch(world_, dt);
}

void Simulator::Impl::name_dependent_rows() {
  const Rows& rows = system_->rows();
  if (!system_->dependent_rows().empty()) report_.dependent_rows.reserve(rows.row_count());  // once
  for (int row : system_->dependent_rows()) {
    if (const std::optional<JointId> joint = rows.joint_of(row))
      report_.dependent_rows.push_back({*joint, row - rows.joints()[rows.row(row).block].first_row});
  }
  std::sort(report_.dependent_rows.begin(), report_.dependent_rows.end());
}

/// What broke in the step is out of the world from now on.
void Simulator::Impl::detach_broken() {
  const std::span<const BreakEvent> events = scheme_->breaking().events();
  if (events.empty()) return;
  report_.breaks.assign(events.begin(), events.end());
  for (const BreakEvent& event : events) {
    broken_.push_back(event.joint);
    world_.detach(event.joint);
    if (merged_) source_.detach(event.joint);
  }
}

void Simulator::Impl::count_work() {
  report_.analyses = system_->counters().analyses;
  report_.factorizations = system_->counters().factorizations;
  report_.backsolves = system_->counters().backsolves;
  system_->reset_counters();
}

void Simulator::Impl::assemble() {
  flush_mean_reactions();
  sync_from_world();
  source_.wake_all(), world_.wake_all();
  begin_report();
  reported([this] {
    close_all_joints();
    publish_to_world();
  });
  count_work();
}

void Simulator::Impl::close_all_joints() {
  if (!knows_pattern()) refresh();
  State state = world_.state();
  phi_.resize(system_->row_count());
  if (close_joints(*system_, state, settings_.position_tolerance, report_)) {
    move_world(state);
    refresh();
    if (scheme_) move_world(scheme_->state());
    state_version_ = world_.state_version();
    report_.time = world_.time();
    system_->rows().residual(world_.state(), phi_);
    report_.gap = gap_of(phi_);
  } else if (system_->rows().residual(state, phi_);
             !std::isfinite(max_gap(system_->rows(), phi_).metres + max_gap(system_->rows(), phi_).radians)) {
    set_failure(Status::kNotFinite, "a joint's gap is not finite" + widest_gap(state, phi_, 0));
  } else if (report_.ok()) {
    report_.contradiction = find_contradiction({.world = world_, .from = state, .bounds = false});
    set_failure(report_.contradiction.empty() ? Status::kNotConverged : Status::kContradiction,
                "the joints cannot be closed" + widest_gap(state));
  }
}

Simulator::Simulator(World& world, const Settings& settings)
    : impl_(std::make_unique<Impl>(world, settings)) {}
Simulator::~Simulator() = default;

/// A world that was assigned to since is another one, of which nothing is known.
Simulator::Impl& Simulator::impl() const {
  if (impl_->identity_ == impl_->source_.identity()) return *impl_;
  auto fresh = std::make_unique<Impl>(impl_->source_, impl_->settings_);
  fresh->interrupt_ = impl_->interrupt_;
  impl_ = std::move(fresh);
  return *impl_;
}

Simulator::Simulator(Simulator&&) noexcept = default;

const StepReport& Simulator::step(double dt) {
  const detail::FlushToZero mode;
  impl().step(dt);
  if (impl().settings_.report_rank && impl().report_.advanced()) try {
      const detail::InterruptScope scope(&impl().interrupt_);
      impl().report_.rank = analyze_rank();
    } catch (const detail::Interrupted&) {  // the step is done
    }
  return impl().report_;
}
const StepReport& Simulator::report() const { return impl_->report_; }

void Simulator::set_interrupt(std::function<bool()> asked) { impl().interrupt_ = std::move(asked); }

Reaction Simulator::mean_reaction(JointId joint) const {
  (void)impl().source_.joint(joint);  // throws for an id that is not there
  return impl().mean_reaction(joint);
}

Reaction Simulator::reaction(JointId joint) {
  (void)impl().source_.joint(joint);
  if (impl().rests(joint)) return impl().mean_reaction(joint);
  impl().compute_reactions();
  if (impl().merges(joint)) {
    impl().solve_present_welds();
    return impl().present_reactions_[joint.index];
  }
  return impl().reaction_from(joint, impl().reaction_multipliers_, 1);
}

AxisReport Simulator::axis_report(AxisId axis) const {
  (void)impl().source_.axis_index(axis);  // throws for an id that is not there
  return impl().axis_report(axis);
}

std::vector<ContactReport> Simulator::contacts() const { return impl().contacts(); }

std::vector<ContactStretch> Simulator::contact_stretches() const { return impl().contact_stretches(); }

void Simulator::set_contact_stretches(std::vector<ContactStretch> stretches) {
  impl().set_contact_stretches(std::move(stretches));
}

RankReport Simulator::analyze_rank() {
  if (impl().source_.asleep_count() == 0) return taut::analyze_rank(impl().source_, impl().settings_);
  World awake = impl().source_;
  awake.wake_all();
  return taut::analyze_rank(awake, impl().settings_);
}

Contradiction Simulator::contradiction(double horizon) {
  require_not_negative("contradiction horizon", horizon);
  return impl().contradiction(horizon);
}

const StepReport& Simulator::assemble() {
  impl().assemble();
  return impl().report_;
}

std::vector<JointId> Simulator::merged_joints() const {
  std::vector<JointId> joints;
  if (!impl().merged_) return joints;
  // Those that the next step will have, which is not taken in advance.
  for (const MergedGroup& group : merged_groups(impl().source_, impl().settings_.position_tolerance))
    for (const auto* welds : {&group.welds, &group.loops})
      for (JointId weld : *welds)
        if (weld.index >= 0) joints.push_back(weld);
  std::sort(joints.begin(), joints.end());
  return joints;
}

const World& Simulator::world() const { return impl_->source_; }
const Settings& Simulator::settings() const { return impl_->settings_; }

std::string Simulator::solver_description() const {
  if (!impl().system_) {
    impl().sync_from_world();
    if (impl().sleep_) impl().wake_islands(0);
    impl().restart_if_needed();
  }
  if (impl().settings_.solver != Solver::kDirect)
    return "iterative impulses, " + std::to_string(impl().settings_.iterations) + " sweeps a stage";
  return impl().system_->factor().name() + ", " + blas_name() +
         (CholmodFactor::has_supernodal() ? "" : ", CHOLMOD without its GPL modules");
}

}  // namespace taut
