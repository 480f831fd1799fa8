#pragma once

#include <Eigen/Core>
#include <Eigen/Jacobi>
#include <span>
#include <vector>

#include "solvers/complementarity/contact_newton_tuning.h"
#include "solvers/complementarity/contact_projection.h"
#include "solvers/system/constraint_system.h"

namespace taut {

/// The Newton step of a round in which nothing of Coulomb's law is held fast.  With y_t = x_t cut off at μ
/// y_n the derivative of Newton's equation is H + N: H = 1 + Wᵀ D Σ⁻¹ W, the primal matrix of all rounds,
/// which has a factor, and N = Σ_k (μ/Σ_n) W_tᵀ W_n of rank one for each sliding contact, with W_t along its
/// slip. Radii of spinning and rolling follow y_n, too, but not in the derivative: their lengths are small
/// beside the bodies.  Solved by GMRES with H on the right [SaadSchultz1986]: (1 + N H⁻¹) z = −gradient, step
/// = H⁻¹ z.
class CoupledStep {
 public:
  explicit CoupledStep(ConstraintSystem& system) : system_(system) {}

  /// Room for the most vectors of ℝⁿ at once, so that a step that needs more of them than those before
  /// allocates nothing.
  void reserve(Eigen::Index n);
  /// (H + N) step = −gradient, with less of N where that does not go down the gradient, as H alone does.
  void solve(const ContactProjection& projection, std::span<const double> sigma,
             const Eigen::VectorXd& gradient, Eigen::VectorXd& step);

 private:
  using Tuning = ContactNewtonTuning;

  /// N.
  struct Coupling {
    const ContactProjection& projection;
    std::span<const double> sigma;
    double part;  ///< of it that is kept
  };

  void solve_part(const Coupling& coupling, const Eigen::VectorXd& gradient, Eigen::VectorXd& step);
  void add_coupling(const Coupling& coupling, const Eigen::VectorXd& u, Eigen::VectorXd& sum) const;
  double orthogonalize(int m);

  ConstraintSystem& system_;
  std::vector<Eigen::VectorXd> basis_;
  Eigen::MatrixXd triangle_;                          // R of the Hessenberg matrix
  std::vector<Eigen::JacobiRotation<double>> turns_;  // that make it
  Eigen::VectorXd residual_;                          // what is left of the right side
};

}  // namespace taut
