#pragma once

#include <algorithm>

#include "solvers/common/step_report.h"

namespace taut {

/// The residuals that the stages of one advance ended with: the natural one of all, and of those that were
/// taken although they missed 1e-8 that which they were taken with.
class StageAccuracy {
 public:
  /// Forgets what stages of this advance ended with.
  void begin_pass() { worst_inexact_ = natural_ = 0; }
  /// The present stage was taken with this residual; 0: it was met.
  void take(double inexact) { inexact_ = inexact; }
  /// The present stage was taken although it was not met.
  bool is_inexact() const { return inexact_ > 0; }
  /// It misses its laws by more than all before.
  bool is_worst() const { return inexact_ > worst_inexact_; }
  /// It is done.
  void finish() { worst_inexact_ = std::max(worst_inexact_, inexact_); }
  void note_natural(double residual) { natural_ = std::max(natural_, residual); }
  /// The largest natural residual.
  double natural() const { return natural_; }
  /// For a sub-step that is kept.  True if it was inexact.
  bool report(SubstepReport& report) const {
    report.natural_residual = natural_;
    if (worst_inexact_ == 0) return false;
    report.status = Status::kInexact;
    report.complementarity_residual = worst_inexact_;
    return true;
  }

 private:
  double inexact_ = 0;        // of the present stage
  double worst_inexact_ = 0;  // in this advance
  double natural_ = 0;
};

}  // namespace taut
