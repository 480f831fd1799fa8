#pragma once

#include <span>
#include <vector>

#include "solvers/complementarity/contact_newton_tuning.h"

namespace taut {

/// How ρ goes from round to round.  There is no function that rounds descend, but a Σ for which they end, as
/// a trust region has a radius: it grows after a round that did not, which is taken back, and falls again
/// after some that did.  (solvers/complementarity, Eq. 6)
class CoupledRounds {
 public:
  void reserve(std::size_t rows) { kept_.reserve(rows); }
  /// From impulses y with this residual.
  void begin(std::span<const double> y, double residual);
  /// True if the round that came to y is kept, after which ρ may fall; `met`: its Newton method ended.
  bool keep(std::span<const double> y, bool met, double residual, double& rho);
  /// After a round that is taken back: false if ρ can grow no more.
  bool grow(double& rho);
  /// True if they go well enough to go on, each time it is asked.
  bool progress();

  /// Impulses of the last round that was kept, and their residual.
  std::span<const double> kept() const { return kept_; }
  double kept_residual() const { return kept_residual_; }

 private:
  using Tuning = ContactNewtonTuning;

  std::vector<double> kept_;
  double kept_residual_ = 0, looked_residual_ = 0;  // and that of the last look at the progress
  int hold_ = 0, rounds_ = 0;  // rounds that are to go well before ρ falls again; rounds so far
};

}  // namespace taut
