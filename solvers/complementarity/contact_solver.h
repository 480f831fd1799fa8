#pragma once

#include <algorithm>
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

/// What may be tried on a stage with contacts, and what is enough.
struct ContactLimits {
  NewtonLimits newton;
  bool warm_start = false;          ///< the last impulses are tried as they are, and with contacts locked
  double warm_start_tolerance = 0;  ///< of rates, for those
  double inexact = 0;  ///< residual that may be taken in the end; 0: none beyond that of Newton's method
};

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
  double relative_residual(const StageProblem& problem, double rate_tolerance) const;
  /// λ is what it may start from, then with w the result; true if that is good enough.
  bool solve(const StageProblem& problem, const ContactLimits& limits, StageRecord& record);
  /// Sweeps of Gauss–Seidel over λ and w; the relative residual that they leave.
  double sweep(const StageProblem& problem, int sweeps, double rate_tolerance);
  /// What presses at the last impulses λ, and sticks, goes on with the division of the load that it has:
  /// all of it as equalities, of which solve(laws, λ) changes those impulses only by what their rates lack,
  /// where λ is taken if met(problem).  Newton's method would find another division each time.
  template <typename Solve, typename Met>
  bool keep_division(const StageProblem& problem, double rate_tolerance, Solve solve, Met met);
  const ContactNewton& newton() const { return newton_; }
  /// To be used by others, too.
  ImpulseIteration& iteration();

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive) { locked_.transfer(archive); }
  /// The next solve makes a factor of its own.
  void forget_factor() { locked_.forget_factor(); }

 private:
  using Tuning = ContactSolverTuning;

  bool rests(const StageProblem& problem, double rate_tolerance, StageRecord& record);
  bool meets_laws(const StageProblem& problem, double tolerance, double rate_tolerance, StageRecord& record);
  bool rests_locked(const StageProblem& problem, double rate_tolerance, StageRecord& record);
  void sweep_guess(const StageProblem& problem, double rate_tolerance);
  void close_joints(const StageProblem& problem, double rate_tolerance, StageRecord& record);
  bool search_sticking_solution(const StageProblem& problem, double rate_tolerance, StageRecord& record);
  LargestResidual largest_residual(const StageProblem& problem, double rate_tolerance) const;
  bool solve_by_sweeps(const StageProblem& problem, double rate_tolerance, double inexact,
                       StageRecord& record);

  ConstraintSystem& system_;
  ContactLaws& contacts_;
  ContactNewton newton_;
  PrimalDualActiveSet locked_;
  std::optional<ImpulseIteration> iteration_;
  std::vector<RowLaw> locked_laws_;
  std::vector<double> held_, lambda_before_;
};

template <typename Solve, typename Met>
bool ContactSolver::keep_division(const StageProblem& problem, double rate_tolerance, Solve solve, Met met) {
  if (contacts_.soft() || !contacts_.all_stick(problem.lambda) ||
      relative_residual(problem, rate_tolerance) > Tuning::kNear)
    return false;
  locked_laws_.assign(problem.laws.begin(), problem.laws.end());
  contacts_.held_laws(problem.lambda, locked_laws_);
  held_.assign(problem.lambda.begin(), problem.lambda.end());
  solve(locked_laws_, held_);
  StageProblem held = problem;
  held.lambda = held_;
  if (!met(held)) return false;
  std::copy(held_.begin(), held_.end(), problem.lambda.begin());
  return true;
}

}  // namespace taut
