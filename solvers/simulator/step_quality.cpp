#include "solvers/simulator/step_quality.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace taut {
namespace {

void count_contacts(std::span<const ContactCache::Slot> slots, StepReport& report) {
  for (const ContactCache::Slot& slot : slots) {
    if (!slot.active) continue;
    ++report.contacts;
    report.penetration = std::max(report.penetration, -slot.contact.gap);
  }
}

void name_dependent_rows(const ConstraintSystem& system, StepReport& report) {
  const Rows& rows = system.rows();
  if (!system.dependent_rows().empty()) report.dependent_rows.reserve(rows.row_count());  // once
  for (int row : system.dependent_rows()) {
    if (const std::optional<JointId> joint = rows.joint_of(row))
      report.dependent_rows.push_back({*joint, row - rows.joints()[rows.row(row).block].first_row});
  }
  std::sort(report.dependent_rows.begin(), report.dependent_rows.end());
}

}  // namespace

Gap wider(const Gap& a, const Gap& b) {
  // Written so that a NaN in either stays.
  const auto worse = [](double x, double y) { return x >= y || std::isnan(x) ? x : y; };
  return {worse(a.metres, b.metres), worse(a.radians, b.radians)};
}

void StepQuality::renew(int row_count) {
  phi_.assign(row_count, 0.0);
  rates_.assign(row_count, 0.0);
}

std::span<const double> StepQuality::residual(const Rows& rows, const State& state) {
  phi_.resize(rows.row_count());  // contacts may have been found since
  rows.residual(state, phi_);
  return phi_;
}

Gap StepQuality::gap(const Stepper& stepper, std::span<const double> phi) {
  const Gap joints = max_gap(stepper.system().rows(), phi);
  return wider(joints, stepper.scheme().axes().beyond_limits(phi));
}

void StepQuality::measure(Stepper& stepper, StepReport& report) {
  for (auto* values : {&phi_, &rates_}) values->resize(stepper.system().row_count());
  report.gap = gap_at_end(stepper);
  if (!stepper.scheme().closes_joints())
    report.velocity_residual = std::max(report.velocity_residual, velocity_residual(stepper));
  count_contacts(stepper.slots(), report);
  report.rank_deficiency = stepper.system().rank_deficiency();
  name_dependent_rows(stepper.system(), report);
  report.natural_residual = std::max(report.natural_residual, report.complementarity_residual);
  report.condition_estimate = stepper.system().condition_estimate();
}

Gap StepQuality::gap_at_end(const Stepper& stepper) {
  const Rows& rows = stepper.system().rows();
  if (const auto known = stepper.scheme().known_residual(); !known.empty()) return max_gap(rows, known);
  rows.residual(stepper.state(), phi_);
  stepper.scheme().breaking().clear_rows(phi_);
  return gap(stepper, phi_);
}

/// max |J V + φ_t| of a scheme that closes no velocities.
double StepQuality::velocity_residual(Stepper& stepper) {
  ConstraintSystem& system = stepper.system();
  const State& state = stepper.state();
  system.linearize(state);
  system.rates_of(state, rates_);
  double largest = 0;
  for (double rate : rates_) largest = std::max(largest, std::abs(rate));
  return largest;
}

}  // namespace taut
