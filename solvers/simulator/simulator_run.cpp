#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/world/applied_force.h"
#include "solvers/simulator/simulator_impl.h"
#include "solvers/simulator/step_quality.h"

// Forces for one step, and many steps in one call.
namespace taut {
namespace {

/// Chosen, where nothing else is said.
struct RunTuning {
  /// A last step shorter than this part of the others is added to the one before: what round-off makes of an
  /// interval that is a multiple of h is below, 1e-16 per step for up to 1e9 steps, and a step so much longer
  /// is none that a setting would tell from the others.
  static constexpr double kShortestStep = 1e-6;
  /// So many steps, and no more, are counted exactly, and end in a life time.
  static constexpr double kMostSteps = 1e12;
};

/// How many steps of h lead from one time to another.
std::int64_t steps_between(double from, double to, double h) {
  const double steps = (to - from) / h;
  if (steps > RunTuning::kMostSteps) fail("run_until h", "makes more than 1e12 steps", h);
  return to == from ? 0
                    : std::max<std::int64_t>(1, std::llround(std::ceil(steps - RunTuning::kShortestStep)));
}

}  // namespace

void Simulator::apply_force(BodyId body, const Wrench& wrench) {
  taut::apply_force(impl().source_, body, wrench);
}

void Simulator::apply_force(BodyId body, const Vec3& p_BP, const Vec3& force) {
  taut::apply_force(impl().source_, body, p_BP, force);
}

RunReport Simulator::run_until(double t, double h) {
  World& world = impl().source_;
  require_finite("run_until t", t);
  require_positive("run_until h", h);
  if (t < world.time()) fail("run_until t", "is before the time of the world", t);
  const std::int64_t count = steps_between(world.time(), t, h);
  RunReport run;
  run.last.time = t;
  for (std::int64_t i = 1; i <= count; ++i) {
    const StepReport& report = step(i < count ? h : t - world.time());
    const bool ends = std::any_of(report.events.begin(), report.events.end(),
                                  [](const EventRecord& event) { return event.ends_run; });
    if (!report.ok() || ends || i == count) run.last = report;
    if (!report.ok()) return run;
    ++run.steps;
    run.inexact_steps += !report.exact();
    run.gap = wider(run.gap, report.gap);
    run.penetration = std::max(run.penetration, report.penetration);
    run.natural_residual = std::max(run.natural_residual, report.natural_residual);
    if (ends) return run;
  }
  if (world.time() != t) world.set_time(t);  // where t − time rounds, as over zero
  run.last.time = t;
  return run;
}

}  // namespace taut
