#include "solvers/system/constraint_system.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <utility>

#include "core/base/interruption.h"
#include "solvers/common/stopwatch.h"

namespace taut {

ConstraintSystem::ConstraintSystem(const World& world, FactorChoice choice, RankTolerance tolerance,
                                   Rows::AxisRows axis_rows, Springs springs, const FactorMeans& means)
    : LinearizedRows(world, axis_rows, springs, means.threads),
      factor_choice_(choice),
      means_(means),
      choice_(world, rows()),
      primal_(choice, means),
      rank_(tolerance) {
  analyze();
}

ConstraintSystem::ConstraintSystem(const ConstraintSystem& whole, const SystemPart& part,
                                   std::vector<int>& new_body)
    : LinearizedRows(whole, part, new_body),
      factor_choice_(whole.factor_choice_),
      primal_(whole.factor_choice_),
      rank_(whole.rank_.tolerance()) {
  analyze_primal();
  choice_.decide(*this, primal_);
  scratch_.assign(row_count(), 0.0);
}

void ConstraintSystem::set_contact_slots(const World& world, std::span<const Rows::ContactSlot> slots) {
  remake_rows(world, slots);
  states_.clear();
  factored_.states.clear();
  rank_.forget_rows_from(rows().first_contact_row());  // those of joints are the same rows still
  ++factored_.version;
  primal_.forget_pattern();
  analyze();
}

/// The choice for this pattern, and the analysis of S; that of P follows when it is wanted.
void ConstraintSystem::analyze() {
  {
    const Stopwatch watch(counters_.analysis_time);
    choice_.decide(*this, primal_);
    if (uses_primal_system()) {
      delassus_.reset();
      rank_.forget();
    } else {
      delassus_ = std::make_unique<DelassusSystem>(*this, factor_choice_, means_);
      ++counters_.analyses;
    }
  }
  const int n = row_count();
  scratch_.assign(n, 0.0);
  rank_.reserve(n);
  states_.reserve(n);
  factored_.states.reserve(n);
}

void ConstraintSystem::analyze_primal() {
  if (primal_.analyzed()) return;
  const Stopwatch watch(counters_.analysis_time);
  primal_.analyze(*this);
  ++counters_.analyses;
}

void ConstraintSystem::take_counters(ConstraintSystem& part) {
  const WorkCounters work = std::exchange(part.counters_, {});
  counters_.analyses += work.analyses;
  counters_.factorizations += work.factorizations;
  counters_.backsolves += work.backsolves;
  counters_.analysis_time += work.analysis_time;
}

void ConstraintSystem::set_row_states(std::span<const double> states) {
  assert(states.empty() || std::ssize(states) == row_count());
  states_.set(states);
}

/// Rows have no laws of their own, and S no shift so far.
bool ConstraintSystem::joints_alone() const {
  return !uses_primal_system() && !has_bounded_rows() && states_.all_free() && compliance_ == 0 &&
         !rank_.shifts();
}

void ConstraintSystem::linearize_and_assemble(const Configuration& at) {
  if (joints_alone())
    linearize_by_chunks(at, [this](const Rows::BodyChunk& chunk) { delassus_->assemble(*this, chunk); });
  else
    linearize_by_chunks(at, [](const Rows::BodyChunk&) {});
}

bool ConstraintSystem::has_delassus_factor() const { return factored() && usable() && !uses_primal_system(); }

void ConstraintSystem::factorize(StageTimes& times) {
  factored_.shifted = rank_.shifts();
  factorize_once(times);
  if (uses_primal_system()) return;
  if (!factored_.shifted && (!usable() || rank_deficiency() > 0)) {
    rank_.found_dependence();
    factored_.shifted = true;
    factorize_once(times);
    return;
  }
  rank_.found_rank();
  if (factored_.shifted && states_.all_free() && rank_.counts()) update_count(times);
}

/// The exact count takes two more factorisations: only where the number of small pivots has changed.
void ConstraintSystem::update_count(StageTimes& times) {
  if (rank_.small_pivots_changed()) {
    factorize_for_counting(times);
    rank_.keep_count();
    factorize_once(times);
  }
  rank_.use_kept_count();
}

void ConstraintSystem::factorize_for_counting(StageTimes& times) {
  const double shift = rank_.shift();
  rank_.demand_shift();
  factored_.shifted = true;
  factorize_once(times);
  rank_.begin_count(delassus_->relative_pivots());
  rank_.set_shift(RankTuning::kSecondShift * shift);
  factorize_once(times);
  rank_.set_shift(shift);
  if (usable()) rank_.end_count(delassus_->relative_pivots(), delassus_->row_at_position());
}

/// The factor for the present states, with a shift if factored_.shifted says so.
void ConstraintSystem::factorize_once(StageTimes& times) {
  if (has_bounded_rows() || uses_primal_system()) {  // others ask for W
    const Stopwatch watch(times.assembly);
    (void)weighted();
  }
  detail::poll_interrupt();
  factored_.states = states_;
  ++factored_.version;
  if (uses_primal_system())
    factorize_primal(times);
  else
    factorize_delassus(times);
  factored_.linearization = linearization();
}

/// With the shift unless no row is free.
void ConstraintSystem::factorize_primal(StageTimes& times) {
  factored_.shifted = states_.any_free();
  const std::span<const double> D = primal_.regularize(*this, states_, factored_shift());
  factored_.usable = factorize_bodies(weighted(), D, times);
}

void ConstraintSystem::factorize_delassus(StageTimes& times) {
  {
    const Stopwatch watch(times.assembly);
    delassus_->assemble(*this, states_, factored_shift());
  }
  const Stopwatch watch(times.factorization);
  ++counters_.factorizations;
  factored_.usable = delassus_->factorize();
  rank_.forget_rows();
  if (usable()) rank_.inspect(delassus_->relative_pivots(), delassus_->row_at_position());
}

bool ConstraintSystem::factorize_bodies(std::span<const double> weighted, std::span<const double> D,
                                        StageTimes& times) {
  detail::poll_interrupt();
  analyze_primal();
  if (uses_primal_system()) factored_.linearization = -1;
  ++counters_.factorizations;
  return primal_.factorize(weighted, D, times);
}

void ConstraintSystem::solve_bodies(std::span<double> v) {
  primal_.solve(v);
  ++counters_.backsolves;
}

void ConstraintSystem::solve_shifted(std::span<double> x) {
  ++counters_.backsolves;
  if (uses_primal_system())
    primal_.solve_rows(*this, x);
  else
    delassus_->solve(x);
}

void ConstraintSystem::project(std::span<double> x) {
  multiply(x, scratch_);
  factored_.states.add_compliance(x, scratch_);
  std::copy(scratch_.begin(), scratch_.end(), x.begin());
  solve_shifted(x);
}

void ConstraintSystem::solve(std::span<double> x) {
  if (!usable()) {
    std::fill(x.begin(), x.end(), std::numeric_limits<double>::quiet_NaN());
    return;
  }
  factored_.states.clear_masked(x);
  solve_shifted(x);
  if (factored_.shifted) project(x);
}

}  // namespace taut
