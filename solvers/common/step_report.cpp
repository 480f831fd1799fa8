#include "solvers/common/step_report.h"

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
