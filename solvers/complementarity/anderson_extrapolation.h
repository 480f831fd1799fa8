#pragma once

#include <Eigen/Core>

#include "solvers/complementarity/contact_newton_tuning.h"

namespace taut {

/// Anderson's extrapolation of a fixed-point iteration s ← s + f(s) [Walker2011]: the next s is the
/// combination of the last rounds, with weights that sum to 1, that leaves the least |f|.  Without it each
/// round leaves some part of its error.
class AndersonExtrapolation {
 public:
  /// For s ∈ ℝⁿ; forgets all.
  void begin(int n);
  /// The next round is the first that is remembered.
  void forget() { remembered_ = 0; }
  /// The next s from s and f, where `mixing` of f is added.
  const Eigen::VectorXd& extrapolate(const Eigen::VectorXd& s, const Eigen::VectorXd& f, double mixing);

 private:
  using Tuning = ContactNewtonTuning;

  void subtract_combination(const Eigen::VectorXd& f, double mixing);

  Eigen::VectorXd last_s_, last_f_, next_;  // of the round before
  Eigen::MatrixXd steps_, changes_;         // differences of s and of f between rounds, a column each
  int remembered_ = 0;                      // rounds
};

}  // namespace taut
