#include "solvers/laws/axes/axis_spring_law.h"

#include <algorithm>
#include <cmath>

namespace taut {
namespace {

/// Mean of `beyond` on a way that begins with a and ends with b, and its derivative with respect to the end.
Curve::Mean mean_beyond(double a, double b, double way) {
  if (a == 0 && b == 0) return {};
  if (a * b > 0) return {0.5 * (a + b), 0.5};
  const double mean = 0.5 * (b - a) * (b + a) / way;
  return {mean, (b - mean) / way};
}

/// Of an impulse −value that falls by `slope` at the rate w.
ImpulseLine tangent(double value, double slope, double w) {
  const double descent = std::max(0.0, slope);
  return {-value + descent * w, descent};
}

/// For ϑ = ½ the mean of the force on the way: what it does then is what the potential changes by, whatever
/// the table, and for a linear spring this is the implicit midpoint rule.  For more a part of it is the force
/// at the end, which takes energy; what is not resolved gives more against the way, too.
ImpulseLine spring_tangent(const AxisSpring& spring, double excess, const AxisStep& step,
                           const AxisStart& start, double w) {
  const AxisStroke way = stroke(step, start, spring.table ? w : 0);
  const double from = way.from - spring.rest, to = way.to - spring.rest;
  if (!spring.table) {
    const double impulse = way.time * spring.stiffness;
    return {-impulse * (from + way.part * (to - from)), impulse * way.part * way.per_rate + excess};
  }
  const Curve::Mean mean = spring.table->mean(from, to);
  const double last = 2 * way.part - 1;
  const double force = (1 - last) * mean.value + last * spring.table->extended(to);
  const double slope = ((1 - last) * mean.slope + last * spring.table->slope(to)) * way.per_rate;
  return tangent(way.time * force + excess * w, way.time * slope + excess, w);
}

/// Beyond a limit with compliance there is a spring, as those of axes.  What is more than that against the
/// way counts the part of the way that is beyond the limit.
ImpulseLine limit_tangent(const AxisLimits& limits, double excess, const AxisStep& step,
                          const AxisStart& start, double w) {
  const AxisStroke way = stroke(step, start, w);
  const double from = beyond(limits, way.from), to = beyond(limits, way.to);
  const Curve::Mean mean = mean_beyond(from, to, way.to - way.from);
  const double last = 2 * way.part - 1, impulse = way.time / limits.compliance;
  const double stretch = (1 - last) * mean.value + last * to;
  const double slope = (1 - last) * mean.slope + (to != 0 ? last : 0);
  const double more = excess / step.h;
  return tangent(impulse * stretch + more * (to - from),
                 (impulse * slope + (to != 0 ? more : 0)) * way.per_rate, w);
}

/// The damper of a soft limit acts on the way that is beyond.
ImpulseLine limit_damper_tangent(const AxisLimits& limits, const AxisStep& step, const AxisStart& start,
                                 double w) {
  const AxisStroke way = stroke(step, start, w);
  const double to = beyond(limits, way.to), damping = way.time / step.h * limits.damping;
  return tangent(damping * (to - beyond(limits, way.from)), to != 0 ? damping * way.per_rate : 0, w);
}

/// Dampers act against the mean rate of the step in its first kick, and against that after the second if they
/// are implicit there.
ImpulseLine damper_tangent(const Curve& table, const AxisStep& step, const AxisStart& start, double w) {
  if (step.in(Kick::kSingle)) {
    const double rate = (1 - step.vartheta) * start.rate + step.vartheta * w;
    return tangent(step.h * table.extended(rate), step.h * step.vartheta * table.slope(rate), w);
  }
  return tangent(0.5 * step.h * table.extended(w), 0.5 * step.h * table.slope(w), w);
}

}  // namespace

void AxisSpringLaw::begin(const AxisProperties& p, const AxisStep& step, const AxisStart& start) {
  const double damping = (p.friction ? p.friction->viscous : 0) + (p.spring ? p.spring->damping : 0) +
                         (p.limits ? p.limits->damping : 0);
  implicit_damping = 0.5 * step.h * damping > start.effective_mass;
  if (is_curved(p)) tangents.start(start.rate);
}

bool AxisSpringLaw::set(const AxisStage& stage) {
  switch (stage.step.kick) {
    case Kick::kFirst:
      set_first_kick(stage);
      break;
    case Kick::kSecond:
      set_second_kick(stage);
      break;
    case Kick::kSingle:
      set_single_kick(stage);
  }
  return true;
}

/// Over the mean rate.
void AxisSpringLaw::set_first_kick(const AxisStage& stage) {
  const AxisProperties& p = stage.p;
  release();
  if (p.spring) {
    spring = spring_tangent(*p.spring, excess, stage.step, stage.start, tangents.rate);
    linear_damping = 0.5 * stage.step.h * p.spring->damping;
  }
  if (p.friction) linear_damping += 0.5 * stage.step.h * p.friction->viscous;
  if (has_soft_limit(p))
    limit = limit_tangent(*p.limits, limit_excess, stage.step, stage.start, tangents.rate);
  set_damper(stage);
}

void AxisSpringLaw::finish_first_kick(const AxisProperties& p, const AxisStart& start, double w) {
  spring_given = spring.at(w);
  damping_given = damper.at(w);
  limit_given = limit.at(w);
  if (!is_curved(p)) return;
  implicit_damping = implicit_damping || damper.slope > start.effective_mass;
  tangents.start(w);
}

/// Over θ̇(q₁).
void AxisSpringLaw::set_second_kick(const AxisStage& stage) {
  beyond_limit = has_soft_limit(stage.p) && beyond(*stage.p.limits, stage.theta) != 0;
  limit = {limit_given, beyond_limit ? limit_excess : 0};
  spring = {spring_given, excess};
  set_damper(stage);
  if (!implicit_damping) damper = {damping_given, 0};
}

/// Dampers of a kick of RATTLE, those without a table in linear_damping.
void AxisSpringLaw::set_damper(const AxisStage& stage) {
  const AxisProperties& p = stage.p;
  const AxisStep& step = stage.step;
  damper = {0, linear_damping};
  const auto add = [&](const ImpulseLine& line) {
    damper.level += line.level;
    damper.slope += line.slope;
  };
  if (p.spring && p.spring->damping_table)
    add(damper_tangent(*p.spring->damping_table, step, stage.start, tangents.rate));
  if (!has_soft_limit(p)) return;
  if (!step.in(Kick::kSecond)) add(limit_damper_tangent(*p.limits, step, stage.start, tangents.rate));
  if (step.in(Kick::kSecond) && beyond_limit) damper.slope += 0.5 * step.h * p.limits->damping;
}

/// Over the rate after it: springs at θ₀ + ϑ h ((1 − ϑ) θ̇₀ + ϑ w), soft limits and tables by what they do on
/// the way, and dampers against (1 − ϑ) θ̇₀ + ϑ w.
void AxisSpringLaw::set_single_kick(const AxisStage& stage) {
  const AxisProperties& p = stage.p;
  const AxisStep& step = stage.step;
  const AxisStart& start = stage.start;
  spring = limit = {};
  double damping = p.friction ? p.friction->viscous : 0;
  ImpulseLine by_table, by_limit;
  if (p.spring) {
    spring = spring_tangent(*p.spring, excess, step, start, tangents.rate);
    damping += p.spring->damping;
    if (p.spring->damping_table)
      by_table = damper_tangent(*p.spring->damping_table, step, start, tangents.rate);
  }
  if (has_soft_limit(p)) {
    limit = limit_tangent(*p.limits, limit_excess, step, start, tangents.rate);
    by_limit = limit_damper_tangent(*p.limits, step, start, tangents.rate);
  }
  limit_given = limit.level;
  damper.level = -step.h * (1 - step.vartheta) * damping * start.rate + by_table.level + by_limit.level;
  damper.slope = step.vartheta * step.h * damping + by_table.slope + by_limit.slope;
}

/// Impulses of the curves at w are those of the tangents, to TangentTuning::kTolerance or `tolerance` [N·m·s
/// or N·s].
bool AxisSpringLaw::are_tangents_right(const AxisProperties& p, const AxisStep& step, const AxisStart& start,
                                       double w, double rate_tolerance) const {
  double off = 0, size = 0;
  const auto compare = [&](const ImpulseLine& there, double given) {
    off = std::max(off, std::abs(there.at(w) - given));
    size = std::max(size, std::abs(given));
  };
  if (p.spring && p.spring->table && !step.in(Kick::kSecond))
    compare(spring_tangent(*p.spring, excess, step, start, w), spring.at(w));
  if (has_soft_limit(p) && !step.in(Kick::kSecond)) {
    compare(limit_tangent(*p.limits, limit_excess, step, start, w), limit.at(w));
    compare(limit_damper_tangent(*p.limits, step, start, w),
            limit_damper_tangent(*p.limits, step, start, tangents.rate).at(w));
  }
  if (p.spring && p.spring->damping_table && (!step.in(Kick::kSecond) || implicit_damping)) {
    const Curve& table = *p.spring->damping_table;
    compare(damper_tangent(table, step, start, w), damper_tangent(table, step, start, tangents.rate).at(w));
  }
  return off <= tangent_tolerance(size, rate_tolerance, start.effective_mass);
}

/// Newton's method for the impulses of tables and soft limits, which fall with the rate: if a solution with
/// tangents lies to the right of where they touch, the one sought does, too, as far as the row by itself
/// goes.
bool AxisSpringLaw::move(const AxisProperties& p, const AxisStep& step, const AxisStart& start, double w,
                         double rate_tolerance) {
  if (!is_curved(p) || are_tangents_right(p, step, start, w, rate_tolerance)) return false;
  tangents.move(w, rate_tolerance);
  return true;
}

}  // namespace taut
