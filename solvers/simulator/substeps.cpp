#include "solvers/simulator/substeps.h"

#include <algorithm>
#include <cmath>

namespace taut {
namespace {

/// A sub-step that failed is followed by one this much shorter; each success lets the next grow again.
constexpr double kShrink = 0.5, kGrow = 1.5;

}  // namespace

double Substeps::next(double step_limit) {
  const double longest = std::max(std::min({even_length_, step_limit, limit_}), smallest_);
  count_ = std::max(1.0, std::ceil(remaining_ / longest - kCountRoundOff));
  even_ = remaining_ / count_;
  h_ = event_ > 0 ? event_ : even_;
  event_ = 0;
  return h_;
}

void Substeps::accept() {
  remaining_ = count_ > 1 || h_ < even_ ? remaining_ - h_ : 0;
  limit_ *= kGrow;
}

void Substeps::shorten(double step_limit) { limit_ = std::min(kShrink * even_, step_limit); }

}  // namespace taut
