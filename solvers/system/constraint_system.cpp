#include "solvers/system/constraint_system.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/base/interruption.h"
#include "solvers/common/stopwatch.h"
#include "solvers/linear/cholmod_factor.h"
#include "solvers/linear/multifrontal_factor.h"

namespace taut {
namespace {

/// Full-rank factorisations after which the shift is dropped again.
constexpr int kStreak = 100;

}  // namespace

std::unique_ptr<Factor> make_factor(FactorChoice choice, const BlockOrdering& ordering) {
  using Method = CholmodFactor::Method;
  // CHOLMOD's own switch: dense kernels pay from about 40 flops per entry of L.
  if (choice == FactorChoice::kCholmod)
    choice = ordering.flops >= 40 * ordering.nonzeros ? FactorChoice::kSupernodal : FactorChoice::kSimplicial;
  switch (choice) {
    case FactorChoice::kSimplicial:
      return std::make_unique<CholmodFactor>(Method::kSimplicial);
    case FactorChoice::kSupernodal:
      // Without CHOLMOD's GPL modules its simplicial factor does the same work; name() tells which it is.
      return std::make_unique<CholmodFactor>(CholmodFactor::has_supernodal() ? Method::kSupernodal
                                                                             : Method::kSimplicial);
    default:
      return std::make_unique<MultifrontalFactor>();
  }
}

ConstraintSystem::ConstraintSystem(const World& world, FactorChoice choice, RankTolerance tolerance,
                                   Rows::AxisRows axis_rows, Springs springs)
    : choice_(choice),
      axis_rows_(axis_rows),
      springs_(springs),
      rows_(world, axis_rows, {}, Rows::Joints::kMoving, springs, Rows::Blocks::kLeverArms),
      mass_(world),
      tolerance_(tolerance) {
  for (const Rows::AxisRow& row : rows_.axis_rows())
    rubbing_axes_ += row.axis.axis >= 0 && world.axis_properties(row.axis).friction.has_value();
  analyze();
  counted_shift_ = tolerance.shift;
}

void ConstraintSystem::set_contact_places(const World& world, std::span<const Rows::ContactPlace> places) {
  rows_ = Rows(world, axis_rows_, places, Rows::Joints::kMoving, springs_, Rows::Blocks::kLeverArms);
  states_.clear();
  factored_states_.clear();
  for (auto* rows : {&dependent_rows_, &counted_rows_})  // those of joints are the same rows still
    std::erase_if(*rows, [this](int row) { return row >= rows_.first_contact_row(); });
  ++factor_version_, ++body_factor_version_;
  analyze();
}

void ConstraintSystem::analyze_rows() {
  const BlockOrdering ordering = order_blocks(joint_graph(rows_, mass_));
  factor_ = make_factor(choice_, ordering);
  system_ = std::make_unique<DelassusMatrix>(rows_, mass_, ordering, factor_->triangle());
  factor_->analyze(system_->matrix());
  const int n = rows_.row_count();
  ordered_.assign(n, 0.0);
  row_at_position_.resize(n);
  for (int r = 0; r < n; ++r) row_at_position_[system_->position_of_row()[r]] = r;
}

void ConstraintSystem::analyze() {
  {
    const Stopwatch watch(analysis_time_);
    bodies_.reset();
    body_ordering_.reset();
    through_bodies_ = bodies_pay();
    if (!through_bodies_) {
      analyze_rows();
      ++counters_.analyses;
    }
  }
  make_room();
}

void ConstraintSystem::make_room() {
  const int n = rows_.row_count();
  jacobian_.assign(rows_.jacobian_size(), 0.0);
  weighted_.assign(rows_.whole_size(), 0.0);
  inertias_.assign(n, 0.0);
  weighted_current_ = inertias_current_ = assembled_ = false;
  roots_.resize(rows_.body_count());
  scratch_.assign(n, 0.0);
  body_values_.assign(6 * static_cast<std::size_t>(rows_.body_count()), 0.0);
  dependent_rows_.reserve(n);
  counted_rows_.reserve(n);
  large_pivots_.reserve(n);
  states_.reserve(n);
  factored_states_.reserve(n);
  masked_weighted_.reserve(weighted_.size());
}

void ConstraintSystem::linearize(const Configuration& at) {
  rows_.jacobian(at, jacobian_);
  factored_ = weighted_current_ = assembled_ = false;
}

/// Rows have no laws of their own, and S no shift so far.
bool ConstraintSystem::joints_alone() const {
  return !through_bodies_ && rows_.axis_rows().empty() && rows_.contact_count() == 0 && states_.empty() &&
         compliance_ == 0 && !shift_next_;
}

void ConstraintSystem::linearize_and_assemble(const Configuration& at) {
  full_roots_.clear();
  factored_ = weighted_current_ = false;
  assembled_ = joints_alone();
  for (const Rows::BodyChunk& chunk : rows_.chunks()) {
    rows_.jacobian(at, jacobian_, chunk);
    set_mass(at.poses, chunk.begin, chunk.end);
    if (assembled_) system_->assemble(rows_, jacobian_, roots_, chunk.settled_begin, chunk.settled_end);
  }
}

/// W of J and the roots.
void ConstraintSystem::weight() {
  if (weighted_current_) return;
  if (full_roots_.empty())
    DelassusMatrix::weight<InverseMassRoot>(rows_, jacobian_, roots_, weighted_);
  else
    DelassusMatrix::weight<FullMassRoot>(rows_, jacobian_, full_roots_, weighted_);
  weighted_current_ = true;
  inertias_current_ = false;
  ++weight_version_;
}

void ConstraintSystem::set_mass(std::span<const Pose> poses) {
  full_roots_.clear();
  weighted_current_ = assembled_ = false;
  set_mass(poses, 0, mass_.size());
}

void ConstraintSystem::set_mass(std::span<const Pose> poses, int begin, int end) {
  for (int b = begin; b < end; ++b) {
    const MassMatrix::Body& body = mass_[b];
    if (body.fixed) continue;
    roots_[b] = {mass_.principal_axes(b, poses[b]) * body.root_inverse_moments.asDiagonal(),
                 std::sqrt(body.inverse_mass)};
  }
}

std::span<FullMassRoot> ConstraintSystem::use_full_roots() {
  weighted_current_ = assembled_ = false;
  full_roots_.resize(roots_.size());
  return full_roots_;
}

void ConstraintSystem::assemble_and_factorize(StageTimes& times) {
  detail::poll_interrupt();
  factored_states_ = states_;
  ++factor_version_;
  if (through_bodies_) {
    compliance_of_bodies();
    usable_ = factorize_bodies(weighted_, inverse_compliance_, times);
    factored_ = true;
    return;
  }
  if (!(assembled_ && joints_alone() && !shifted_)) {
    const Stopwatch watch(times.assembly);
    assembled_ = false;
    if (!states_.empty()) {
      weight();
      mask_weighted();
      system_->assemble(rows_, masked_weighted_, factored_shift(), states_);
    } else if (full_roots_.empty()) {
      system_->assemble<InverseMassRoot>(rows_, jacobian_, roots_, factored_shift());
    } else {
      system_->assemble<FullMassRoot>(rows_, jacobian_, full_roots_, factored_shift());
    }
  }
  const Stopwatch watch(times.factorization);
  factored_ = true;
  ++counters_.factorizations;
  usable_ = factor_->factorize(system_->matrix()) < 0;
  dependent_rows_.clear();
  if (usable_) inspect_pivots();
}

void ConstraintSystem::set_row_states(std::span<const double> states) {
  assert(states.empty() || states.size() == scratch_.size());
  const bool all_free = std::all_of(states.begin(), states.end(), [](double s) { return s == 0; });
  states_.assign(states.begin(), all_free ? states.begin() : states.end());
}

void ConstraintSystem::release_bounded_rows() {
  const bool any = !rows_.axis_rows().empty() || rows_.contact_count() > 0;
  states_.assign(any ? rows_.row_count() : 0, 0.0);
  for (const Rows::AxisRow& axis : rows_.axis_rows()) states_[axis.row] = kMasked;
  if (any) std::fill(states_.begin() + rows_.first_contact_row(), states_.end(), kMasked);
}

void ConstraintSystem::clear_bounded_rows(std::span<double> values) const {
  for (const Rows::AxisRow& axis : rows_.axis_rows()) values[axis.row] = 0;
  std::fill(values.begin() + rows_.first_contact_row(), values.end(), 0.0);
}

void ConstraintSystem::turn_tangents(int place, row_parts::ContactPoint& point, double cos, double sin) {
  const Vec3 t1 = cos * point.frame.t1 + sin * point.frame.t2;
  point.frame.t2 = cos * point.frame.t2 - sin * point.frame.t1;
  point.frame.t1 = t1;
  rows_.set_contact(place, point);
  weighted_current_ = false;
  const Rows::JointRows& rows = rows_.joints()[rows_.contact_joint(place)];
  for (int s = rows.first_side; s < rows.first_side + rows.side_count; ++s)
    for (int first = 1; first < rows.row_count; first += 3) {
      double* J1 = jacobian_.data() + rows_.sides()[s].offset + 6 * first;
      for (int k = 0; k < 6; ++k) {
        const double a = J1[k], b = J1[6 + k];
        J1[k] = cos * a + sin * b;
        J1[6 + k] = cos * b - sin * a;
      }
    }
}

/// A copy of W whose masked rows are zero: S of it has the pattern of S and only a diagonal there.
void ConstraintSystem::mask_weighted() {
  masked_weighted_ = weighted_;
  for (const Rows::Side& side : rows_.sides())
    for (int i = 0; i < side.row_count; ++i)
      if (states_[side.first_row + i] == kMasked)
        std::fill_n(masked_weighted_.begin() + side.whole + 6 * i, 6, 0.0);
}

void ConstraintSystem::factorize(StageTimes& times) {
  if (!rows_.axis_rows().empty() || rows_.contact_count() > 0 || through_bodies_) {  // others ask for W
    const Stopwatch watch(times.assembly);
    weight();
  }
  shifted_ = shift_next_;
  assemble_and_factorize(times);
  if (through_bodies_) return;
  if (!shifted_ && (!usable_ || !dependent_rows_.empty())) {
    shifted_ = shift_next_ = true;
    full_rank_streak_ = 0;
    assemble_and_factorize(times);
    return;
  }
  full_rank_streak_ = dependent_rows_.empty() ? full_rank_streak_ + 1 : 0;
  if (full_rank_streak_ >= kStreak) shift_next_ = false;
  if (shifted_ && states_.empty() && tolerance_.shift == counted_shift_) keep_count(times);
}

/// The exact count takes two more factorisations: only where the number of small pivots has changed.
void ConstraintSystem::keep_count(StageTimes& times) {
  const int small = rank_deficiency();
  if (small != small_pivots_) {
    small_pivots_ = small;
    factorize_for_counting(times);
    counted_rows_ = dependent_rows_;
    assemble_and_factorize(times);
  }
  dependent_rows_ = counted_rows_;
}

/// The pivot of a dependent row is a multiple of the shift, and the multiple grows with the length of the
/// dependence: 10⁸ ε for a bridge of 1000 hinges.  No threshold tells such pivots from small independent
/// ones, but two shifts do: the former follow the shift, the latter stay.
void ConstraintSystem::factorize_for_counting(StageTimes& times) {
  const double shift = tolerance_.shift;
  shifted_ = shift_next_ = true;
  assemble_and_factorize(times);
  large_pivots_.assign(factor_->relative_pivots().begin(), factor_->relative_pivots().end());
  tolerance_.shift = shift / 16;
  assemble_and_factorize(times);
  tolerance_.shift = shift;
  dependent_rows_.clear();
  if (!usable_) return;
  const std::span<const double> pivots = factor_->relative_pivots();
  for (std::size_t i = 0; i < pivots.size(); ++i)
    if (pivots[i] < 0.5 * large_pivots_[i]) dependent_rows_.push_back(row_at_position_[i]);
}

void ConstraintSystem::inspect_pivots() {
  double smallest = 1, largest = 0;
  const std::span<const double> pivots = factor_->relative_pivots();
  for (std::size_t i = 0; i < pivots.size(); ++i) {
    const double ratio = pivots[i];
    if (!(ratio > tolerance_.dependent)) {
      dependent_rows_.push_back(row_at_position_[i]);
      continue;
    }
    smallest = std::min(smallest, ratio);
    largest = std::max(largest, ratio);
  }
  condition_ = largest > 0 ? largest / smallest : 1;
}

void ConstraintSystem::backsolve(std::span<double> x) {
  if (through_bodies_) return solve_primal(x);
  ++counters_.backsolves;
  const std::span<const int> position = system_->position_of_row();
  for (std::size_t r = 0; r < x.size(); ++r) ordered_[position[r]] = x[r];
  factor_->solve(ordered_);
  for (std::size_t r = 0; r < x.size(); ++r) x[r] = ordered_[position[r]];
}

void ConstraintSystem::solve(std::span<double> x) {
  if (!usable_) {
    std::fill(x.begin(), x.end(), std::numeric_limits<double>::quiet_NaN());
    return;
  }
  const std::span<const double> states = factored_states_;
  for (std::size_t r = 0; r < states.size(); ++r)
    if (states[r] == kMasked) x[r] = 0;
  backsolve(x);
  if (shifted_) project(x);
}

void ConstraintSystem::effective_masses(std::span<double> out) {
  weight();
  if (!inertias_current_) sum_inertias();
  std::copy(inertias_.begin(), inertias_.end(), out.begin());
}

void ConstraintSystem::sum_inertias() {
  for (const Rows::Side& side : rows_.sides()) {
    const bool first = &side == &rows_.sides()[rows_.joints()[side.block].first_side];
    for (int i = 0; i < side.row_count; ++i) {
      const double own =
          mass_[side.body].fixed
              ? 0
              : Eigen::Map<const Eigen::Matrix<double, 6, 1>>(weighted_.data() + side.whole + 6 * i)
                    .squaredNorm();
      double& sum = inertias_[side.first_row + i];
      sum = first ? own : sum + own;
    }
  }
  for (double& s : inertias_) s = s > 0 ? 1 / s : 0;
  inertias_current_ = true;
}

void ConstraintSystem::multiply(std::span<const double> x, std::span<double> out) {
  to_bodies(x, body_values_);
  to_rows(body_values_, out);
}

void ConstraintSystem::rates(std::span<const double> lambda, std::span<const double> b, std::span<double> w) {
  multiply(lambda, w);
  for (std::size_t r = 0; r < w.size(); ++r) w[r] += b[r];
}

}  // namespace taut
