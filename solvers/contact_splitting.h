#pragma once

#include <Eigen/Dense>
#include <span>
#include <vector>

#include "solvers/constraint_system.h"
#include "solvers/contact_forces.h"
#include "solvers/row_law.h"

namespace taut {

/// When a splitting ends: the residual that is sought, and what is enough if that takes long; errors of rates
/// below `rate_tolerance` [m/s or rad/s] do not count.
struct SplittingLimits {
  double tolerance = 1e-9, most = 1e-8, rate_tolerance = 0;
  int iterations = 2000;
};

/// How a splitting went.
struct SplittingOutcome {
  int iterations = 0, factorizations = 0;
  /// Natural map at the end, over the size of impulses, the largest |λ| √S_rr and |b| / √S_rr [√J].
  double residual = 0;
  bool converged = false;
};

/// The fall-back of contacts: w = S λ + b with Coulomb's law in each contact and the law of each other row,
/// by alternating between the laws and the linear system [Boyd2011], [Carpentier2024]:
///
///   y = the answer of the laws to s,   (S + Σ) λ = t − b + Σ (2 y − s),   s ← s + α (λ − y)
///
/// with Σ = ρ diag S on rows with bounds and 0 on equalities, which every λ meets; t: the rates that the laws
/// ask for.  One factorisation, then a back-solve an iteration; S may be singular.  Where λ = y the laws
/// hold. The fixed point is approached by Anderson's extrapolation from the last iterates [Walker2011].  It
/// converges where the radii of many coupled discs chase each other.           (solvers/README, "Contacts")
class ContactSplitting {
 public:
  explicit ContactSplitting(ConstraintSystem& system) : system_(system) {}

  /// `lambda`: a guess, then the result; `w`: result.  Leaves the system factored with its Σ.
  SplittingOutcome solve(const ContactForces& contacts, std::span<const RowLaw> laws,
                         std::span<const double> b, std::span<double> lambda, std::span<double> w,
                         const SplittingLimits& limits, StageTimes& times);

 private:
  /// What the iteration works on.
  struct Problem {
    const ContactForces& contacts;
    std::span<const RowLaw> laws;
    std::span<const double> b;
    std::span<double> lambda, w;
  };

  /// Rows with bounds that are not left out.
  bool takes_part(int row) const { return states_[row] != 0 && states_[row] != kMasked; }
  void resize(int rows);
  double begin(const Problem& problem);
  double evaluate(const Problem& problem);
  void answer(const Problem& problem);
  void solve_linear(std::span<double> lambda);
  void factorize(const Problem& problem, StageTimes& times, SplittingOutcome& outcome);
  double law_error(const Problem& problem, double rate_tolerance) const;
  bool balance(const Problem& problem, double distance, StageTimes& times, SplittingOutcome& outcome);
  double step(const Problem& problem, double distance, bool even, bool plainly);
  bool drifts(double distance) const;
  void leap(const Problem& problem, double distance);
  void remember();
  void extrapolate();

  ConstraintSystem& system_;
  double rho_ = 0.1;
  int columns_ = 0, next_ = 0;  // of the memory
  std::vector<double> states_, diagonal_, target_, scratch_, refinement_;
  Eigen::VectorXd root_;       // √S_rr
  Eigen::VectorXd s_, y_, f_;  // f = α (λ − y)
  Eigen::VectorXd last_s_, last_y_, last_f_, plain_, leap_;
  Eigen::MatrixXd steps_, changes_;  // of s and f between iterates, weighted with √S_rr
  Eigen::MatrixXd products_;         // changes_ᵀ changes_
};

}  // namespace taut
