#pragma once

#include <span>
#include <vector>

#include "solvers/common/axis_report.h"
#include "solvers/laws/axes/axis_law.h"
#include "solvers/laws/axes/axis_table.h"

namespace taut {

class Archive;

/// What acted along each axis and the work that it did, summed over the sub-steps of a step, with impulses in
/// place of mean forces.
class AxisWork {
 public:
  explicit AxisWork(std::size_t axes);

  void clear();
  /// A sub-step begins; roll_back() takes back what is added from then on.
  void begin();
  void roll_back();
  /// Impulses λ of the first kick, during which the axes moved with `rates` on the mean, by the laws of its
  /// rates w: added with the second.
  void record_first_kick(const AxisTable& table, std::span<const AxisLaw> axes,
                         std::span<const double> lambda, std::span<const double> w,
                         std::span<const double> rates);
  /// There is none.
  void clear_first_kick();
  /// Impulses μ of the second kick so far, before impacts at its end or after a round of them, of which what
  /// is new acted with `rates` on the mean.
  void record_second_kick(const AxisTable& table, std::span<const AxisLaw> axes, std::span<const double> mu,
                          std::span<const double> w, std::span<const double> rates);
  const AxisImpulse& first_kick(std::size_t i) const { return first_kick_[i].force; }
  /// Of both kicks of the last sub-step.
  const AxisImpulse& impulse(std::size_t i) const { return impulse_[i]; }
  /// Adds both kicks, the second with these impulses, of which what was not recorded yet acted with `rates`.
  void add_kicks(const AxisTable& table, std::span<const AxisLaw> axes, std::span<const double> lambda,
                 std::span<const double> w, std::span<const double> rates);

  const std::vector<AxisReport>& reports() const { return reports_; }
  std::span<AxisReport> reports() { return reports_; }

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive);

 private:
  std::vector<AxisReport> reports_, reports_before_, first_kick_, second_kick_;
  std::vector<AxisImpulse> impulse_;
};

}  // namespace taut
