#pragma once

#include <limits>
#include <utility>

#include "solvers/friction/scaled_friction.h"

namespace taut {

struct BestImpulsesTuning {
  /// Fully: so many times better than what is wanted.  Chosen.
  static constexpr double kMargin = 100;
};

/// The impulses that are nearest to the laws of all that were tried, and what the trials cost.
class BestImpulses {
 public:
  /// `accuracy` is what is wanted of FrictionErrors.
  BestImpulses(const ScaledFriction& problem, double accuracy)
      : problem_(problem), accuracy_(accuracy), r_(Eigen::VectorXd::Zero(problem.rows())) {
    offer(r_);
  }

  /// By how much these are off, round-off apart; the best are kept.
  double offer(const Eigen::VectorXd& r) {
    if (!r.allFinite()) return std::numeric_limits<double>::infinity();
    const FrictionErrors errors = problem_.errors(r);
    const double off = errors.met(0) ? 0 : errors.largest();
    if (off < off_ || off_ == kNone) {
      r_ = r;
      errors_ = errors;
      off_ = off;
    }
    return off;
  }

  /// Met by more than enough: to a hundredth of what is wanted, so that what follows begins near.
  double fully() const { return accuracy_ / BestImpulsesTuning::kMargin; }
  bool met() const { return errors_.met(accuracy_); }
  double accuracy() const { return accuracy_; }
  double off() const { return off_; }
  const Eigen::VectorXd& r() const { return r_; }
  const FrictionErrors& errors() const { return errors_; }

  int factorisations = 0, sweeps = 0;

 private:
  static constexpr double kNone = std::numeric_limits<double>::infinity();

  const ScaledFriction& problem_;
  double accuracy_;
  Eigen::VectorXd r_;
  FrictionErrors errors_;
  double off_ = kNone;
};

}  // namespace taut
