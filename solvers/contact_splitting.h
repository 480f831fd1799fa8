#pragma once

#include <span>
#include <vector>

#include "solvers/constraint_system.h"
#include "solvers/contact_forces.h"
#include "solvers/row_law.h"

namespace taut {

/// When a splitting ends: errors of rates below `rate_tolerance` [m/s or rad/s] do not count.
struct SplittingLimits {
  double tolerance = 1e-9, rate_tolerance = 0;
  int iterations = 3000;
};

/// How a splitting went.
struct SplittingOutcome {
  int iterations = 0, factorizations = 0;
  /// Largest of |λ − y| √S_rr and |Σ Δy| / √S_rr at the end, over the size of
  /// impulses, the largest |λ| √S_rr and |b| / √S_rr [√J].
  double residual = 0;
  bool converged = false;
};

/// The fall-back of contacts: w = S λ + b with Coulomb's law in each contact and the law of each other row,
/// by alternating between the linear system and the laws [Boyd2011], [Carpentier2024]:
///
///   (S + Σ) λ = t − b + Σ (y − u),   y = the answer of the laws to λ + u,   u ← u + λ − y
///
/// with Σ = ρ diag S on rows with bounds and 0 on equalities, which every λ meets.  One factorisation, then a
/// back-solve an iteration; S may be singular.  It converges where the radii of many coupled discs chase each
/// other, though slowly.                                                       (solvers/README, "Contacts")
class ContactSplitting {
 public:
  explicit ContactSplitting(ConstraintSystem& system) : system_(system) {}

  /// `lambda`: a guess, then the result; `w`: result.  Leaves the system factored with its Σ.
  SplittingOutcome solve(const ContactForces& contacts, std::span<const RowLaw> laws,
                         std::span<const double> b, std::span<double> lambda, std::span<double> w,
                         const SplittingLimits& limits, StageTimes& times);

 private:
  struct Distance {
    double primal = 0, dual = 0;
  };

  /// Rows with bounds that are not left out.
  bool takes_part(int row) const { return states_[row] != 0 && states_[row] != kMasked; }
  void begin(const ContactForces& contacts, std::span<const RowLaw> laws, std::span<const double> b,
             std::span<const double> lambda, std::span<double> w);
  Distance iterate(const ContactForces& contacts, std::span<const RowLaw> laws, std::span<const double> b,
                   std::span<double> lambda, double rate_tolerance);
  double law_error(const ContactForces& contacts, std::span<const RowLaw> laws, std::span<const double> b,
                   std::span<const double> lambda, std::span<double> w, double rate_tolerance) const;
  bool leap(const ContactForces& contacts, std::span<const RowLaw> laws);
  void factorize(std::span<const RowLaw> laws, const ContactForces& contacts, StageTimes& times,
                 SplittingOutcome& outcome);
  void solve_linear(std::span<double> lambda);
  void answer(const ContactForces& contacts, std::span<const RowLaw> laws);

  ConstraintSystem& system_;
  double rho_ = 0.1;
  std::vector<double> states_, diagonal_, x_, y_, last_, change_, last_change_, u_, target_, right_;
};

}  // namespace taut
