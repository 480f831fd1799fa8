#include "solvers/laws/contact_spring.h"

#include <algorithm>

namespace taut {
namespace {

struct ContactSpringTuning {
  /// δ of (solvers/laws, Eq. 8) where the step resolves the spring: a face on a face then has one division of
  /// its second kick for speeds that differ by round-off.  Chosen.
  static constexpr double kGivingWay = 0.1;
  /// Largest damping ratio below critical damping whose e is computed, and bisections for the ratio of an e:
  /// to round-off.
  static constexpr double kMostDamping = 1 - 1e-12;
  static constexpr int kBisections = 50;
};

/// e of a spring and damper of this ratio to critical damping, let go where its force is 0.
double restitution_of(double ratio) {
  const double root = std::sqrt(1 - ratio * ratio);
  return std::exp(-ratio / root * std::atan2(2 * ratio * root, 2 * ratio * ratio - 1));
}

/// The inverse of that, at most critical damping, of which e = e⁻².
double damping_ratio(double restitution) {
  double low = 0, high = ContactSpringTuning::kMostDamping;
  if (restitution <= restitution_of(high)) return 1;
  for (int i = 0; i < ContactSpringTuning::kBisections; ++i) {
    const double middle = 0.5 * (low + high);
    (restitution_of(middle) > restitution ? low : high) = middle;
  }
  return low;
}

}  // namespace

ContactConstraints::NormalLaw ContactSpring::position_law(double gap, double restitution) const {
  const double damping = damping_ratio(restitution);
  const double a = gap >= 0 ? h : 0.5 * h + damping * std::max(2 * period(), 0.5 * h);
  return {.target = std::clamp(-gap / a, -kUnreachedRate, kUnreachedRate),
          .softness = 2 * compliance / (h * a)};
}

ContactConstraints::NormalLaw ContactSpring::velocity_law(double gap, double approach, double back,
                                                          double restitution) const {
  const double pressed = std::max(-gap, 2 * compliance * back / h);
  const double rebound = std::max(-restitution * approach, approach);
  const double delta = impact_is_seen() ? ContactSpringTuning::kGivingWay : 1,
               softness = delta * compliance / (h * period());
  return {.target = std::max(0.0, rebound) + std::max(0.0, pressed) / period() - softness * back,
          .softness = softness,
          .most = 2 * back};
}

}  // namespace taut
