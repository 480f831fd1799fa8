#include "solvers/common/step_report.h"

#include <algorithm>

namespace taut {

std::string_view to_string(Status status) {
  switch (status) {
    case Status::kSuccess:
      return "success";
    case Status::kInexact:
      return "inexact";
    case Status::kNotConverged:
      return "not converged";
    case Status::kContradiction:
      return "contradiction";
    case Status::kNotFinite:
      return "not finite";
    case Status::kInterrupted:
      return "interrupted";
    case Status::kCrowded:
      return "crowded";
  }
  return "unknown";
}

StageTimes& StageTimes::operator+=(const StageTimes& other) {
  for (auto stage :
       {&StageTimes::forces, &StageTimes::positions, &StageTimes::assembly, &StageTimes::factorization,
        &StageTimes::velocities, &StageTimes::analysis, &StageTimes::total})
    this->*stage += other.*stage;
  return *this;
}

SolverCounts& SolverCounts::operator+=(const SolverCounts& other) {
  for (auto count : {&SolverCounts::analyses, &SolverCounts::factorizations, &SolverCounts::backsolves,
                     &SolverCounts::refactorizations, &SolverCounts::pivots,
                     &SolverCounts::contact_iterations, &SolverCounts::sweeps})
    this->*count += other.*count;
  return *this;
}

StepWorks& StepWorks::operator+=(const StepWorks& next) {
  for (auto work : {&StepWorks::constraint, &StepWorks::stiffness, &StepWorks::drivers, &StepWorks::forces,
                    &StepWorks::dissipative, &StepWorks::flow})
    this->*work += next.*work;
  return *this;
}

void add_cost(SubstepReport& sum, const SubstepReport& next) {
  sum.newton_iterations += next.newton_iterations;
  sum.counts += next.counts;
  sum.times += next.times;
}

void add_taken(SubstepReport& sum, const SubstepReport& next) {
  add_cost(sum, next);
  sum.substeps += next.substeps;
  sum.works += next.works;
  sum.velocity_residual = next.velocity_residual;
  for (auto largest : {&SubstepReport::tension_number, &SubstepReport::complementarity_residual,
                       &SubstepReport::natural_residual})
    sum.*largest = std::max(sum.*largest, next.*largest);
  if (next.status == Status::kSuccess) return;
  sum.status = next.status;
  sum.message = next.message;
  const auto share = [](const std::vector<Culprit>& all) { return all.empty() ? -1 : all.front().share; };
  if (share(next.culprits) > share(sum.culprits)) sum.culprits = next.culprits;
}

EnergyLedger& EnergyLedger::operator+=(const EnergyLedger& next) {
  for (const LedgerTerm& term : kLedgerTerms) this->*term.amount += next.*term.amount;
  return *this;
}

double EnergyLedger::total() const {
  double sum = 0;
  for (const LedgerTerm& term : kLedgerTerms)
    if (!term.stored) sum += this->*term.amount;
  return sum;
}

}  // namespace taut
