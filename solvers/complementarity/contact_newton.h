#pragma once

#include <span>
#include <vector>

#include "solvers/complementarity/best_round.h"
#include "solvers/complementarity/contact_newton_tuning.h"
#include "solvers/complementarity/contact_problem.h"
#include "solvers/complementarity/coupled_rounds.h"
#include "solvers/complementarity/lagged_friction.h"
#include "solvers/complementarity/proximal_round.h"
#include "solvers/complementarity/stage_problem.h"
#include "solvers/laws/contact_laws.h"
#include "solvers/laws/natural_residual.h"
#include "solvers/laws/row_law.h"
#include "solvers/system/constraint_system.h"

namespace taut {

/// When the iteration ends: the residual that is sought, and what is enough if that takes long; errors of
/// rates below `rate_tolerance` [m/s or rad/s] do not count.
struct NewtonLimits {
  double tolerance = kMetResidual, most = kMetContactResidual, rate_tolerance = 0;
  int iterations = 500;
  bool near = false;  ///< the guess is nearly right
  /// Ends where rounds no longer lower the slip of contacts that share a load: they do not hold.
  bool holding = false;
};

/// How it went.
struct NewtonOutcome {
  int iterations = 0;  ///< Newton steps: a factorisation and a back-solve each
  int rounds = 0;      ///< of the proximal iteration
  /// Natural residual at the end, over the size of impulses, the largest |λ| √S_rr and |b| / √S_rr [√J].
  double residual = 0;
  bool converged = false;  ///< else λ and w are those of the best round in which joints were closed, if any
};

/// w = S λ + b with Coulomb's law in each contact and the law of each other row, through the bodies:
///
///     rounds    λ̄ ← λ = P(λ̄ − Σ⁻¹ (b + W v − t + s)),   s = μ |u_t| along the normals
///     Newton    v − Wᵀ P(λ̄ − Σ⁻¹ (b + W v − t + s)) = 0   for the velocities v = Wᵀ λ
///
/// P is the projection onto what the laws allow: Coulomb's cone, or a row's own answer.  With s held fast in
/// a round (LaggedFriction) each of them (ProximalRound) is a convex problem [Cadoux2009].  The rounds are
/// the proximal point iteration [Rockafellar1976], which takes away what Σ gave.  S may be singular.  Heaps
/// and compliant contacts begin with rounds that hold nothing fast and have the Σ for which they end
/// (CoupledRounds); all else comes to them where s does not settle.  (solvers/complementarity, "Many
/// contacts")
class ContactNewton {
 public:
  explicit ContactNewton(ConstraintSystem& system) : system_(system), round_(system) {}

  /// S = W Wᵀ with the W that the system has.  The friction of `contacts` is that of the result from then on.
  NewtonOutcome solve(ContactLaws& contacts, const StageProblem& stage, const NewtonLimits& limits,
                      StageRecord& record);

  /// The rates w meet the equalities of joints, to some times the tolerance of rates.
  bool holds_joints(std::span<const RowLaw> laws, std::span<const double> w, double rate_tolerance) const;
  /// Contacts are all that there is, or very many: rounds that hold nothing fast come first.
  bool is_heap() const;

 private:
  using Tuning = ContactNewtonTuning;

  /// What a round hands to the next.
  struct Progress {
    double rho = Tuning::kFirstRho;
    double residual = 1;  ///< of the round before, or of the last one kept
    double slip = 0;      ///< of contacts that share a load, after the round before [m/s]
  };

  void read_scales(ContactProblem& problem);
  Progress begin_rounds(const ContactProblem& problem, const NewtonLimits& limits);
  void begin_coupled(double residual);
  bool ends(const ContactProblem& problem, const NewtonLimits& limits, bool usable, Progress& progress,
            NewtonOutcome& outcome);
  double sufficient_residual(const NewtonLimits& limits, const Progress& progress,
                             const NewtonOutcome& outcome) const;
  bool slips_in_vain(const ContactProblem& problem, const NewtonLimits& limits, int rounds,
                     Progress& progress) const;
  void next_round(const ContactProblem& problem, bool met, double residual, Progress& progress);
  Lag next_lag(const ContactProblem& problem, bool met, double residual, double& rho);
  Lag after_coupled(const ContactProblem& problem, bool met, double residual, double& rho);
  void read_rates(const ContactProblem& problem) const;
  double law_error(const ContactProblem& problem, double rate_tolerance, int rounds) const;

  ConstraintSystem& system_;
  std::vector<double> diagonal_, target_;  // S_rr, t
  ProximalRound round_;
  LaggedFriction lagged_;
  CoupledRounds coupled_;
  BestRound best_;                // of those in which joints were closed
  bool soft_ = false;             // a contact is compliant
  int rounds_of_lag_ = 0;         // since what is lagged changed
  Lag last_lagged_ = Lag::kSlip;  // where something was
};

}  // namespace taut
