#include <algorithm>
#include <numeric>

#include "solvers/constraint_system.h"
#include "solvers/max_abs.h"

// Solves of a ConstraintSystem whose rows depend on each other.  (solvers/README, "Rank")
namespace taut {
namespace {

constexpr int kMaxPasses = 6;
/// Of conjugate gradients: directions with σ below a tenth of the shift are left to fixed-point passes.
constexpr double kLongestStep = 10;

double dot(std::span<const double> a, std::span<const double> b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

}  // namespace

/// (S + Σ) x on the rows that are not masked, 0 on the others.
void ConstraintSystem::multiply_factored(std::span<const double> x, std::span<double> out) {
  multiply(x, out);
  const std::span<const double> states = factored_states_;
  for (std::size_t r = 0; r < states.size(); ++r)
    out[r] = states[r] == kMasked ? 0 : out[r] + states[r] * x[r];
}

void ConstraintSystem::project(std::span<double> x) {
  multiply_factored(x, scratch_);
  std::copy(scratch_.begin(), scratch_.end(), x.begin());
  backsolve(x);
}

/// The spectrum of S_ε⁻¹ S is σ/(σ + ε): one, but for the few directions that rows hold about as weakly as
/// the shift does.  Fixed-point passes leave ε/(σ + ε) of each, and of one such direction again and again;
/// conjugate gradients learn them.
///
/// What round-off adds outside the range of S counts in r·z, magnified by 1/ε, but not in p·S p: a step by
/// their ratio may be of any length.  Where it is long a fixed-point pass does instead.
void ConstraintSystem::solve_in_range(std::span<double> x, double tolerance) {
  if (!shifted_ || !usable_) return backsolve(x);
  const std::size_t n = x.size();
  std::span<double> rest = scratch_, z = preconditioned_, p = direction_, q = image_;
  std::copy(x.begin(), x.end(), rest.begin());
  std::fill(x.begin(), x.end(), 0.0);
  double last = 0, before = max_abs(rest);
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    std::copy(rest.begin(), rest.end(), z.begin());
    backsolve(z);
    const double now = dot(rest, z), beta = last > 0 ? now / last : 0;
    if (!(now > 0)) return;
    for (std::size_t r = 0; r < n; ++r) p[r] = z[r] + beta * p[r];
    multiply_factored(p, q);
    double alpha = now / dot(p, q);
    last = now;
    if (!(alpha > 0 && alpha < kLongestStep)) {
      std::copy(z.begin(), z.end(), p.begin());
      multiply_factored(p, q);
      alpha = 1;
      last = 0;
    }
    for (std::size_t r = 0; r < n; ++r) x[r] += alpha * p[r];
    for (std::size_t r = 0; r < n; ++r) rest[r] -= alpha * q[r];
    const double left = max_abs(rest);
    const bool stuck = last == 0 && !(left < 0.5 * before);  // rates that exclude each other
    if (left <= tolerance || stuck) return;
    before = left;
  }
}

}  // namespace taut
