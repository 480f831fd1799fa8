#pragma once

#include <Eigen/Core>
#include <limits>
#include <span>
#include <vector>

#include "solvers/common/step_report.h"
#include "solvers/complementarity/contact_newton_tuning.h"
#include "solvers/complementarity/contact_projection.h"
#include "solvers/complementarity/coupled_step.h"
#include "solvers/complementarity/proximal_metric.h"

namespace taut {

/// The terms of one round of the proximal point iteration, about a centre λ̄ with a metric Σ,
///
///     F(v) = v − Wᵀ y = 0,   y = prox_Σ(x),   x = λ̄ − Σ⁻¹ (b + W v − t),
///
/// for the velocities v = Wᵀ λ, and of a semismooth Newton method on it [QiSun1993].  Where no contact slips
/// F is the gradient of a convex function; where friction follows the normal impulse there is no such
/// function. Works with δv = v − Wᵀ λ̄, so that round-off is that of small numbers.  (solvers/complementarity,
/// Eq. 3)
class ProximalRound {
 public:
  explicit ProximalRound(ConstraintSystem& system) : system_(system), coupled_step_(system) {}

  /// The rows are those that the system has now.
  void resize();
  /// The next round is about λ̄, which has the rates w.
  void start(std::span<const double> centre, std::span<const double> w);
  /// Newton's method begins, with Σ of ρ, to end at a part of the residual of the round before.
  void begin_steps(const ContactProblem& problem, double rho, double residual);

  std::span<const double> sigma() const { return metric_.sigma(); }
  /// x at the present velocities and `length` of the step.
  std::span<const double> x(const ContactProblem& problem, double length);
  /// What F is to the round: to be lowered by a Newton step; small enough, or as small as round-off allows;
  /// or neither, and steps will not make it so.
  enum class Verdict { kOpen, kMet, kGivenUp };
  /// F at the present velocities, of which at most `left` Newton steps are allowed.
  Verdict look(const ContactProblem& problem, std::span<const double> y, int left);
  /// Newton's step with the primal matrix 1 + Wᵀ D W, D = ∂prox Σ⁻¹, which is left in the place of ∂prox, and
  /// what friction that follows normal impulses adds to it.  False if it cannot be factored.
  bool find_step(ContactProjection& projection, StageTimes& times);
  /// F along the step, the slope of the function if there is one, at its begin and at a `length` of it where
  /// the laws answer y.
  double start_slope() const { return step_.dot(gradient_); }
  double slope(std::span<const double> y, double length) const;
  void move(double length);

 private:
  using Tuning = ContactNewtonTuning;

  /// Sizes of F from step to step.
  struct History {
    double first = 0, least = std::numeric_limits<double>::infinity();
    int looks = 0, stuck = 0;  // and steps since it fell, at round-off

    void add(double size, double scale);
  };

  ConstraintSystem& system_;
  ProximalMetric metric_;
  CoupledStep coupled_step_;
  std::vector<double> centre_, base_, x_, change_;  // λ̄, b + S λ̄, x, y − λ̄
  Eigen::VectorXd v_, gradient_, step_;             // δv, F, the Newton step
  std::vector<double> rates_, rates_of_step_;       // W δv, W times the step
  double along_ = 0, square_ = 0;                   // of the step with δv, and with itself
  double tolerance_ = 0;                            // of F [√J]
  History history_;
};

}  // namespace taut
