#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/laws/row_law.h"

namespace taut {

/// How far an impulse is from its law, the one measure of that: the distance to what the law by itself
/// answers to it and its rate, λ* = prox_S(λ − w/S) with S = S_rr.  0 where the law is met, and nowhere else.
///                                                           (solvers/complementarity, "Natural residual")
struct NaturalResidual {
  double size = 0;  ///< √S |λ − λ*| [√J]
  double rate = 0;  ///< (S + c) |λ − λ*|, by how much the rate is off [m/s or rad/s]

  NaturalResidual() = default;
  /// Of impulses that are `off` = |λ − λ*| from the answer, with root = √S and own = S + c.
  NaturalResidual(double root, double own, double off)
      : size(root * std::abs(off)), rate(own * std::abs(off)) {}
  /// Of impulses that are `off` from the answer, without compliance: s = S, own = S.
  NaturalResidual(double s, double off) : NaturalResidual(std::sqrt(s), s, off) {}

  /// The size, 0 where the rate is right to the tolerance.
  double beyond(double rate_tolerance) const { return rate <= rate_tolerance ? 0 : size; }
};

/// Of a row at λ and w.
inline NaturalResidual natural_residual(const RowLaw& law, double s, double lambda, double w) {
  return {s, lambda - law.project(s, lambda, w)};
}

/// Laws are met if no residual is larger than this part of the scale of all.
inline constexpr double kMetResidual = 1e-9;
/// Where there are contacts and kMetResidual is not to be had, laws are met if no residual is larger than
/// this: what dependent rows contradict each other by.  Half: 5.7 times the factorisations of a card house;
/// twice: residuals above 1e-8 of stacks, and 25 times the Newton steps of shapes on a mesh.
inline constexpr double kMetContactResidual = 1e-8;

/// Round-off of impulses, poses and twists, as a part of them: 16 units of it.
inline constexpr double kRelativeRoundOff = 16 * std::numeric_limits<double>::epsilon();

/// What residuals are compared with: the size of an impulse, and of that which would stop the rate b [√J].
inline double impulse_scale(double s, double lambda, double b) {
  const double root = std::sqrt(s);
  return std::max(root * std::abs(lambda), std::abs(b) / root);
}

}  // namespace taut
