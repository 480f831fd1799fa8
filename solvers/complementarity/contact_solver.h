#pragma once

#include <optional>
#include <span>
#include <vector>

#include "solvers/complementarity/contact_newton.h"
#include "solvers/complementarity/contact_solver_tuning.h"
#include "solvers/complementarity/impulse_iteration.h"
#include "solvers/complementarity/primal_dual_active_set.h"
#include "solvers/complementarity/stage_problem.h"
#include "solvers/laws/contact_laws.h"
#include "solvers/system/constraint_system.h"

namespace taut {

class Archive;

/// Stages with contacts, through the bodies: as impulses are where all rests, or with contacts locked, else
/// by Newton's method, then with friction that holds where some division of the load allows it, or at last by
/// sweeps.  For a whole system or an island of it.
/// (solvers/complementarity, "Ladder")
class ContactSolver {
 public:
  ContactSolver(ConstraintSystem& system, ContactLaws& contacts);

  /// For other rows of the system.
  void reset() { iteration_.reset(); }

  /// The natural residual at λ, whose rates are w, over the largest impulse; errors of rates within the
  /// tolerance do not count.
  double distance(const StageProblem& problem, double rate_tolerance) const;
  /// True if nothing comes together and λ meets the laws as it is, or after one linear solve in which all
  /// that presses is locked; w becomes its rates.
  bool rests(const StageProblem& problem, double rate_tolerance, StageRecord& record);
  /// `inexact`: a residual that may be taken in the end; 0: none beyond that of Newton's method.
  bool solve(const StageProblem& problem, const NewtonLimits& limits, double inexact, StageRecord& record);
  /// Newton's method, and friction that holds; λ is what it may start from.
  bool solve_by_newton(const StageProblem& problem, const NewtonLimits& limits, StageRecord& record);
  /// From a solution in which contacts slip that stuck: true, and another one, if there is one in which they
  /// hold.  Else they are let go, and λ and w stay as they are.
  bool search_sticking_solution(const StageProblem& problem, double rate_tolerance, StageRecord& record);
  /// Sweeps of Gauss–Seidel over λ and w; the distance that they leave.
  double sweep(const StageProblem& problem, int sweeps, double rate_tolerance);
  const ContactNewton& newton() const { return newton_; }
  /// To be used by others, too.
  ImpulseIteration& iteration();

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive) { locked_.transfer(archive); }
  /// The next solve makes a factor of its own.
  void forget_factor() { locked_.forget_factor(); }

 private:
  using Tuning = ContactSolverTuning;

  bool meets_laws(const StageProblem& problem, double tolerance, double rate_tolerance, StageRecord& record);
  bool rests_locked(const StageProblem& problem, double rate_tolerance, StageRecord& record);
  void sweep_guess(const StageProblem& problem, double rate_tolerance);
  double law_error(const StageProblem& problem, double rate_tolerance) const;
  bool solve_by_sweeps(const StageProblem& problem, double rate_tolerance, double inexact,
                       StageRecord& record);

  ConstraintSystem& system_;
  ContactLaws& contacts_;
  ContactNewton newton_;
  PrimalDualActiveSet locked_;
  std::optional<ImpulseIteration> iteration_;
  std::vector<RowLaw> locked_laws_;
  std::vector<double> held_, unshared_;
};

}  // namespace taut
