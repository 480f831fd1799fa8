#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "solvers/laws/row_law.h"

namespace taut {

/// How far an impulse is from its law, the one measure of that: the distance to what the law by itself
/// answers to it and its rate, λ* = prox_S(λ − w/S) with S = S_rr.  0 where the law is met, and nowhere else.
/// How far motion is from it is motion_residual().  (solvers/complementarity, "Natural residual")
struct NaturalResidual {
  double size = 0;  ///< √S |λ − λ*| [√J]
  double rate = 0;  ///< (S + c) |λ − λ*|, by how much the rate is off [m/s or rad/s]

  NaturalResidual() = default;
  /// Of impulses that are `off` = |λ − λ*| from the answer, with root = √S and diagonal = S + c.
  NaturalResidual(double root, double diagonal, double off)
      : size(root * std::abs(off)), rate(diagonal * std::abs(off)) {}
  /// Of impulses that are `off` from the answer, without compliance: s = S = diagonal.
  NaturalResidual(double s, double off) : NaturalResidual(std::sqrt(s), s, off) {}

  /// The size, 0 where the rate is right to the tolerance.
  double beyond(double rate_tolerance) const { return rate <= rate_tolerance ? 0 : size; }
};

/// Of a row at λ and w.
inline NaturalResidual natural_residual(const RowLaw& law, double s, double lambda, double w) {
  return {s, lambda - law.project(s, lambda, w)};
}

/// How far the motion is from the law of a row at λ and w, |w − w*| with the rate w* that the row by itself
/// answers [m/s or rad/s]; 0 where λ is within `negligible` of the level of that rate.  It is there beside
/// the natural residual because gaps have a tolerance in metres: a light row may be far off its way by an
/// impulse that is nothing beside those of others, and on a level no rate is wrong.
inline double motion_residual(const RowLaw& law, double s, double lambda, double w, double negligible) {
  if (std::abs(lambda + law.slope * w - law.level_at(w)) <= negligible) return 0;
  return std::abs(w - law.resolve(s, w - s * lambda).w);
}

/// S_rr of a row with this effective mass; 1 where it moves nothing.
inline double delassus_diagonal(double effective_mass) { return effective_mass > 0 ? 1 / effective_mass : 1; }

/// The largest residual of rows and of the laws of contacts: the one reduction of them.  What it is compared
/// with is its caller's (impulse_scale()).
class LargestResidual {
 public:
  /// Of `row`, if it matters whose it is.  What is not a number is passed over here, and noted.
  void add(double size, int row = -1) {
    if (size > size_) {
      size_ = size;
      row_ = row;
    }
    numbers_ = numbers_ && !std::isnan(size);
  }
  /// All of these rows, 0 where rates are right to the tolerance; S_rr is s(r).  Without `equalities` those
  /// with bounds alone.
  template <typename Diagonal>
  void add_rows(std::span<const RowLaw> laws, const Diagonal& s, std::span<const double> lambda,
                std::span<const double> w, double rate_tolerance, bool equalities = true) {
    for (std::size_t r = 0; r < laws.size(); ++r)
      if (equalities || laws[r].bounded())
        add(natural_residual(laws[r], s(r), lambda[r], w[r]).beyond(rate_tolerance), static_cast<int>(r));
  }
  double size() const { return size_; }
  /// Whose it is; −1: nobody's, or not said.
  int row() const { return row_; }
  /// All were finite numbers.
  bool finite() const { return numbers_ && std::isfinite(size_); }
  /// The size, infinite if something was not finite.
  double strict_size() const { return finite() ? size_ : std::numeric_limits<double>::infinity(); }
  /// As a part of the scale.
  double over(double scale) const { return size_ == 0 ? 0 : size_ / scale; }

 private:
  double size_ = 0;
  int row_ = -1;
  bool numbers_ = true;
};

/// Chosen, where nothing else is said.
struct ResidualTuning {
  /// Laws are met if no residual is larger than this part of the scale of all.  Twice lets a pile that falls
  /// asleep sink in deeper.
  static constexpr double kMet = 1e-9;
  /// Where there are contacts and kMet is not to be had, laws are met if no residual is larger than this:
  /// what dependent rows contradict each other by.  Half: 5.7 times the factorisations of a card house;
  /// twice: residuals above 1e-8 of stacks, and 25 times the Newton steps of shapes on a mesh.
  static constexpr double kMetByContacts = 1e-8;
  /// Round-off of impulses, poses and twists, as a part of them: 16 units of it.
  static constexpr double kRoundOff = 16 * std::numeric_limits<double>::epsilon();
};

/// What residuals are compared with: the size of an impulse, and of that which would stop the rate b [√J].
inline double impulse_scale(double s, double lambda, double b) {
  const double root = std::sqrt(s);
  return std::max(root * std::abs(lambda), std::abs(b) / root);
}
/// The largest of rows with S_rr = s(r).
template <typename Diagonal>
double impulse_scale(const Diagonal& s, std::span<const double> lambda, std::span<const double> b) {
  double scale = 0;
  for (std::size_t r = 0; r < lambda.size(); ++r)
    scale = std::max(scale, impulse_scale(s(r), lambda[r], b[r]));
  return scale;
}

}  // namespace taut
