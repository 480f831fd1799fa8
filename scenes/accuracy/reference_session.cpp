#include "scenes/accuracy/reference_session.h"

#include <algorithm>
#include <cmath>

#include "core/world/diagnostics.h"

namespace taut::reference {
namespace {

/// Acceleration under which a case starts in equilibrium, and under which it has been relaxed, as a part of
/// gravity's.
constexpr double kEquilibrium = 1e-4, kRelaxed = 1e-8;
constexpr int kStaticSteps = 50, kMaxRelaxation = 100000;

double largest_speed(const State& state) {
  double speed = 0;
  for (const Twist& V : state.twists) speed = std::max({speed, V.v.norm(), V.w.norm()});
  return speed;
}

State at_rest(State state) {
  std::fill(state.twists.begin(), state.twists.end(), Twist{});
  return state;
}

/// Accelerations are told by speeds after one step, which must be tangent to more digits than usual.
Settings settings_of(const Case& reference, const RunPlan& plan) {
  Settings settings = plan.settings;
  if (reference.level == "static") settings.velocity_tolerance = std::min(settings.velocity_tolerance, 1e-12);
  return settings;
}

/// Contacts give no force before the first step.
bool reads_contacts(const nlohmann::json& probe) {
  if (probe.contains("pair")) return true;
  if (probe.contains("of")) return reads_contacts(probe.at("of"));
  const auto items = probe.value("items", nlohmann::json::array());
  return std::any_of(items.begin(), items.end(), reads_contacts);
}

}  // namespace

void compare(const Quantity& quantity, const std::vector<double>& measured, double allowed,
             Measurement& result) {
  result.allowed = allowed;
  if (measured.size() != quantity.value.size()) {
    result.verdict = Verdict::kFail;
    result.measured = measured;
    result.reason = "has " + std::to_string(measured.size()) + " components";
    return;
  }
  double worst = 0;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const double error = std::abs(measured[i] - quantity.value[i]);
    if (!(error <= worst)) worst = error;
  }
  const bool first = result.measured.empty();
  if (!first && (std::isnan(result.error) || worst <= result.error)) return;
  result.measured = measured;
  result.error = worst;
  if (quantity.binding()) result.verdict = worst <= allowed ? Verdict::kPass : Verdict::kFail;
}

Session::Session(Case& reference, const RunPlan& plan, CaseRun& result)
    : case_(reference),
      plan_(plan),
      result_(result),
      simulator_(reference.world, settings_of(reference, plan)) {
  list_quantities();
  if (!case_.impulses.empty()) apply_impulses();
  probes_.emplace(case_, simulator_);
}

void Session::list_quantities() {
  for (std::size_t i = 0; i < case_.quantities.size(); ++i) {
    const Quantity& quantity = case_.quantities[i];
    Measurement& result = result_.quantities[i];
    if (!quantity.has_probe())
      result.reason = why_not_measured(quantity);
    else if (!Probes::knows(quantity.probe))
      result.reason = "probe of unknown kind: " + quantity.probe.dump();
    else if (plan_.end && quantity.time && *quantity.time > *plan_.end + 1e-9)
      result.reason = "later than the end of the run";
    else
      pending_.push_back({&quantity, &result, Probes::is_about_the_run(quantity.probe)});
  }
}

/// An impulse P changes the free velocities by M⁻¹P; the joints' answer is the mass-weighted projection that
/// assemble() makes of velocities that are not tangent.
void Session::apply_impulses() {
  World& world = case_.world;
  for (const Impulse& impulse : case_.impulses) {
    const Pose& pose = world.pose(impulse.body);
    const MassProperties& mass = world.mass_properties(impulse.body);
    const Mat3 R = pose.q.toRotationMatrix();
    Twist twist = world.twist(impulse.body);
    twist.v += impulse.impulse / mass.mass();
    twist.w +=
        R * mass.inertia_B().inverse() * R.transpose() * (pose.q * impulse.p_BP).cross(impulse.impulse);
    world.set_twist(impulse.body, twist);
  }
  if (!simulator_.assemble().exact()) result_.failed = "impulse: " + simulator_.report().message;
}

void Session::run() {
  if (!result_.failed.empty()) return;
  if (case_.level == "static")
    run_static();
  else
    run_motion();
}

bool Session::step(double dt) {
  const StepReport& report = simulator_.step(dt);
  ++result_.steps;
  if (!report.exact()) {
    result_.failed = "step to t = " + std::to_string(simulator_.world().time() + dt) +
                     " s: " + std::string(to_string(report.status)) + ": " + report.message;
    return false;
  }
  result_.max_gap = std::max({result_.max_gap, report.gap.metres, report.gap.radians});
  probes_->observe();
  return true;
}

