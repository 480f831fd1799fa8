#include "scenes/accuracy/reference_run.h"

#include <algorithm>
#include <cmath>

#include "core/base/clock.h"
#include "scenes/accuracy/reference_session.h"

namespace taut::reference {
namespace {

/// Everything not measured for one reason.
void give_up(CaseRun& result, const std::string& reason) {
  for (Measurement& quantity : result.quantities)
    if (quantity.verdict == Verdict::kNotMeasured) quantity.reason = reason;
}

/// What could not be measured because a step failed has failed.
void blame_the_step(const Case& reference, CaseRun& result) {
  for (std::size_t i = 0; i < result.quantities.size(); ++i) {
    Measurement& quantity = result.quantities[i];
    if (!quantity.measured.empty() || !reference.quantities[i].binding() || !quantity.reason.empty())
      continue;
    quantity.verdict = Verdict::kFail;
    quantity.reason = result.failed;
  }
}

}  // namespace

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::kPass:
      return "pass";
    case Verdict::kFail:
      return "FAIL";
    case Verdict::kNotMeasured:
      return "not measured";
    case Verdict::kOrientation:
      return "for orientation";
  }
  return "";
}

int CaseRun::count(Verdict verdict) const {
  return static_cast<int>(std::count_if(quantities.begin(), quantities.end(),
                                        [=](const Measurement& m) { return m.verdict == verdict; }));
}

Integrator integrator_for(const Case& reference) {
  return reference.has_axis_properties() || !reference.pairs.empty() ? Integrator::kRattle
                                                                     : Integrator::kRattle4;
}

double allowed_error(const Case& reference, const Quantity& quantity, const RunPlan& plan) {
  if (plan.limit) return quantity.uncertainty + quantity.tolerance_limit;
  const int power = reference.level == "smooth" ? 2 : reference.level == "nonsmooth" ? 1 : 0;
  return quantity.uncertainty +
         std::max(quantity.tolerance_limit, quantity.tolerance * std::pow(plan.step, power));
}

CaseRun run_case(const std::filesystem::path& file, const RunPlan& wanted) {
  const auto start = Clock::now();
  Case reference = load_case(file);
  RunPlan plan = wanted;
  if (plan.choose_integrator) plan.settings.integrator = integrator_for(reference);
  CaseRun result{.id = reference.id, .level = reference.level, .integrator = plan.settings.integrator};
  result.fraction = plan.step;
  result.dt = plan.step * reference.dt;
  for (const Quantity& quantity : reference.quantities)
    result.quantities.push_back(
        {.name = quantity.name,
         .time = quantity.time,
         .verdict = quantity.binding() ? Verdict::kNotMeasured : Verdict::kOrientation,
         .reference = quantity.value});
  if (!reference.missing.empty())
    give_up(result, reference.missing.front());
  else if (reference.level == "frequency")
    run_frequency(reference, plan, result);
  else
    Session(reference, plan, result).run();
  if (!result.failed.empty()) blame_the_step(reference, result);
  result.wall_time = seconds_since(start);
  return result;
}

}  // namespace taut::reference
