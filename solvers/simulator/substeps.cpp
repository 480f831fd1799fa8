#include "solvers/simulator/substeps.h"

#include <algorithm>
#include <cmath>

#include "solvers/simulator/substep_tuning.h"

namespace taut {

double Substeps::next(double step_limit) {
  const double longest = std::max(std::min({even_length_, step_limit, limit_}), smallest_);
  count_ = std::max(1.0, std::ceil(remaining_ / longest - SubstepTuning::kCountRoundOff));
  even_ = remaining_ / count_;
  h_ = event_ > 0 ? event_ : even_;
  event_ = 0;
  return h_;
}

void Substeps::accept() {
  remaining_ = count_ > 1 || h_ < even_ ? remaining_ - h_ : 0;
  limit_ *= SubstepTuning::kGrow;
}

void Substeps::shorten(double step_limit) { limit_ = std::min(SubstepTuning::kShrink * even_, step_limit); }

}  // namespace taut
