#include "solvers/simulator/simulator.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/base/check.h"
#include "core/base/flush_to_zero.h"
#include "core/base/interruption.h"
#include "solvers/common/motion_sums.h"
#include "solvers/common/setting_checks.h"
#include "solvers/common/stopwatch.h"
#include "solvers/complementarity/contact_stage.h"
#include "solvers/diagnosis/contradiction.h"
#include "solvers/diagnosis/rank_report.h"
#include "solvers/integrators/close_joints.h"
#include "solvers/simulator/detection_report.h"
#include "solvers/simulator/failure_advice.h"
#include "solvers/simulator/not_finite.h"
#include "solvers/simulator/simulator_impl.h"
#include "solvers/simulator/stall_diagnosis.h"

namespace taut {
namespace {

/// The step cannot be done.
void say_why(const Substepping& substeps, const Inquiry& asked) {
  using enum Scheme::Outcome;
  const World::Hold held = asked.source.hold();
  if (substeps.outcome() == kNotFinite)
    end_not_finite(asked);
  else if (substeps.outcome() == kBlind)
    end_blind(asked);
  else if (const std::string reason = asked.stepper.scheme().stall_reason(); !reason.empty())
    asked.end_step(Status::kNotConverged, reason);
  else
    StallDiagnosis(asked).end_step(substeps.remaining(), substeps.outcome() == kUnstable);
}

/// The report is that of a step which has not begun, but for what it has cost.
void forget_attempt(StepReport& report) {
  SubstepReport cost;
  add_cost(cost, report);
  static_cast<SubstepReport&>(report) = cost;
  report.contradiction = {};
  report.crowd = {};
}

bool is_finite_gap(const Gap& gap) { return std::isfinite(gap.metres + gap.radians); }

/// Says why joints stay open at this state, the nearest to one that closes them that was found, with φ there.
void end_open(const Inquiry& asked, const State& state, std::span<const double> phi,
              const std::string& when) {
  if (!is_finite_gap(max_gap(asked.stepper.system().rows(), phi)))
    return asked.end_step(Status::kNotFinite,
                          "a joint's gap is not finite" + when + widest_gap(asked, state, phi, 0));
  Contradiction& found = asked.report.contradiction;
  found = find_contradiction({.world = asked.world, .from = state, .bounds = false});
  asked.end_step(found.empty() ? Status::kNotConverged : Status::kContradiction,
                 "the joints cannot be closed" + when + widest_gap(asked, state, phi, 0));
}

/// Some force law has to be asked anew at the start of a step.
bool may_change(const World& world) {
  for (int f = 0; f < world.force_count(); ++f)
    if (world.force({f}).may_change()) return true;
  return false;
}

/// With all bodies awake.
RankReport rank_of(const World& world, const Settings& settings) {
  if (world.asleep_count() == 0) return analyze_rank(world, settings);
  World awake = world;
  awake.wake_all();
  return analyze_rank(awake, settings);
}

}  // namespace

Simulator::Impl::Impl(World& world, const Settings& settings)
    : bodies_(world, settings), settings_(settings), stepper_(world_, source_, settings_) {
  check_settings(settings);
  if (is_reduced(settings.integrator) && !settings.merge_fixed_joints)
    require_none(setting_conflicts(settings, world_));
  bodies_.wake_all();  // who sleeps is known to the simulator that let them
  if (settings_.drift_cure != DriftCure::kAuto) return;
  settings_.drift_cure =
      settings.integrator == Integrator::kMoreauJean ? DriftCure::kPositionPush : DriftCure::kBaumgarte;
}

const StepReport& Simulator::step(double dt) {
  require_positive("step dt", dt);
  Impl& now = impl();
  if (now.events_.is_pending() && !now.goal_) return step_with_events(dt);  // parts of it come here
  const detail::FlushToZero mode;
  const ActingLoads loads(now.source_, now.events_.loads());
  Impl::Before before = now.begin_step(dt);
  try {
    const Impl::Watches watches(now);
    now.fall_asleep();
    while (now.start_advancing()) {
      {
        const World::Hold held = now.source_.hold();
        Scheme& scheme = now.stepper_.scheme();
        for (now.substepping_.begin(scheme, dt); now.substepping_.goes_on();) {
          const double h = now.substepping_.next(scheme);
          SubstepReport report;
          const Scheme::Outcome outcome = scheme.advance(h, report);
          now.substepping_.react(outcome, report, scheme, now.report_);
        }
      }
      if (now.finish_advancing(dt)) break;  // else once more, with bodies awake that it has touched
    }
    now.bodies_.end_step(now.report_.ok());
  } catch (...) {
    now.give_up(std::move(before));
  }
  now.end_step();
  return now.report_;
}

/// Follows the World and chooses bodies that may fall asleep; an empty report.
Simulator::Impl::Before Simulator::Impl::begin_step(double dt) {
  whole_.reset();
  bodies_.follow();
  choose_sleepers(dt);
  Before before = begin_undoable();
  begin_report();
  report_.dt = horizon_ = dt;
  return before;
}

/// Islands at rest; the ledger has the energies from before.
void Simulator::Impl::fall_asleep() {
  welds_.forget_means();
  if (settings_.report_energy) accounting_.begin(world_, bodies_.as_set(), report_);
  sleep_.put_to_sleep(world_);
}

/// What is the same however the step has ended.
void Simulator::Impl::end_step() {
  report_.ok() ? PassingLoads::set_next(source_, {}) : stay_where_it_was();
  end_versions_ = versions();
  if (stepper_.made()) report_detection(stepper_, report_);
  report_.asleep = source_.asleep_count();
  count_work();
  if (!settings_.report_rank || !report_.ok()) return;
  try {
    const detail::InterruptScope scope(&hooks_.interrupt);
    report_.rank = rank_of(source_, settings_);
  } catch (const detail::Interrupted&) {  // the step is done
  }
}

/// Before a step of dt, with all that the last one has left: islands wake, and bodies that may fall asleep
/// are chosen, what they bear noted.
void Simulator::Impl::choose_sleepers(double dt) {
  if (!sleep_.enabled()) {  // asleep for a simulator that is no more
    if (source_.asleep_count() > 0) bodies_.wake_all();
    return;
  }
  wake_islands(dt);
  sleep_.forget_candidates();
  if (!stepper_.knows_topology() || !report_.ok() || report_.dt == 0) return;
  sleep_.choose_candidates(world_, stepper_.system().rows(), stepper_.slots());
  if (!sleep_.candidates().empty()) note_loads_of_sleepers();
}

/// What the user has moved since the last step is not at rest, nor is anything if it was a fixed body.
void Simulator::Impl::wake_islands(double h) {
  if (!sleep_.enabled()) return;
  if (stepper_.has_state() && !stepper_.knows_state())
    for (int b = 0; b < stepper_.system().rows().body_count(); ++b)
      if (stepper_.is_moved(b)) world_.is_fixed({b}) ? world_.wake_all() : world_.wake({b});
  sleep_.wake(world_, stepper_.slots(), h);
}

/// Reactions, axes and contacts of bodies that are about to fall asleep stay as they were in the last step.
void Simulator::Impl::note_loads_of_sleepers() {
  std::vector<char> falls(world_.body_count(), false);
  for (BodyId body : sleep_.candidates()) falls[body.index] = true;
  const auto falls_asleep = [&](BodyId body) { return falls[bodies_.carrier(body).index]; };
  for (int j = 0; j < source_.joint_count(); ++j) {
    const JointId joint{j};
    const std::span<const BodyId> bodies = source_.joint(joint).bodies();
    if (!source_.is_attached(joint) || std::none_of(bodies.begin(), bodies.end(), falls_asleep)) continue;
    sleeping_.note(joint, mean_reaction(joint));
    for (int k = 0; k < source_.axis_count(joint); ++k) sleeping_.note({joint, k}, axis_report({joint, k}));
  }
  sleeping_.forget_woken();
  for (const ContactReport& c : contacts())
    if (falls_asleep(c.contact.A) || falls_asleep(c.contact.B)) sleeping_.note(c);
}

/// The integrator at the state of the world, and true if it can be there; what it is until the end of the
/// step is not known.
bool Simulator::Impl::start_advancing() {
  const bool goes_on = stepper_.knows_state() && stepper_.knows_pattern();
  refresh();
  if (!report_.ok()) return false;
  if (settings_.report_energy && stepper_.scheme().knows_works() && (!goes_on || restarted_))
    accounting_.start(world_, stepper_.state());
  restarted_ = false;  // true if reactions were asked for before the step
  welds_.start_step(stepper_.state());
  stepper_.forget_state();
  return true;
}

/// False if bodies woke that the step has touched, or that it could not be done without: it must be taken
/// again.
bool Simulator::Impl::finish_advancing(double dt) {
  const bool done = substepping_.outcome() == Scheme::Outcome::kDone;
  report_.ledger.integration = report_.works.flow;
  if (!done) say_why(substepping_, inquiry());
  if (sleep_.enabled() && sleep_.wake_after(world_, stepper_.scheme().contacts().reports(), done)) {
    stepper_.retake(done);
    forget_attempt(report_);
    return false;
  }
  if (done && welds_hold())
    finish(dt);
  else
    stepper_.forget_step(), welds_.forget_step();
  return true;
}

/// False, and said so, if the members of merged bodies cannot be placed to the tolerance.
bool Simulator::Impl::welds_hold() {
  if (!welds_.any()) return true;
  const auto [joint, gap] = bodies_.place_members(stepper_.state());
  const double widest = std::max(gap.metres, gap.radians);
  if (widest <= settings_.position_tolerance) return true;
  report_.culprits = {{.kind = Culprit::Kind::kJoint, .axis = {joint}, .share = widest}};
  std::ostringstream text;
  const bool angular = gap.radians > gap.metres;
  text << source_.joint(joint).type() << " " << source_.name(joint) << ", which is merged away, is open by "
       << (angular ? gap.radians : gap.metres) << (angular ? " rad" : " m")
       << ", the round-off of its bodies' coordinates: move the scene nearer to the origin";
  inquiry().end_step(Status::kNotConverged, text.str());
  return false;
}

/// The world gets the state where the integrator is, and the report its proof of quality there.
void Simulator::Impl::finish(double dt) {
  const double time = goal_.value_or(world_.time() + dt);
  undo_.move_world(stepper_.state());
  world_.set_time(time);
  stepper_.scheme().set_time(time);
  detach_broken();
  stepper_.note_state();
  stepper_.note_left();
  report_.time = time;
  if (report_.status == Status::kInexact) report_.message += list_culprits(inquiry());
  quality_.measure(stepper_, report_);
  if (welds_.any()) report_.gap = wider(report_.gap, bodies_.placed_gap());
  if (settings_.report_energy) close_ledger();
  sleep_.watch(world_, dt);
}

/// What broke in the step is out of the world from now on.
void Simulator::Impl::detach_broken() {
  const std::span<const BreakEvent> events = stepper_.scheme().breaking().events();
  if (events.empty()) return;
  report_.breaks.assign(events.begin(), events.end());
  for (const BreakEvent& event : events) undo_.detach(event.joint);
}

void Simulator::Impl::close_ledger() {
  StepWorks& works = report_.works;
  Scheme& scheme = stepper_.scheme();
  for (const AxisReport& axis : scheme.axis_reports()) works.axes += axis.work;
  works.contacts = scheme.work_of_contacts();
  works.constraint -= works.axes.total() + works.contacts.total();
  sum_motion(stepper_.state(), stepper_.momenta(), report_);
  const World::Hold held = source_.hold();
  accounting_.close(world_, report_, scheme.knows_works());
}

/// A step that failed: joints that were closed before it are open again, and the user's world is untouched.
void Simulator::Impl::stay_where_it_was() {
  undo_.restore_state();
  stepper_.note_restored();
  sleep_.restore_awake(world_);
  bodies_.note_published();
}

/// New topology: new pattern, order and symbolic factor.  New state: new start.  What contacts and friction
/// know of the steps before is kept, but where bodies were moved.
void Simulator::Impl::refresh() {
  const bool is_new = !stepper_.knows_pattern();
  // What it knows after a step that failed may be anything.
  const bool goes_on = stepper_.remembers() && !is_new;
  Stepper::Predecessor old;
  if (is_new) old = renew_pattern();
  if (stepper_.knows_state() && recalled_.empty() &&
      (has_no_laws(settings_.integrator) || !may_change(source_)))
    return;
  if (goes_on && recalled_.empty()) {
    const World::Hold held = source_.hold();
    if (stepper_.goes_on_with_new_forces()) return;
  }
  if (stepper_.scheme().closes_joints() && !close_at_start()) return;
  start_scheme(goes_on, old);
  if (stepper_.scheme().blind()) return end_blind(inquiry());
  stepper_.note_started();
  restarted_ = true;
  stepper_.note_state();
}

/// A stepper for a new topology, with what the one before knows, but of bodies that were moved.
Stepper::Predecessor Simulator::Impl::renew_pattern() {
  require_none(setting_conflicts(settings_, world_));
  Stepper::Predecessor old = stepper_.renew_from_known();
  note_renewed();
  substepping_.division().forget_reduced_budget();
  report_.times.analysis = stepper_.system().counters().analysis_time;
  return old;
}

void Simulator::Impl::note_renewed() {
  const int rows = stepper_.system().row_count();
  quality_.renew(rows);
  reactions_.renew(rows);
  welds_.renew();
}

/// Joints that are open beyond the tolerance are closed by the smallest move; false, and said so, if that
/// cannot be.
bool Simulator::Impl::close_at_start() {
  const Rows& rows = stepper_.system().rows();
  const Gap gap = max_gap(rows, quality_.residual(rows, world_.state()));
  const bool finite = is_finite_gap(gap);
  if (finite && std::max(gap.metres, gap.radians) <= settings_.position_tolerance) return true;
  State state = world_.state();
  if (finite && close_joints(stepper_.system(), state, settings_.position_tolerance, report_)) {
    undo_.move_world(state);
    return true;
  }
  end_open(inquiry(), state, quality_.residual(rows, state), " at the start");
  return false;
}

/// At the state of the world, with what is known of contacts and friction.
void Simulator::Impl::start_scheme(bool goes_on, Stepper::Predecessor& old) {
  Scheme& scheme = stepper_.scheme();
  bodies_.refer_to_carriers(recalled_);
  scheme.prepare(horizon_, std::move(recalled_), old.scheme.get());
  recalled_.clear();
  const auto velocities = stepper_.left_state() ? Scheme::Velocities::kLeft : Scheme::Velocities::kGiven;
  const World::Hold held = source_.hold();
  if (goes_on) {
    scheme.forget(stepper_.moved_bodies());
    return scheme.restart(world_.state(), velocities, report_);
  }
  scheme.start(world_.state(), velocities, report_);
  if (old.scheme) scheme.inherit(*old.scheme);
}

/// For questions between steps: what the user has changed is taken up as a step of h would.
void Simulator::Impl::bring_up_to_date(double h) {
  bodies_.follow();
  wake_islands(h);
  Before before = begin_undoable();
  try {
    refresh();
  } catch (...) {
    take_back(std::move(before));
    throw;
  }
}

/// Whatever is thrown from now on, by force laws or what asks whether to go on, is to leave the world as it
/// is: whoever catches it takes back what was done.
Simulator::Impl::Before Simulator::Impl::begin_undoable() {
  undo_.begin();
  stepper_.begin_undoable();
  const bool any = hooks_.interrupt || !recalled_.empty();
  return {substepping_.division(), any ? contact_stretches() : std::vector<ContactStretch>()};
}

/// The world as it was before the present step or question, and a new start: what the integrator knows may be
/// anything.
void Simulator::Impl::take_back(Before before) {
  undo_.take_back();
  stepper_.note_restored();
  sleep_.restore_awake(world_);
  substepping_.division() = before.division;
  recalled_ = std::move(before.stretches);
  stepper_.forget_all();
  welds_.forget_step();
  bodies_.note_published();
}

/// While something thrown is handled: all is as it was before, and the report says that the user has asked to
/// end early, or is that of the last step again.
/// @throws what was thrown, unless it was that.
void Simulator::Impl::give_up(Before before) {
  take_back(std::move(before));
  try {
    throw;
  } catch (const detail::Interrupted&) {
    report_.contradiction = {};
    report_.culprits.clear();
    report_.breaks.clear();
    inquiry().end_step(Status::kInterrupted, "interrupted");
  } catch (...) {
    std::swap(report_, last_report_);
    throw;
  }
}

/// An empty report, which keeps its memory; the last one is put aside.
void Simulator::Impl::begin_report() {
  std::swap(report_, last_report_);
  std::vector<DependentRow> kept = std::move(report_.dependent_rows);
  report_ = {};
  kept.clear();
  report_.dependent_rows = std::move(kept);
}

void Simulator::Impl::count_work() {
  if (!stepper_.made()) return;
  ConstraintSystem& system = stepper_.system();
  report_.counts.analyses = system.counters().analyses;
  report_.counts.factorizations = system.counters().factorizations;
  report_.counts.backsolves = system.counters().backsolves;
  system.reset_counters();
}

void Simulator::Impl::assemble() {
  welds_.solve_means_of_old_source(stepper_, report_.dt);
  bodies_.follow();
  bodies_.wake_all();
  Before before = begin_undoable();
  begin_report();
  try {
    const Stopwatch watch(report_.times.total);
    const detail::InterruptScope scope(&hooks_.interrupt);
    close_all_joints();
    bodies_.publish();
  } catch (...) {
    give_up(std::move(before));
  }
  count_work();
}

void Simulator::Impl::close_all_joints() {
  if (!stepper_.knows_pattern()) refresh();
  State state = world_.state();
  if (close_joints(stepper_.system(), state, settings_.position_tolerance, report_)) {
    undo_.move_world(state);
    refresh();
    undo_.move_world(stepper_.state());
    stepper_.note_state();
    report_.time = world_.time();
    report_.gap = StepQuality::gap(stepper_, quality_.residual(stepper_.system().rows(), world_.state()));
    return;
  }
  const Rows& rows = stepper_.system().rows();
  const std::span<const double> phi = quality_.residual(rows, state);
  if (report_.ok() || !is_finite_gap(max_gap(rows, phi))) end_open(inquiry(), state, phi, "");
}

Simulator::Simulator(World& world, const Settings& settings)
    : impl_(std::make_unique<Impl>(world, settings)) {
  PassingLoads::set(world, {});  // that a simulator which is no more may have left
}
Simulator::~Simulator() = default;

/// A world that was assigned to since is another one, of which nothing is known.
Simulator::Impl& Simulator::impl() const {
  if (impl_->identity_ == impl_->source_.identity()) return *impl_;
  auto fresh = std::make_unique<Impl>(impl_->source_, impl_->settings_);
  fresh->hooks_ = impl_->hooks_;
  impl_ = std::move(fresh);
  return *impl_;
}

Simulator::Simulator(Simulator&&) noexcept = default;

const StepReport& Simulator::report() const { return impl_->whole_ ? *impl_->whole_ : impl_->report_; }

void Simulator::set_interrupt(std::function<bool()> asked) { impl().hooks_.interrupt = std::move(asked); }

void Simulator::set_stage_watch(std::function<void(const ContactStage&)> watch) {
  impl().hooks_.stage_watch = std::move(watch);
}

RankReport Simulator::analyze_rank() { return rank_of(impl().source_, impl().settings_); }

const StepReport& Simulator::assemble() {
  impl().whole_.reset();
  impl().assemble();
  return impl().report_;
}

const World& Simulator::world() const { return impl_->source_; }
const Settings& Simulator::settings() const { return impl_->settings_; }

}  // namespace taut
