#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "core/axes/axis.h"
#include "core/base/check.h"

namespace taut {

/// The monotone relation between the rate w of a row [m/s or rad/s] and its impulse λ [N·s or N·m·s]: a
/// descending staircase of K steps with a slope c ≥ 0,
///
///     λ ∈ L(w) − c w,    L(w) = l_k for w_k < w < w_{k+1},    L(w_k) = [l_k, l_{k−1}],
///
/// with breakpoints w_1 < … < w_K and levels l_0 > … > l_K, where l_0 = +∞ forbids w < w_1 and l_K = −∞
/// forbids w > w_K.  (solvers/laws, "Row laws")
///
/// Its segments are numbered from left to right, 0 … 2K: segment 2k is level k, segment 2k − 1 is the
/// vertical at w_k.
struct RowLaw {
  static constexpr int kMaxSteps = kMostAxisJumps;  ///< no other row has more
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  int steps = 0;                              ///< K
  double slope = 0;                           ///< c [impulse per rate]
  std::array<double, kMaxSteps> at{};         ///< at[k − 1] = w_k
  std::array<double, kMaxSteps + 1> level{};  ///< level[k] = l_k

  /// λ = 0 whatever w.
  static RowLaw none() { return {}; }
  /// λ = level whatever w.
  static RowLaw constant(double level) {
    RowLaw law;
    law.level[0] = level;
    return law;
  }
  /// w imposed, any λ.
  static RowLaw equality(double w = 0) { return step(w, kInfinity, -kInfinity); }
  /// w ≥ bound, λ ≥ 0, and one of them exact.
  static RowLaw lower_limit(double bound) { return step(bound, kInfinity, 0); }
  /// w ≤ bound, λ ≤ 0, and one of them exact.
  static RowLaw upper_limit(double bound) { return step(bound, 0, -kInfinity); }
  /// lo ≤ λ ≤ hi: λ = hi below the rate `w`, lo above it.  Coulomb friction, or a motor with that target.
  /// @throws std::invalid_argument if not lo < hi.
  static RowLaw box(double lo, double hi, double w = 0) {
    if (!(lo < hi)) fail("row law box", "must have lo < hi", hi - lo);
    return step(w, hi, lo);
  }
  /// λ = −c w.  @throws std::invalid_argument if c is negative or not finite.
  static RowLaw viscous(double c) {
    require_not_negative("row law slope", c);
    RowLaw law;
    law.slope = c;
    return law;
  }

  /// A law with one step at w acts on the same axis, too: `above` left of w, `below` right of it.
  /// @throws std::invalid_argument if no rate is allowed by both, or for more than kMaxSteps steps.
  void add_step(double w, double above, double below);
  /// Both laws act on one axis: the sum of the graphs.  @throws as add_step(), or if b has more steps than
  /// one.
  friend RowLaw operator+(const RowLaw& a, const RowLaw& b);

  int segments() const { return 2 * steps + 1; }
  static bool is_vertical(int segment) { return segment % 2 == 1; }
  /// Rate of a vertical segment.
  double rate(int segment) const { return at[segment / 2]; }
  /// Level of a segment that is one.
  double force(int segment) const { return level[segment / 2]; }
  /// False for l_0 = +∞ and l_K = −∞, whose segments are no places to be.
  bool exists(int segment) const { return is_vertical(segment) || std::isfinite(force(segment)); }
  /// The values [low, high] of λ + c w on a vertical segment.
  double low(int segment) const { return level[segment / 2 + 1]; }
  double high(int segment) const { return level[segment / 2]; }
  /// The range [first, last] of w on a level.
  double first(int segment) const { return segment == 0 ? -kInfinity : at[segment / 2 - 1]; }
  double last(int segment) const { return segment == 2 * steps ? kInfinity : at[segment / 2]; }
  /// λ + c w at the rate w, where that is one value.
  double level_at(double w) const {
    int k = 0;
    while (k < steps && w > at[k]) ++k;
    return level[k];
  }
  /// True if some λ + c w is out of bounds: not an equality.
  bool bounded() const { return !(steps == 1 && std::isinf(level[0]) && std::isinf(level[1])); }

