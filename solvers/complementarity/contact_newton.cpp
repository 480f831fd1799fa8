#include "solvers/complementarity/contact_newton.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/common/max_abs.h"
#include "solvers/complementarity/slope_search.h"
#include "solvers/laws/contact_residual.h"

namespace taut {

NewtonOutcome ContactNewton::solve(ContactLaws& contacts, const StageProblem& stage,
                                   const NewtonLimits& limits, StageRecord& record) {
  ContactProblem problem{contacts, stage.laws, stage.b, stage.lambda, stage.w, {}, {}};
  contacts.clear_idle(stage.lambda);
  read_scales(problem);
  system_.rates(stage.lambda, stage.b, stage.w);
  guess_.assign(stage.lambda.begin(), stage.lambda.end());
  NewtonOutcome outcome;
  Progress progress = begin_rounds(problem, limits);
  const std::vector<double>& y = projection_.y();
  using Verdict = ProximalRound::Verdict;
  do {
    ++outcome.rounds;
    round_.begin_steps(problem, progress.rho, progress.residual);        // Σ = ρ S_rr
    projection_.project(problem, round_.x(problem, 0), round_.sigma());  // y = prox_Σ(x)
    Verdict verdict;                                                     // of F = δv − Wᵀ (y − λ̄)
    while ((verdict = round_.look(problem, y, limits.iterations - outcome.iterations)) == Verdict::kOpen) {
      ++outcome.iterations;
      if (!round_.find_step(projection_, record.times)) break;  // (1 + Wᵀ ∂prox Σ⁻¹ W + N) step = −F
      SlopeSearch search(round_.start_slope());
      do projection_.project(problem, round_.x(problem, search.length()), round_.sigma());
      while (search.goes_on(round_.slope(y, search.length())));
      round_.move(search.length());
    }
    progress.met = verdict == Verdict::kMet;
    read_rates(problem, y);
    outcome.residual = relative_residual(problem, limits.rate_tolerance, outcome.rounds);
  } while (!ends(problem, limits, progress, outcome) && next_round(problem, limits, outcome, progress));
  if (!outcome.converged && best_.restore(problem.lambda, problem.w)) outcome.residual = best_.residual();
  contacts.take_over(stage.lambda, stage.w, limits.rate_tolerance);
  record.iterations += outcome.iterations;
  if (outcome.converged) record.residual = std::max(record.residual, outcome.residual);
  return outcome;
}

bool ContactNewton::is_heap() const {
  const Rows& rows = system_.rows();
  return rows.contact_count() > 0 && (rows.first_contact_row() == 0 || system_.uses_primal_system());
}

/// S_rr, the rates asked for, and the size of impulses [√J], also of those that vanish in the end.
void ContactNewton::read_scales(ContactProblem& problem) {
  const int n = system_.row_count();
  for (auto* values : {&diagonal_, &target_}) values->assign(n, 0.0);
  system_.effective_masses(diagonal_);
  problem.contacts.targets(target_);
  for (int r = 0; r < system_.rows().first_contact_row(); ++r)
    target_[r] = problem.laws[r].bounded() ? 0 : problem.laws[r].rate(1);
  for (double& s : diagonal_) s = delassus_diagonal(s);
  problem.diagonal = diagonal_;
  problem.target = target_;
  problem.scale = impulse_scale([&](std::size_t r) { return diagonal_[r]; }, problem.lambda, problem.b);
}

/// From the guess and its rates.
ContactNewton::Progress ContactNewton::begin_rounds(const ContactProblem& problem,
                                                    const NewtonLimits& limits) {
  best_.begin(problem.lambda.size());
  coupled_.reserve(problem.lambda.size());
  projection_.begin(problem.lambda);
  round_.resize();
  round_.start(problem.lambda, problem.w);
  const double off = relative_residual(problem, limits.rate_tolerance, 0);
  coupled_.begin(problem.lambda, off);
  Progress progress;
  progress.rho = std::clamp(Tuning::kRhoOfResidual * off, Tuning::kNearRho, Tuning::kFirstRho);
  if (!problem.contacts.soft()) progress.residual = off;
  return progress;
}

/// True if λ and w, or those of the best round, which they are then, are good enough, or will not become so.
bool ContactNewton::ends(const ContactProblem& problem, const NewtonLimits& limits, Progress& progress,
                         NewtonOutcome& outcome) {
  const double enough = sufficient_residual(limits, progress, outcome);
  const bool closed = holds_joints(problem.laws, problem.w, limits.rate_tolerance);
  outcome.converged = outcome.residual <= enough && (closed || outcome.rounds > Tuning::kPatience);
  if (outcome.converged) return true;
  if (closed) best_.offer(problem.lambda, problem.w, outcome.residual);
  if (best_.residual() <= enough) {
    outcome.converged = best_.restore(problem.lambda, problem.w);
    outcome.residual = best_.residual();
    return true;
  }
  return slips_in_vain(problem, limits, outcome.rounds, progress) ||
         outcome.iterations >= limits.iterations ||
         outcome.rounds >= Tuning::kRoundsOfAStep * limits.iterations;
}

/// The residual that is sought, or the one that is enough where rounds are slow or many.
double ContactNewton::sufficient_residual(const NewtonLimits& limits, const Progress& progress,
                                          const NewtonOutcome& outcome) const {
  const bool slow =
      outcome.rounds > Tuning::kPatience || (outcome.rounds > Tuning::kFirstRounds &&
                                             !(outcome.residual <= Tuning::kSlowRound * progress.residual));
  return slow ? limits.most : limits.tolerance;
}

/// Contacts that are to hold slip, and rounds no longer lower that.
bool ContactNewton::slips_in_vain(const ContactProblem& problem, const NewtonLimits& limits, int rounds,
                                  Progress& progress) const {
  const double before = progress.slip;
  progress.slip = limits.holding ? problem.contacts.sticking_slip(problem.w) : 0;
  return rounds > Tuning::kRoundsToHold && progress.slip > Tuning::kSlowSlip * before;
}

/// λ̄ = y and ρ for the next round; a round that did not go well is taken back.  False if rounds go no
/// further.
bool ContactNewton::next_round(const ContactProblem& problem, const NewtonLimits& limits,
                               const NewtonOutcome& outcome, Progress& progress) {
  bool goes_on = true;
  const bool stalls = progress.met && progress.rho <= Tuning::kRhoToYield &&
                      std::abs(outcome.residual / progress.residual - 1) < Tuning::kStalled;
  if (!coupled_.keep(projection_.y(), progress.met, outcome.residual, progress.rho)) {
    read_rates(problem, coupled_.kept());
    goes_on = coupled_.grow(progress.rho);
  }
  progress.residual = coupled_.kept_residual();
  if (stalls && problem.contacts.let_yield(problem.lambda, problem.w, limits.most * problem.scale,
                                           Tuning::kTooMuch * problem.scale)) {
    problem.contacts.targets(target_);
    read_rates(problem, guess_);
    progress = begin_rounds(problem, limits);
    return true;
  }
  round_.start(problem.lambda, problem.w);
  return goes_on && coupled_.progress();
}

/// λ and w of y.
void ContactNewton::read_rates(const ContactProblem& problem, std::span<const double> y) const {
  std::copy(y.begin(), y.end(), problem.lambda.begin());
  system_.rates(problem.lambda, problem.b, problem.w);
}

bool ContactNewton::holds_joints(std::span<const RowLaw> laws, std::span<const double> w,
                                 double rate_tolerance) const {
  double open = 0;
  for (int r = 0; r < system_.rows().first_contact_row(); ++r)
    if (!laws[r].bounded()) open = std::max(open, std::abs(w[r] - laws[r].rate(1)));
  return open <= Tuning::kEqualityRates * rate_tolerance;
}

/// The natural residual at λ, with its w, over the size of impulses; infinite if λ is.  What is left of
/// equalities after some rounds is what dependent ones contradict each other by.
double ContactNewton::relative_residual(const ContactProblem& problem, double rate_tolerance,
                                        int rounds) const {
  if (!std::isfinite(max_abs(problem.lambda))) return std::numeric_limits<double>::infinity();
  if (problem.scale == 0) return 0;
  LargestResidual largest;
  largest.add_rows(
      problem.laws.first(system_.rows().first_contact_row()),
      [&](std::size_t r) { return problem.diagonal[r]; }, problem.lambda, problem.w, rate_tolerance,
      rounds <= Tuning::kEqualityRounds);
  add_contacts(problem.contacts, problem.lambda, problem.w, rate_tolerance, largest);
  return largest.over(problem.scale);
}

}  // namespace taut
