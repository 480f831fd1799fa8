#include "solvers/laws/axes/axis_law.h"

#include <algorithm>
#include <cmath>

namespace taut {
namespace {

/// The last parts first.
void split_beside(AxisImpulse&, double&, double) {}
template <typename Part, typename... Others>
void split_beside(AxisImpulse& impulse, double& rest, double w, const Part& part, const Others&... others) {
  split_beside(impulse, rest, w, others...);
  part.split_beside(impulse, rest, w);
}

}  // namespace

void AxisLaw::restart(double theta, double rate) {
  *this = {};
  with_parts(*this, [&](auto&... part) { (part.restart(theta, rate), ...); });
}

void AxisLaw::begin(const AxisProperties& p, const AxisStep& step) {
  with_parts(*this, [&](auto&... part) { (part.begin(p, step, start), ...); });
}

void AxisLaw::inherit(const AxisLaw& old) {
  with_parts(old, [&](const auto&... theirs) {
    with_parts(*this, [&](auto&... part) { (part.inherit(theirs), ...); });
  });
}

bool AxisLaw::set(const AxisStage& stage) {
  bool finite = true;
  with_parts(*this, [&](auto&... part) { ((finite = part.set(stage) && finite), ...); });
  return finite;
}

void AxisLaw::release() {
  with_parts(*this, [&](auto&... part) { (part.release(), ...); });
}

bool AxisLaw::move(const AxisProperties& p, const AxisStep& step, double w, double rate_tolerance) {
  bool moved = false;
  with_parts(*this,
             [&](auto&... part) { ((moved = part.move(p, step, start, w, rate_tolerance) || moved), ...); });
  return moved;
}

void AxisLaw::finish_first_kick(const AxisProperties& p, double w) {
  with_parts(*this, [&](auto&... part) { (part.finish_first_kick(p, start, w), ...); });
}

void AxisLaw::finish(AxisReport& report, const AxisEnd& end) {
  with_parts(*this, [&](auto&... part) { (part.finish(report, end), ...); });
}

void AxisLaw::report(AxisReport& report, const AxisProperties& p, double w) const {
  report.saturated = report.at_limit = false;
  with_parts(*this, [&](const auto&... part) { (part.report(report, p, w), ...); });
}

RowLaw AxisLaw::sum(const AxisProperties& p) {
  // A motor of any force stops at a limit.
  if (motor.bound > 0 && std::isinf(motor.bound))
    motor.at = std::clamp(motor.at, limits.lower_at, limits.upper_at);
  if (winch.bound > 0 && std::isinf(winch.bound)) winch.at = std::max(winch.at, limits.lower_at);
  return graph(p);
}

RowLaw AxisLaw::graph(const AxisProperties& p) const {
  RowLaw law;
  with_parts(*this, [&](const auto&... part) { (part.add_to(law, p), ...); });
  return law;
}

double AxisLaw::rate_of(const AxisProperties& p, double lambda, double w) const {
  const RowLaw law = graph(p);
  const int segment = law.segment_at(lambda);
  return RowLaw::is_vertical(segment) ? law.rate(segment)
                                      : std::clamp(w, law.first(segment), law.last(segment));
}

/// Lines and what is beside a step are known from w; on a step of the law the rest goes to friction as far as
/// it reaches, then to the motor, then to the limit.
AxisImpulse AxisLaw::split(double lambda, double w) const {
  AxisImpulse impulse;
  double rest = lambda;
  with_parts(*this, [&](const auto&... part) {
    (part.split_lines(impulse, rest, w), ...);
    taut::split_beside(impulse, rest, w, part...);
    (part.split_on_step(impulse, rest, w), ...);
  });
  return impulse;
}

}  // namespace taut
