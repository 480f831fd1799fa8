#pragma once

#include <span>
#include <vector>

#include "solvers/complementarity/best_round.h"
#include "solvers/complementarity/contact_newton_tuning.h"
#include "solvers/complementarity/contact_problem.h"
#include "solvers/complementarity/coupled_rounds.h"
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
  double tolerance = ResidualTuning::kMet, most = ResidualTuning::kMetByContacts, rate_tolerance = 0;
  int iterations = ContactNewtonTuning::kMostSteps;
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
///     rounds    λ̄ ← λ = prox(λ̄ − Σ⁻¹ (b + W v − t))
///     Newton    v − Wᵀ prox(λ̄ − Σ⁻¹ (b + W v − t)) = 0   for the velocities v = Wᵀ λ
///
/// P is what the laws answer: a row's own, and of a contact its normal's, then in the disc whose radius
/// follows from that.  The rounds (ProximalRound) are the proximal point iteration [Rockafellar1976], which
/// takes away what Σ gave, with the Σ for which they end (CoupledRounds).  S may be singular.
/// (solvers/complementarity, "Many contacts")
class ContactNewton {
 public:
  explicit ContactNewton(ConstraintSystem& system) : system_(system), round_(system), projection_(system) {}

  /// S = W Wᵀ with the W that the system has.  The friction of `contacts` is that of the result from then on.
  NewtonOutcome solve(ContactLaws& contacts, const StageProblem& stage, const NewtonLimits& limits,
                      StageRecord& record);

  /// The rates w meet the equalities of joints, to some times the tolerance of rates.
  bool holds_joints(std::span<const RowLaw> laws, std::span<const double> w, double rate_tolerance) const;
  /// Contacts are all that there is, or very many: sweeps of the guess pay.
  bool is_heap() const;

 private:
  using Tuning = ContactNewtonTuning;

  /// What a round hands to the next.
  struct Progress {
    double rho = Tuning::kFirstRho;
    double residual = 1;  ///< of the round before, or of the last one kept
    bool met = false;     ///< Newton's method came to its end in the round before
    double slip = 0;      ///< of contacts that share a load, after the round before [m/s]
  };

  void read_scales(ContactProblem& problem);
  Progress begin_rounds(const ContactProblem& problem, const NewtonLimits& limits);
  bool ends(const ContactProblem& problem, const NewtonLimits& limits, Progress& progress,
            NewtonOutcome& outcome);
  double sufficient_residual(const NewtonLimits& limits, const Progress& progress,
                             const NewtonOutcome& outcome) const;
  bool slips_in_vain(const ContactProblem& problem, const NewtonLimits& limits, int rounds,
                     Progress& progress) const;
  bool next_round(const ContactProblem& problem, const NewtonLimits& limits, const NewtonOutcome& outcome,
                  Progress& progress);
  void read_rates(const ContactProblem& problem, std::span<const double> y) const;
  double relative_residual(const ContactProblem& problem, double rate_tolerance, int rounds) const;

  ConstraintSystem& system_;
  std::vector<double> diagonal_, target_, guess_;  // S_rr, t, λ at the start
  ProximalRound round_;
  ContactProjection projection_;
  CoupledRounds coupled_;
  BestRound best_;  // of those in which joints were closed
};

}  // namespace taut
