#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "core/base/check.h"
#include "solvers/simulator/simulator_impl.h"

// A step with events in it: parts between them, what happens there, and one report of all.
namespace taut {
namespace {

/// Chosen, where nothing else is said.
struct EventTuning {
  /// Instants closer than this part of a step are one: an event's end of a step is moved by so much, as is
  /// the end of a run (run_until()), and so late is an event at most that was located.  Chosen.
  static constexpr double kOneInstant = 1e-6;
  /// A located event takes 4 to 8 trials of a smooth number, and 20 if each halved the interval.
  static constexpr int kMostTrials = 40, kStraightTrials = 8;
};

void add(SolverCounts& sum, const SolverCounts& part) {
  for (const auto count : {&SolverCounts::analyses, &SolverCounts::factorizations, &SolverCounts::backsolves,
                           &SolverCounts::refactorizations, &SolverCounts::pivots,
                           &SolverCounts::contact_iterations, &SolverCounts::sweeps})
    sum.*count += part.*count;
}

void add(ContactWork& sum, const ContactWork& part) {
  sum.normal += part.normal;
  sum.friction += part.friction;
}

void add(StepWorks& sum, const StepWorks& part) {
  for (const auto work : {&StepWorks::constraint, &StepWorks::stiffness, &StepWorks::drivers,
                          &StepWorks::forces, &StepWorks::dissipative, &StepWorks::flow})
    sum.*work += part.*work;
  for (const auto& [axis_part, column, term] : kAxisParts) sum.axes.*axis_part += part.axes.*axis_part;
  add(sum.contacts, part.contacts);
}

/// The report of a step whose parts before `part` came to `before`: sums, the largest, and the last.
StepReport together(const StepReport& before, const StepReport& part) {
  StepReport all = part;
  all.status = part.exact() && before.status == Status::kInexact ? before.status : part.status;
  if (part.exact()) all.message = before.message, all.culprits = before.culprits;
  for (const auto largest : {&StepReport::velocity_residual, &StepReport::tension_number,
                             &StepReport::complementarity_residual, &StepReport::natural_residual})
    all.*largest = std::max(before.*largest, part.*largest);
  all.newton_iterations += before.newton_iterations;
  all.substeps += before.substeps;
  add(all.counts, before.counts);
  all.times += before.times;
  add(all.works, before.works);
  all.ledger += before.ledger;
  all.ledger.start = before.ledger.start;
  all.breaks.insert(all.breaks.begin(), before.breaks.begin(), before.breaks.end());
  all.missing_threads = std::max(before.missing_threads, part.missing_threads);
  all.events = before.events;
  return all;
}

/// What a world stores [J].
struct Stored {
  double springs = 0, potential = 0;  // of springs, and of all else
  explicit Stored(const World& world)
      : springs(world.spring_energy(world.state())),
        potential(world.potential_energy(world.state()) - springs) {}
};

/// What an event has changed at once is in the ledger.
void add_to_ledger(StepReport& report, const Stored& before, const Stored& after) {
  const double by_springs = after.springs - before.springs, by_potential = after.potential - before.potential;
  report.spring_energy += by_springs, report.potential_energy += by_potential;
  report.ledger.springs += by_springs, report.ledger.potential += by_potential;
  report.ledger.events += by_springs + by_potential;
}

/// The report of a step in which no part has been taken yet.
StepReport at_start(const World& world, bool with_energies) {
  StepReport report;
  report.time = world.time();
  if (!with_energies) return report;
  const State& state = world.state();
  report.kinetic_energy = kinetic_energy(world, state);
  const Stored stored(world);
  report.spring_energy = stored.springs;
  report.potential_energy = stored.potential;
  report.linear_momentum = linear_momentum(world, state);
  report.angular_momentum = angular_momentum(world, state);
  report.ledger.start = report.energy();
  return report;
}

}  // namespace

void Simulator::set_events(std::vector<Event> events) {
  EventSchedule schedule(impl().source_, std::move(events));
  impl().events_ = std::move(schedule);
  PassingLoads::set(impl().source_, {});
  impl().since_events_.reset();
}

const std::vector<EventRecord>& Simulator::events_happened() const { return impl().events_.happened(); }

const std::string& Simulator::ended_by() const { return impl().events_.ended_by(); }

/// A step that ends at the time `to`, to the last bit; false if it is not done.
bool Simulator::take_part(double from, double to) {
  impl().goal_ = to;
  bool done = false;
  try {
    done = step(to - from).ok();
  } catch (...) {
    impl().goal_.reset();
    throw;
  }
  impl().goal_.reset();
  return done;
}

/// Has the simulator, which is at `to`, go back to where the first located event of the part happens, if one
/// does: at most EventTuning::kOneInstant of the part late.  False if the part is not done.
bool Simulator::locate_event(double from, double to, const Checkpoint& before) {
  if (!impl().events_.has_passed(*this)) return true;
  const double close = EventTuning::kOneInstant * (to - from);
  double low = from, high = to, at = to;  // nothing has happened at low, something at high
  for (int trial = 0; trial < EventTuning::kMostTrials && high - low > close; ++trial) {
    const double straight = from + impl().events_.first_passage(*this) * (at - from) + 0.5 * close;
    const bool halve = trial >= EventTuning::kStraightTrials && trial % 2 == 0;
    const double aim = halve || !std::isfinite(straight) ? 0.5 * (low + high) : straight;
    at = std::clamp(aim, low + 0.5 * close, high - 0.5 * close);
    restore(before);
    if (!take_part(from, at)) {  // then at the end
      restore(before);
      return take_part(from, to);
    }
    (impl().events_.has_passed(*this) ? high : low) = at;
  }
  if (to - high < close) high = to;
  if (at == high) return true;
  restore(before);
  return take_part(from, high);
}

/// What is due now happens; false if the step ends with it: a joint could not be attached, or the run ends.
bool Simulator::let_happen(StepReport& whole, double instant) {
  Impl& now = impl();
  World& world = now.source_;
  now.events_.end_loads(world, world.time() + instant);
  const std::vector<DueEvent> due = now.events_.due(*this, instant);
  if (due.empty()) return true;
  const Checkpoint kept = checkpoint_if_any(due);
  const bool with_energies = now.settings_.report_energy;
  const std::optional<Stored> before = with_energies ? std::optional<Stored>(world) : std::nullopt;
  if (whole.dt == 0) whole = at_start(world, with_energies);
  const std::size_t happened = now.events_.happened().size();
  const std::optional<EventSchedule::Refusal> refusal = now.events_.let_happen(now.source_, due);
  whole.events.insert(whole.events.end(),
                      now.events_.happened().begin() + static_cast<std::ptrdiff_t>(happened),
                      now.events_.happened().end());
  if (before) add_to_ledger(whole, *before, Stored(world));
  if (!kept.empty()) now.since_events_ = {kept, now.versions()};
  if (refusal) {
    whole.status = Status::kContradiction;
    whole.message = refusal->what;
    whole.culprits = {{.kind = Culprit::Kind::kJoint, .axis = {refusal->joint}, .share = refusal->gap}};
  }
  return !refusal && std::none_of(whole.events.begin(), whole.events.end(),
                                  [](const EventRecord& event) { return event.ends_run; });
}

/// A checkpoint before these events; none where the user has changed the world since the last step in a way
/// that has no checkpoint until the next.
Checkpoint Simulator::checkpoint_if_any(const std::vector<DueEvent>& due) {
  try {
    return due.empty() ? checkpoint() : checkpoint_before(due);
  } catch (const std::invalid_argument&) {
    return {};
  }
}

const StepReport& Simulator::step_with_events(double dt) {
  World& world = impl().source_;
  const std::vector<BodyLoad> loads = PassingLoads::next(world);
  const double end = world.time() + dt, instant = EventTuning::kOneInstant * dt;
  StepReport whole;
  impl().events_.prime(*this);
  bool goes_on = let_happen(whole, instant);
  while (goes_on && end - world.time() > instant) {
    const double from = world.time(), next = impl().events_.next_time(from);
    const double to = next <= end + instant ? next : end;
    PassingLoads::set_next(world, loads);  // for all parts
    const bool attached = impl().events_.take_attached();
    const Checkpoint before = impl().events_.locates() ? checkpoint_if_any({}) : Checkpoint();
    goes_on = take_part(from, to);
    if (goes_on && !before.empty()) goes_on = locate_event(from, to, before);
    StepReport part = impl().report_;
    if (attached && !goes_on) impl().events_.note_attached();
    if (attached) part.ledger.events += std::exchange(part.ledger.stabilisation, 0.0);
    whole = whole.dt > 0 || !whole.events.empty() ? together(whole, part) : std::move(part);
    goes_on = goes_on && let_happen(whole, instant);
  }
  whole.dt = dt;
  return impl().whole_.emplace(std::move(whole));
}

}  // namespace taut