bool Session::advance(double t) {
  const double span = t - simulator_.world().time();
  const int steps = static_cast<int>(std::ceil(span / dt() - 1e-6));
  for (int i = 0; i < steps; ++i)
    if (!step(span / steps)) return false;
  return true;
}

void Session::measure(const Pending& pending) {
  const auto& [quantity, result, about_the_run] = pending;
  try {
    compare(*quantity, probes_->evaluate(quantity->probe), allowed_error(case_, *quantity, plan_), *result);
    result->reason.clear();
  } catch (const NotMeasured& error) {
    result->reason = error.what();
  } catch (const std::exception& error) {
    result->reason = error.what();
    if (about_the_run && plan_.end) return;  // it may come later
    result->verdict = quantity->binding() ? Verdict::kFail : Verdict::kOrientation;
  }
}

/// The instants at which quantities are asked for, with others.
std::set<double> Session::instants(std::set<double> times) const {
  for (const Pending& pending : pending_)
    if (pending.quantity->time) times.insert(*pending.quantity->time);
  return times;
}

/// Quantities about the run are of its end, those without a time of all instants but a start without
/// contacts.
bool Session::is_due(const Pending& pending, double t, double end) const {
  if (pending.about_the_run) return t == end;
  if (pending.quantity->time) return pending.quantity->time == t;
  return !(t == 0 && end > 0 && reads_contacts(pending.quantity->probe));
}

void Session::run_motion() {
  double end = case_.duration;
  for (const Quantity& quantity : case_.quantities) end = std::max(end, quantity.time.value_or(0));
  if (plan_.end) end = std::min(end, *plan_.end);
  for (double t : instants({end})) {
    if (t > simulator_.world().time() && !advance(t)) return;
    for (const Pending& pending : pending_)
      if (is_due(pending, t, end)) measure(pending);
  }
  wait_for_events(end);
}

/// A file may give no duration, or one that ends before the event: the run goes on for a while.
void Session::wait_for_events(double end) {
  const double last = plan_.end ? end : 3 * end + 1;
  const auto missing = [](const Pending& pending) {
    return pending.about_the_run && pending.result->measured.empty() && !pending.result->reason.empty();
  };
  while (simulator_.world().time() < last && std::any_of(pending_.begin(), pending_.end(), missing)) {
    for (int i = 0; i < kStaticSteps; ++i)
      if (!step(dt())) return;
    for (const Pending& pending : pending_)
      if (missing(pending)) measure(pending);
  }
}

/// Speeds after one step from rest tell the accelerations.
bool Session::accelerates() {
  const State start = simulator_.world().state();
  const double g = std::max(1.0, case_.world.gravity().norm());
  const bool moved = step(dt()) && largest_speed(simulator_.world().state()) > kEquilibrium * g * dt();
  case_.world.set_state(start);
  return moved;
}

/// Kinetic damping: a system that moves freely from rest has passed an equilibrium when its kinetic energy
/// falls.
void Session::relax() {
  const double g = std::max(1.0, case_.world.gravity().norm());
  double kinetic = 0;
  for (int i = 0; i < kMaxRelaxation; ++i) {
    if (!step(dt())) return;
    const double now = kinetic_energy(case_.world, case_.world.state());
    const bool over = now < kinetic;
    kinetic = over ? 0 : now;
    if (!over) continue;
    case_.world.set_state(at_rest(case_.world.state()));
    if (!step(dt())) return;
    // Where a step from rest gives no speed the forces balance.
    if (largest_speed(case_.world.state()) < kRelaxed * g * dt()) break;
  }
  case_.world.set_state(at_rest(case_.world.state()));
}

void Session::run_static() {
  if (case_.pairs.empty() && accelerates()) {
    if (result_.failed.empty()) relax();
    if (!result_.failed.empty()) return;
    for (const Pending& pending : pending_) measure(pending);
    return;
  }
  if (!result_.failed.empty()) return;
  for (double t : instants({0.0, kStaticSteps * dt()})) {
    if (t > 0 && !advance(t)) return;
    for (const Pending& pending : pending_) {
      if (t == 0 && reads_contacts(pending.quantity->probe)) continue;
      if (!pending.quantity->time || pending.quantity->time == t) measure(pending);
    }
  }
}

}  // namespace taut::reference
