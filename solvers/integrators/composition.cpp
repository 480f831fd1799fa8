#include "solvers/integrators/composition.h"

#include <algorithm>
#include <cmath>

namespace taut {
namespace {

// Order 4, 5 stages [Suzuki1990]: α = 1 / (4 − 4^{1/3}).
constexpr double kS = 0.41449077179437573714;
constexpr double kOrder4[] = {kS, kS, 1 - 4 * kS, kS, kS};

// Order 6, 9 stages, and order 8, 17 stages [KahanLi1997].
constexpr double kOrder6[] = {
    0.39216144400731413927925056,  0.33259913678935943859974864, -0.70624617255763935980996482,
    0.08221359629355080023149045,  0.79854399093482996339895035, 0.08221359629355080023149045,
    -0.70624617255763935980996482, 0.33259913678935943859974864, 0.39216144400731413927925056};
constexpr double kOrder8[] = {
    0.13020248308889008087881763,  0.56116298177510838456196441,  -0.38947496264484728640807860,
    0.15884190655515560089621075,  -0.39590389413323757733623154, 0.18453964097831570709183254,
    0.25837438768632204729397911,  0.29501172360931029887096624,  -0.60550853383003451169892108,
    0.29501172360931029887096624,  0.25837438768632204729397911,  0.18453964097831570709183254,
    -0.39590389413323757733623154, 0.15884190655515560089621075,  -0.38947496264484728640807860,
    0.56116298177510838456196441,  0.13020248308889008087881763};

constexpr double kWhole[] = {1};

std::span<const double> fractions_of(Integrator integrator) {
  switch (integrator) {
    case Integrator::kRattle4:
      return kOrder4;
    case Integrator::kRattle6:
      return kOrder6;
    case Integrator::kRattle8:
      return kOrder8;
    default:
      return kWhole;
  }
}

}  // namespace

Composition::Composition(Integrator integrator) : fractions_(fractions_of(integrator)) {
  for (double fraction : fractions_) longest_ = std::max(longest_, std::abs(fraction));
}

void Composition::begin(const Scheme& scheme, double h) {
  left_ = fractions_;
  h_ = h;
  if (fractions_.size() == 1) return;
  before_ = scheme.state();
  impulses_before_.assign(scheme.impulses().begin(), scheme.impulses().end());
}

double Composition::next() {
  const double fraction = left_.front();
  left_ = left_.subspan(1);
  return fraction * h_;
}

void Composition::give_up(Scheme& scheme, SubstepReport& report) {
  left_ = {};
  if (fractions_.size() > 1) scheme.go_back(before_, impulses_before_, report);
}

}  // namespace taut