  /// The one point of the graph that a row by itself would take: λ and w with w = s λ + β, s > 0.
  struct Point {
    int segment;
    double lambda, w;
  };
  Point resolve(double s, double beta) const {
    for (int k = 1; k <= steps; ++k) {
      const double lambda = (at[k - 1] - beta) / s, value = lambda + slope * at[k - 1];
      if (value > level[k - 1]) return on_level(k - 1, s, beta);
      if (value >= level[k]) return {2 * k - 1, lambda, at[k - 1]};
    }
    return on_level(steps, s, beta);
  }
  /// λ* that the row by itself answers to λ and w = s λ + β (natural_residual.h).
  double project(double s, double lambda, double w) const { return resolve(s, w - s * lambda).lambda; }

  /// The segment on which λ = `lambda` lies; corners count as levels.
  int segment_at(double lambda) const {
    for (int k = 1; k <= steps; ++k) {
      const double value = lambda + slope * at[k - 1];
      if (value >= level[k - 1]) return 2 * (k - 1);
      if (value > level[k]) return 2 * k - 1;
    }
    return 2 * steps;
  }
  /// A rate at which λ = `lambda`; −∞ above and +∞ below all of the graph.
  double rate_at(double lambda) const {
    for (int k = 1; k <= steps; ++k) {
      const double value = lambda + slope * at[k - 1];
      if (value > level[k - 1]) return rate_on_level(k - 1, lambda);
      if (value >= level[k]) return at[k - 1];
    }
    return rate_on_level(steps, lambda);
  }

 private:
  void insert_step(int left, double w);
  void leave_out_forbidden();
  double rate_on_level(int k, double lambda) const {
    if (slope > 0) return (level[k] - lambda) / slope;
    return lambda > level[k] ? -kInfinity : kInfinity;
  }
  static RowLaw step(double w, double above, double below) {
    RowLaw law;
    law.steps = 1;
    law.at[0] = w;
    law.level[0] = above;
    law.level[1] = below;
    return law;
  }
  Point on_level(int k, double s, double beta) const {
    const double w = (beta + s * level[k]) / (1 + s * slope);
    return {2 * k, level[k] - slope * w, w};
  }
};

inline void RowLaw::add_step(double w, double above, double below) {
  int left = 0;  // steps left of w
  while (left < steps && at[left] < w) ++left;
  if (left == steps || at[left] != w) insert_step(left, w);
  for (int k = 0; k <= steps; ++k) level[k] += k <= left ? above : below;
  // +∞ − ∞: left of one lower limit and right of the other upper limit at once.
  for (int k = 0; k <= steps; ++k)
    if (std::isnan(level[k])) fail("row law sum", "limits exclude each other at rate", w);
  leave_out_forbidden();
}

/// A step of no height at w, right of so many.
inline void RowLaw::insert_step(int left, double w) {
  if (steps == kMaxSteps) fail("row law sum", "must not have more steps than", kMaxSteps);
  for (int k = steps++; k > left; --k) at[k] = at[k - 1];
  for (int k = steps; k > left; --k) level[k] = level[k - 1];
  at[left] = w;
}

/// Only levels right of a lower and left of an upper limit are places to be.
inline void RowLaw::leave_out_forbidden() {
  int first = 0, last = 0;
  while (first < steps && level[first + 1] == kInfinity) ++first;
  for (int k = first + 1; k <= steps; ++k)
    if (level[k - 1] != -kInfinity) last = k;
  last = std::max(first, last);
  for (int k = first; first > 0 && k <= last; ++k) {
    level[k - first] = level[k];
    if (k < last) at[k - first] = at[k];
  }
  steps = last - first;
}

inline RowLaw operator+(const RowLaw& a, const RowLaw& b) {
  if (b.steps > 1) fail("row law sum", "must add one step at a time, not", b.steps);
  RowLaw sum = a;
  sum.slope += b.slope;
  if (b.steps == 1)
    sum.add_step(b.at[0], b.level[0], b.level[1]);
  else
    for (int k = 0; k <= sum.steps; ++k) sum.level[k] += b.level[0];
  return sum;
}

}  // namespace taut
