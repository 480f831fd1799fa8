#include "scenes/accuracy/contact_truths.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/clock.h"
#include "core/world/diagnostics.h"
#include "scenes/support/format.h"

namespace taut::reference {
namespace {

constexpr double kTruthStep = 1e-3;  ///< for which Truth::allowed is [s]
/// Errors below it have no order: it is that of gaps and impact times (Settings::position_tolerance).
constexpr double kNoOrderBelow = 1e-9;
/// Laws are met to 1e-8 of the largest impulse, so that no work is known better than to that part.
constexpr double kLawRoundOff = 1e-8;

Settings on_one_thread(Settings settings) {
  settings.threads = 1;
  return settings;
}

TruthResult judge_work(const char* what, const std::vector<double>& steps, const std::vector<LawRecord>& laws,
                       WorstStep LawRecord::*of) {
  std::vector<double> measured;
  std::size_t worst = 0;
  for (std::size_t i = 0; i < laws.size(); ++i) {
    measured.push_back((laws[i].*of).work);
    if (measured[i] > measured[worst]) worst = i;
  }
  TruthResult result = judge(
      {.what = what, .source = "never positive", .comparison = Comparison::kAtMost, .allowed = kLawRoundOff},
      steps, measured);
  result.note = format("worst in the step to %g s at %g ms", (laws[worst].*of).time, 1e3 * steps[worst]);
  return result;
}

/// What holds in every run, whatever it is about.
std::vector<TruthResult> judge_laws(const std::vector<double>& steps, const std::vector<LawRecord>& laws) {
  std::vector<double> inexact;
  for (const LawRecord& law : laws) inexact.push_back(static_cast<double>(law.inexact));
  return {judge_work("work of contacts, most in a step, over E0", steps, laws, &LawRecord::contacts),
          judge_work("work of contacts and friction, most in a step, over E0", steps, laws,
                     &LawRecord::with_friction),
          judge({.what = "steps that were inexact", .source = "none", .comparison = Comparison::kAtMost},
                steps, inexact)};
}

}  // namespace

ContactCourse::ContactCourse(World world, double dt, LawRecord& laws, Settings settings)
    : world_(std::move(world)),
      dt_(dt),
      laws_(laws),
      start_(total_energy(world_, world_.state())),
      scale_(std::max(std::abs(start_), kinetic_energy(world_, world_.state()))),
      simulator_(world_, on_one_thread(settings)) {}

double ContactCourse::drift() const { return total_energy(world_, world_.state()) / start_ - 1; }

bool ContactCourse::run(double time, const std::function<bool()>& each) {
  const auto take = [&](double work, WorstStep& worst) {
    if (!(work / scale_ <= worst.work)) worst = {work / scale_ + 0.0, world_.time()};  // no −0
  };
  while (world_.time() < time * (1 - 1e-12)) {
    const StepReport& report = simulator_.step(dt_);
    if (!report.ok()) {
      laws_.failed = format("step to t = %g s: %s: ", world_.time() + dt_,
                            std::string(to_string(report.status)).c_str()) +
                     report.message;
      return false;
    }
    ++laws_.steps;
    laws_.inexact += !report.exact();
    take(report.ledger.contacts, laws_.contacts);
    take(report.ledger.contacts + report.ledger.friction, laws_.with_friction);
    if (each && !each()) return true;
  }
  return true;
}

Truth energy_stays(const char* source, double allowed, int power, double order) {
  return {.what = "|E/E0 - 1|, largest at any time",
          .source = source,
          .allowed = allowed,
          .power = power,
          .order = order};
}

Truth energy_never_grows(const char* source, double allowed, int power) {
  return {.what = "E/E0 - 1, largest at any time",
          .source = source,
          .comparison = Comparison::kAtMost,
          .allowed = allowed,
          .power = power};
}

TruthResult judge(const Truth& truth, const std::vector<double>& steps, const std::vector<double>& measured) {
  TruthResult result{.truth = truth, .measured = measured};
  const bool converges = truth.comparison == Comparison::kConverges;
  bool good = true;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    result.allowed.push_back(truth.allowed * std::pow(steps[i] / kTruthStep, truth.power));
    double error = measured[i] - truth.value;
    if (truth.comparison == Comparison::kNear) error = std::abs(error);
    if (converges) error = i == 0 ? 0 : std::abs(measured[i] - measured[i - 1]);
    result.error.push_back(error);
    good = good && error <= result.allowed.back();  // false for what is not a number
  }
  const std::size_t n = steps.size(), needed = converges ? 3 : 2;
  result.order = std::numeric_limits<double>::quiet_NaN();
  if (n >= needed && truth.comparison != Comparison::kAtMost) {
    const double before = result.error[n - 2], last = result.error[n - 1];
    if (before > kNoOrderBelow && last > 0)
      result.order = std::log(before / last) / std::log(steps[n - 2] / steps[n - 1]);
    if (truth.order > 0 && last > kNoOrderBelow) good = good && result.order >= truth.order;
  }
  result.verdict = good ? Verdict::kPass : Verdict::kFail;
  return result;
}

ContactResult run_contact_case(const ContactCase& wanted) {
  const auto start = Clock::now();
  ContactResult result{.name = wanted.name, .what = wanted.what, .steps = wanted.steps};
  std::vector<std::vector<double>> measured(wanted.truths.size());
  for (const double dt : result.steps) {
    const std::vector<double> values = wanted.measure(dt, result.laws.emplace_back());
    for (std::size_t i = 0; i < measured.size(); ++i) measured[i].push_back(values.at(i));
  }
  for (std::size_t i = 0; i < measured.size(); ++i)
    result.truths.push_back(judge(wanted.truths[i], result.steps, measured[i]));
  for (TruthResult& law : judge_laws(result.steps, result.laws)) result.truths.push_back(std::move(law));
  result.wall_time = seconds_since(start);
  return result;
}

bool ContactResult::good() const {
  return std::all_of(truths.begin(), truths.end(),
                     [](const TruthResult& truth) { return truth.verdict == Verdict::kPass; }) &&
         std::all_of(laws.begin(), laws.end(), [](const LawRecord& law) { return law.failed.empty(); });
}

std::vector<ContactCase> contact_cases() {
  std::vector<ContactCase> cases = impact_cases();
  for (auto part : {rolling_cases, friction_cases})
    for (ContactCase& more : part()) cases.push_back(std::move(more));
  return cases;
}

}  // namespace taut::reference
