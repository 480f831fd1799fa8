#pragma once

#include <cmath>

#include "solvers/complementarity/contact_newton_tuning.h"

namespace taut {

/// How far to go along a Newton step: to where the slope along it, `start` < 0 where it begins, is about 0.
/// The whole step, if the slope is small or negative at its end; else by the Illinois method.
class SlopeSearch {
 public:
  explicit SlopeSearch(double start) : enough_(-Tuning::kSlope * start), slope_low_(start) {}

  /// The length to be tried, in steps; at the end the one that is taken.
  double length() const { return length_; }
  /// True if another length is to be tried, since the slope at this one is not good enough.
  bool goes_on(double slope) {
    if (trials_++ == 0)
      slope_high_ = slope;
    else if (std::abs(slope) <= enough_)
      return false;
    else
      narrow(slope);
    if (trials_ > Tuning::kSearches || !(slope_high_ > enough_)) return false;
    length_ = low_ + (high_ - low_) * slope_low_ / (slope_low_ - slope_high_);
    return true;
  }

 private:
  using Tuning = ContactNewtonTuning;

  /// An end that stays counts half.
  void narrow(double slope) {
    const bool is_high = slope > 0;
    (is_high ? high_ : low_) = length_;
    (is_high ? slope_high_ : slope_low_) = slope;
    if (is_high == last_was_high_) (is_high ? slope_low_ : slope_high_) *= 0.5;
    last_was_high_ = is_high;
  }

  double enough_;
  double low_ = 0, slope_low_, high_ = 1, slope_high_ = 0;  // the ends between which it is
  double length_ = 1;
  bool last_was_high_ = true;
  int trials_ = 0;
};

}  // namespace taut
