#include "solvers/integrators/impact_stage.h"

#include "solvers/integrators/restitution_search.h"

namespace taut {
namespace {

struct ImpactStageTuning {
  /// Rounds of impacts at one time, at most; in the last nothing bounces.  Chosen.
  static constexpr int kMostRounds = 20;
};

}  // namespace

bool ImpactStage::strike(const Solve& solve) {
  struck_ = true;
  momenta_.assign(phase_.momenta.begin(), phase_.momenta.end());
  mu_ = values_.mu;
  mean_rates_.resize(mu_.size());
  works_.mean_rates(phase_.kicked, phase_.momenta, system_.jacobian(), mean_rates_);
  axes_.record_second_kick(mu_, values_.rates, mean_rates_);
  contacts_.works().record_kick(mu_, mean_rates_);
  for (int round = 1; round <= ImpactStageTuning::kMostRounds; ++round) {
    round_rates_ = values_.rates;
    round_mu_ = values_.mu;
    const double part = round < ImpactStageTuning::kMostRounds ? 1 : 0;
    axes_.begin_round(round_mu_, round_rates_, part);
    if (!solve_round(part, solve)) return false;
    if (energy() > 0 && !limit_restitution(solve)) return false;
    record_round();
    if (!come_together()) break;
  }
  contacts_.end_impacts();
  return true;
}

bool ImpactStage::come_together() const {
  return axes_.impacts().come_together(values_.phi, values_.rates) || contacts_.come_together(values_.rates);
}

/// With this part of the restitution of contacts, against the rates at the start of the round.
bool ImpactStage::solve_round(double part, const Solve& solve) {
  restitution_ = contacts_.begin_impact(round_rates_, round_mu_, part);
  return solve();
}

bool ImpactStage::limit_restitution(const Solve& solve) {
  const RestitutionSearch search{restitution_, [&](double part) { return solve_round(part, solve); },
                                 [this] { return energy(); }};
  return search.run();
}

/// What contacts have given in the round so far [J]: motors may give, and limits by themselves do not.
double ImpactStage::energy() {
  mean_rates_of_round();
  return works_.if_seen(contacts_.works().of_rigid(impulses_since(round_mu_), mean_rates_), phase_.momenta);
}

void ImpactStage::mean_rates_of_round() {
  for (std::size_t r = 0; r < mu_.size(); ++r) mean_rates_[r] = 0.5 * (round_rates_[r] + values_.rates[r]);
}

void ImpactStage::record_round() {
  mean_rates_of_round();
  axes_.record_second_kick(values_.mu, values_.rates, mean_rates_);
  contacts_.works().record_impact(impulses_since(round_mu_), mean_rates_);
}

/// Of axes nothing is left after strike().
void ImpactStage::record(std::span<const double> mu) {
  std::vector<double>& rates = values_.kick_rates;
  works_.mean_rates(phase_.kicked, phase_.momenta, system_.jacobian(), rates);
  axes_.accumulate_work(mu, values_.rates, rates);
  if (!struck_) contacts_.works().record_kick(mu, rates);
}

void ImpactStage::add_works(double h, StepWorks& works) {
  const std::span<const double> J = system_.jacobian();
  works_.add({phase_.state, phase_.kicked, momenta(), J, mu()}, phase_.forces, h, works);
  if (struck_)
    works_.add({phase_.state, momenta_, phase_.momenta, J, impulses_since(mu_)}, phase_.forces, 0, works);
}

std::span<const double> ImpactStage::impulses_since(std::span<const double> before) {
  impulses_.resize(before.size());
  for (std::size_t r = 0; r < before.size(); ++r) impulses_[r] = values_.mu[r] - before[r];
  return impulses_;
}

}  // namespace taut
