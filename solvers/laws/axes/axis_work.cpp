#include "solvers/laws/axes/axis_work.h"

#include <algorithm>

namespace taut {
namespace {

/// Acts along axes that are released.
const AxisProperties kNothing;

/// Properties, impulse and rate, on the law, of an axis; one that is released has none of them.
struct AxisPoint {
  const AxisProperties& p;
  double w;
  AxisImpulse impulse;
};
AxisPoint point_of(const AxisTable& table, std::span<const AxisLaw> axes, std::size_t i,
                   std::span<const double> lambda, std::span<const double> w) {
  const int row = table.row(i);
  if (table.released(i)) return {kNothing, w[row], {}};
  const AxisProperties& p = table.properties(i);
  const double rate = axes[i].rate_of(p, lambda[row], w[row]);
  return {p, rate, axes[i].split(lambda[row], rate)};
}

/// Adds an impulse and its work at this mean rate.
void add_impulse(AxisReport& report, const AxisImpulse& impulse, double rate) {
  for (const auto& [part, column, term] : kAxisParts) {
    report.force.*part += impulse.*part;
    report.work.*part += impulse.*part * rate;
  }
}

}  // namespace

AxisWork::AxisWork(std::size_t axes)
    : reports_(axes), reports_before_(axes), first_kick_(axes), second_kick_(axes), impulse_(axes) {}

void AxisWork::begin() {
  reports_before_ = reports_;
  std::fill(second_kick_.begin(), second_kick_.end(), AxisReport{});
}

void AxisWork::roll_back() { reports_ = reports_before_; }

void AxisWork::clear() { std::fill(reports_.begin(), reports_.end(), AxisReport{}); }

void AxisWork::clear_first_kick() { std::fill(first_kick_.begin(), first_kick_.end(), AxisReport{}); }

void AxisWork::record_first_kick(const AxisTable& table, std::span<const AxisLaw> axes,
                                 std::span<const double> lambda, std::span<const double> w,
                                 std::span<const double> rates) {
  clear_first_kick();
  for (std::size_t i = 0; i < table.size(); ++i)
    add_impulse(first_kick_[i], point_of(table, axes, i, lambda, w).impulse, rates[table.row(i)]);
}

void AxisWork::record_second_kick(const AxisTable& table, std::span<const AxisLaw> axes,
                                  std::span<const double> mu, std::span<const double> w,
                                  std::span<const double> rates) {
  for (std::size_t i = 0; i < table.size(); ++i)
    add_impulse(second_kick_[i], point_of(table, axes, i, mu, w).impulse - second_kick_[i].force,
                rates[table.row(i)]);
}

void AxisWork::add_kicks(const AxisTable& table, std::span<const AxisLaw> axes,
                         std::span<const double> lambda, std::span<const double> w,
                         std::span<const double> rates) {
  for (std::size_t i = 0; i < table.size(); ++i) {
    AxisReport& report = reports_[i];
    for (const AxisReport* kick : {&first_kick_[i], &second_kick_[i]}) {
      report.force += kick->force;
      report.work += kick->work;
    }
    const AxisPoint second = point_of(table, axes, i, lambda, w);
    add_impulse(report, second.impulse - second_kick_[i].force, rates[table.row(i)]);
    impulse_[i] = first_kick_[i].force;
    impulse_[i] += second.impulse;
    axes[i].report(report, second.p, second.w);
  }
}

}  // namespace taut
