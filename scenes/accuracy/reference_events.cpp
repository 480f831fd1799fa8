#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/base/check.h"
#include "scenes/accuracy/reference_probes.h"

/// Probes of what acts along axes, and of events: impacts, turning points, coming to rest.
namespace taut::reference {
namespace {

using Json = nlohmann::json;
using Values = Probes::Values;

/// A body slower than this is at rest [m/s, rad/s].
constexpr double kRest = 1e-9;

std::string kind_of(const Json& probe) { return probe.at("kind"); }
bool is_at_impact(const Json& probe) {
  return kind_of(probe) == "before_impact" || kind_of(probe) == "after_impact";
}
bool is_turning(const Json& probe) {
  return kind_of(probe) == "turning_time" || kind_of(probe) == "turning_value";
}

bool is_crossing(const Json& probe) {
  return kind_of(probe) == "crossing_time" || kind_of(probe) == "at_crossing";
}
bool is_first(const Json& probe) {
  return kind_of(probe) == "first_value" || kind_of(probe) == "initial_rate";
}

/// What is crossed, which a probe says itself or under "crossing".
const Json& crossing_of(const Json& probe) {
  return kind_of(probe) == "at_crossing" ? probe.at("crossing") : probe;
}
std::string text_of_crossing(const Json& probe) {
  const Json& crossing = crossing_of(probe);
  return Json::array({crossing.at("of"), crossing.value("level", 0.0), crossing.value("direction", "any")})
      .dump();
}
int sign_of_crossing(const Json& probe) {
  const std::string direction = crossing_of(probe).value("direction", "any");
  if (direction != "up" && direction != "down" && direction != "any")
    fail("probe", "a direction is \"up\", \"down\" or \"any\"", direction);
  return direction == "up" ? 1 : direction == "down" ? -1 : 0;
}

/// The joint or the pair of an impact, as text.
std::string place_of(const Json& probe) { return probe.at(probe.contains("pair") ? "pair" : "joint").dump(); }

/// The index-th entry, from 1.
template <typename T>
const T& entry(const std::vector<T>& list, const Json& probe) {
  const std::size_t index = probe.at("index");
  if (index == 0 || index > list.size()) throw std::runtime_error("not seen in the run: " + probe.dump());
  return list[index - 1];
}

/// Where the straight line through two samples is at a time.
template <typename Sample>
Values on_line(const Sample& a, const Sample& b, double time) {
  const double part = (time - a.time) / (b.time - a.time);
  Values values = b.values;
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = a.values[i] + part * (b.values[i] - a.values[i]);
  return values;
}

}  // namespace

bool Probes::is_about_the_run(const Json& probe) {
  const std::string kind = kind_of(probe);
  return kind == "crossing_period" || kind == "extremum_in_time" || kind == "rest_time" ||
         kind == "impact_time" || kind == "impact_count" || kind == "impact_order" || kind == "final_value" ||
         is_at_impact(probe) || is_turning(probe) || is_crossing(probe) || is_first(probe) ||
         (probe.contains("of") && is_about_the_run(probe.at("of"))) ||
         (probe.contains("items") && std::ranges::any_of(probe.at("items"), is_about_the_run));
}

void Probes::subscribe_events(const Json& probe) {
  if (kind_of(probe) == "rest_time") rests_[probe.at("body")] = {};
  if (kind_of(probe) == "impact_time") impacts_[place_of(probe)];
  if (is_at_impact(probe)) {
    Impacts& impacts = impacts_[place_of(probe)];
    const std::string of = probe.at("of").dump();
    impacts.now[of] = evaluate(probe.at("of"));
  }
  for (const Json& pair : probe.value("pairs", Json::array())) impacts_[pair.dump()];
  if (is_first(probe)) firsts_[probe.at("of").dump()] = {evaluate(probe.at("of"))};
  if (is_crossing(probe)) {
    Crossings& crossings = crossings_[text_of_crossing(probe)];
    crossings.of = crossing_of(probe).at("of");
    crossings.level = crossing_of(probe).value("level", 0.0);
    crossings.direction = sign_of_crossing(probe);
    crossings.t = state().time;
    crossings.x = evaluate(crossings.of).at(0) - crossings.level;
    if (kind_of(probe) == "at_crossing")
      crossings.measured[probe.at("of").dump()].last = {state().time, evaluate(probe.at("of"))};
  }
  if (is_turning(probe)) {
    Turns& turns = turns_[probe.at("of").dump()];
    turns.of = probe.at("of");
  }
}

void Probes::observe_events() {
  for (auto& [where, impacts] : impacts_) observe(where, impacts);
  for (auto& [of, turns] : turns_) observe(turns);
  for (auto& [of, crossings] : crossings_) observe(crossings);
  for (auto& [of, values] : firsts_) {
    if (values.size() > 1) continue;
    values.push_back(evaluate(Json::parse(of)));
    first_step_ = state().time - start_.time;
  }
  for (auto& [body, rest] : rests_) observe(find_body(case_.world, body), rest);
}

std::optional<double> Probes::last_impact(const std::string& where) const {
  const Json place = Json::parse(where);
  if (place.is_array()) return pair_contact(simulator_, pair({{"pair", place}})).impact_time;
  return simulator_.axis_report(case_.axes.at(place).id).impact_time;
}

void Probes::observe(const std::string& where, Impacts& impacts) {
  const std::optional<double> time = last_impact(where);
  if (time) impacts.times.push_back(*time);
  for (auto& [of, now] : impacts.now) {
    const Values last = now;
    now = evaluate(Json::parse(of));
    if (!time) continue;
    impacts.before[of].push_back(last);
    impacts.after[of].push_back(now);
  }
}

/// An extreme among three samples is where their parabola turns; a scalar that stops turns at the first of
/// its equal values.
void Probes::observe(Turns& turns) {
  auto& [of, t, x, times, values] = turns;
  t.push_back(state().time);
  x.push_back(evaluate(of).at(0));
  if (t.size() < 3) return;
  const double before = x[1] - x[0], after = x[2] - x[1];
  if (before != 0 && before * after <= 0) {
    const double h = t[2] - t[1], shift = after == 0 ? 0 : -0.5 * (before + after) / (after - before);
    times.push_back(t[1] + shift * h);
    values.push_back(x[1] + 0.25 * shift * (before + after));
  }
  t.erase(t.begin());
  x.erase(x.begin());
}

/// Where the chord through the last two samples is 0; a sample on the level belongs to the step that ends in
/// it.
void Probes::observe(Crossings& crossings) {
  auto& [of, level, direction, t, x, times, measured] = crossings;
  const double last_t = t, last_x = x;
  t = state().time;
  x = evaluate(of).at(0) - level;
  const bool up = last_x < 0 && x >= 0, down = last_x > 0 && x <= 0;
  const bool passes = (up && direction >= 0) || (down && direction <= 0);
  if (passes) times.push_back(last_t + last_x / (last_x - x) * (t - last_t));
  for (auto& [what, values] : measured) observe(times, passes, {t, evaluate(Json::parse(what))}, values);
}

void Probes::observe(const std::vector<double>& times, bool passes, const Crossings::Sample& now,
                     Crossings::Measured& measured) {
  auto& [last, before_last, before, at, after] = measured;
  const bool just_passed = !times.empty() && !passes && after.size() == times.size() &&
                           times.back() > before_last.time && times.back() <= last.time;
  if (just_passed) after.back() = on_line(last, now, times.back());
  if (passes) {
    before.push_back(before_last.values.empty() ? last.values : on_line(before_last, last, times.back()));
    at.push_back(on_line(last, now, times.back()));
    after.push_back(now.values);
  }
  before_last = last;
  last = now;
}

void Probes::observe(BodyId body, Rest& rest) {
  const Twist& V = state().twists[body.index];
  const bool moving = V.v.norm() > kRest || V.w.norm() > kRest;
  if (!moving && rest.moving) rest.since = state().time;
  rest.moving = moving;
}

/// m of a coupling: the torque on the last of its bodies is coef · m.
double Probes::multiplier_of(const std::string& joint) {
  const Coupling::Term& last = case_.couplings.at(joint).terms.back();
  const Vec3 axis = state().poses[last.hinge.a.index].q * last.hinge.axis_A;
  const JointId id = simulator_.world().joint(joint);
  const double sign = simulator_.world().joint(id).b() == last.hinge.b ? 1 : -1;
  return sign * simulator_.reaction(id).torque.dot(axis) / last.coef;
}

AxisReport Probes::axis_report(const Json& probe) const {
  return simulator_.axis_report(case_.axes.at(probe.at("joint")).id);
}

Values Probes::multiplier(const Json& probe) { return {multiplier_of(probe.at("joint"))}; }
Values Probes::motor_torque(const Json& probe) { return {axis_report(probe).force.motor}; }
Values Probes::limit_torque(const Json& probe) { return {axis_report(probe).force.limit}; }

Values Probes::rest_time(const Json& probe) {
  const Rest& rest = rests_.at(probe.at("body"));
  if (rest.moving) throw std::runtime_error("still moving at the end of the run: " + probe.dump());
  return {rest.since};
}

Values Probes::impact_time(const Json& probe) { return {entry(impacts_.at(place_of(probe)).times, probe)}; }

Values Probes::at_impact(const Json& probe) {
  Impacts& impacts = impacts_.at(place_of(probe));
  const std::string of = probe.at("of").dump();
  return entry(kind_of(probe) == "before_impact" ? impacts.before[of] : impacts.after[of], probe);
}

const Pair& Probes::pair(const Json& probe) const {
  const std::string a = probe.at("pair").at(0), b = probe.at("pair").at(1);
  for (const Pair& pair : case_.pairs)
    if ((pair.a == a && pair.b == b) || (pair.a == b && pair.b == a)) return pair;
  fail("probe", "there is no such pair", probe.dump());
}

Values Probes::contact_force(const Json& probe) {
  const Pair& of = pair(probe);
  const PairContact contact = pair_contact(simulator_, of);
  const double sign = probe.at("on") == of.b ? 1 : -1;
  const std::string part = probe.value("part", "all");
  Vec3 force = Vec3::Zero();
  if (part != "friction") force += contact.normal_on_b;
  if (part != "normal") force += contact.friction_on_b;
  return {sign * force.x(), sign * force.y(), sign * force.z()};
}

Values Probes::contact_normal_sum(const Json& probe) {
  return {pair_contact(simulator_, pair(probe)).normal_sum};
}

Values Probes::turning_time(const Json& probe) {
  return {entry(turns_.at(probe.at("of").dump()).times, probe)};
}

Values Probes::turning_value(const Json& probe) {
  return {entry(turns_.at(probe.at("of").dump()).values, probe)};
}

Values Probes::final_value(const Json& probe) { return evaluate(probe.at("of")); }

Values Probes::first_value(const Json& probe) { return firsts_.at(probe.at("of").dump()).at(1); }

Values Probes::initial_rate(const Json& probe) {
  const std::vector<Values>& values = firsts_.at(probe.at("of").dump());
  Values rate = values.at(1);
  for (std::size_t i = 0; i < rate.size(); ++i) rate[i] = (rate[i] - values[0][i]) / first_step_;
  return rate;
}

Values Probes::crossing_time(const Json& probe) {
  return {entry(crossings_.at(text_of_crossing(probe)).times, probe)};
}

Values Probes::at_crossing(const Json& probe) {
  const Crossings::Measured& of = crossings_.at(text_of_crossing(probe)).measured.at(probe.at("of").dump());
  const std::string side = probe.value("side", "both");
  if (side != "both" && side != "before" && side != "after")
    fail("probe", "a side is \"both\", \"before\" or \"after\"", side);
  return entry(side == "before" ? of.before : side == "after" ? of.after : of.at, probe);
}

std::vector<std::pair<double, int>> Probes::impacts_among(const Json& probe) const {
  std::vector<std::pair<double, int>> all;
  int index = 0;
  for (const Json& pair : probe.at("pairs")) {
    for (double time : impacts_.at(pair.dump()).times) all.emplace_back(time, index);
    ++index;
  }
  std::sort(all.begin(), all.end());
  return all;
}

Values Probes::impact_count(const Json& probe) { return {static_cast<double>(impacts_among(probe).size())}; }

Values Probes::impact_order(const Json& probe) {
  Values order;
  for (const auto& [time, index] : impacts_among(probe)) order.push_back(index);
  return order;
}

Values Probes::contact_sliding(const Json& probe) {
  return {pair_contact(simulator_, pair(probe)).sliding ? 1.0 : 0.0};
}

Values Probes::centre_of_pressure(const Json& probe) {
  const Vec3 centre = pair_contact(simulator_, pair(probe)).centre();
  return {centre.x(), centre.y(), centre.z()};
}

Values Probes::time(const Json&) { return {state().time}; }

}  // namespace taut::reference
