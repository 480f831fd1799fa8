#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "solvers/common/step_report.h"
#include "solvers/complementarity/contact_newton_tuning.h"
#include "solvers/complementarity/contact_projection.h"
#include "solvers/complementarity/coupled_step.h"
#include "solvers/complementarity/proximal_metric.h"

namespace taut {

/// One round of the proximal point iteration, about a centre λ̄ with a metric Σ:
///
///     F(v) = v − Wᵀ y = 0,   y = prox_Σ(λ̄ − Σ⁻¹ (b + W v − t))
///
/// for the velocities v = Wᵀ λ, by a semismooth Newton method [QiSun1993] with line search.  Where no contact
/// slips F is the gradient of a strictly convex function that is piecewise smooth; where friction follows the
/// normal impulse there is no such function.  Works with δv = v − Wᵀ λ̄, so that round-off is that of small
/// numbers.  (solvers/complementarity, Eq. 3)
class ProximalRound {
 public:
  explicit ProximalRound(ConstraintSystem& system)
      : system_(system), projection_(system), coupled_step_(system) {}

  /// The first round starts from λ and its rates w.
  void begin(const ContactProblem& problem);
  /// The next round starts from λ̄ = y and its rates w.
  void start(const ContactProblem& problem);
  void set_metric(const ContactProblem& problem, double rho) { metric_.set(system_.rows(), problem, rho); }
  /// Lowers |F| to the tolerance [√J], in at most as many Newton steps as `most` has beyond `steps`, which is
  /// counted on.  False if a value is not finite, or the tolerance is not reached.
  bool minimize(const ContactProblem& problem, double tolerance, int most, int& steps, StageTimes& times);

  const std::vector<double>& y() const { return projection_.y(); }
  /// Back to the y of an earlier round.
  void set_y(std::span<const double> y) { projection_.set_y(y); }

 private:
  using Tuning = ContactNewtonTuning;

  void project(const ContactProblem& problem, double length);
  void read_gradient();
  bool find_step(StageTimes& times);
  void search(const ContactProblem& problem);

  ConstraintSystem& system_;
  ContactProjection projection_;
  ProximalMetric metric_;
  CoupledStep coupled_step_;
  std::vector<double> centre_, base_, change_;  // λ̄, b + S λ̄, y − λ̄
  Eigen::VectorXd v_, gradient_, step_;         // δv, F, the Newton step
  std::vector<double> rates_, rates_of_step_;   // W δv, W times the step
};

}  // namespace taut
