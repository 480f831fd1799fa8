#pragma once

#include <cmath>

#include "solvers/complementarity/contact_newton_tuning.h"

namespace taut {

/// How far to go along a Newton step: to where the slope along it, `start` < 0 where it begins, is about 0.
/// The whole step, if the slope is small or negative at its end; else by the Illinois method.
class SlopeSearch {
 public:
  explicit SlopeSearch(double start) : enough_(-Tuning::kSlope * start), slope_{start, 0} {}

  /// The length to be tried, in steps; at the end the one that is taken.
  double length() const { return length_; }
  /// True if another length is to be tried, since the slope at this one is not good enough.
  bool goes_on(double slope) {
    const int end = trials_ == 0 || slope > 0;  // that moves
    if (trials_ > 0 && std::abs(slope) <= enough_) return false;
    if (trials_ > 0 && end == last_) slope_[1 - end] *= 0.5;  // the one that stays counts half
    at_[end] = length_;
    slope_[end] = slope;
    last_ = end;
    if (++trials_ > Tuning::kSearches || !(slope_[1] > enough_)) return false;
    length_ = at_[0] + (at_[1] - at_[0]) * slope_[0] / (slope_[0] - slope_[1]);
    return true;
  }

 private:
  using Tuning = ContactNewtonTuning;

  double enough_, slope_[2], at_[2] = {0, 1};  // of the two ends between which it is
  double length_ = 1;
  int last_ = 1, trials_ = 0;
};

}  // namespace taut
