#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solvers/common/max_abs.h"
#include "solvers/complementarity/stage_solver.h"

// How far a stage is from its laws, and what cannot meet them.  (solvers/complementarity, "Natural residual")
namespace taut {
namespace {

/// Largest natural residual of the laws of axes, and where there are contacts.
constexpr double kNaturalTolerance = 1e-9, kContactTolerance = 1e-8;
/// Impulses on a level of their law are right to this part of the largest.
constexpr double kLevelTolerance = 1e-9;
/// Part of the largest impulse that those who jam have.
constexpr double kJamShare = 1e-3;
/// Of poses and twists, relative.
constexpr double kRateRoundOff = 16 * std::numeric_limits<double>::epsilon();
/// Rates of contacts that are off their laws by so many times what round-off makes of them are let be.
constexpr double kNoises = 10;

}  // namespace

void StageSolver::begin_advance() {
  begin_pass();
  jammed_.clear();
  culprits_.clear();
}

void StageSolver::begin_positions(double h, double size, std::span<const Twist> twists) {
  stage_h_ = h;
  size_ = size;
  twists_ = twists;
  note_round_off();
}

void StageSolver::begin_velocities(std::span<const Twist> twists) {
  stage_h_ = std::numeric_limits<double>::infinity();
  twists_ = twists;
}

double StageSolver::natural_tolerance() const {
  return contacts_.any() ? kContactTolerance : kNaturalTolerance;
}

/// Without contacts no tolerance of rates makes up for the laws of axes.
bool StageSolver::exact(std::span<const double> lambda) const {
  return contacts_.any() || natural_residual(lambda, w_) <= kNaturalTolerance;
}

/// The natural residual over its tolerance; 0 if no better solution is known.
double StageSolver::laws_off(std::span<const double> lambda, std::span<const double> w) const {
  if (stage_residual_ > 0) return 0;
  return natural_residual(lambda, w) / natural_tolerance();
}

/// Rates that laws may be missed by where the tolerances of positions and velocities have let too much pass.
double StageSolver::exact_tolerance() const {
  return kNoises * std::min(contact_noise_.first, contact_noise_.second);
}

/// The laws of a stage are not met any better.  False if that is not enough for an inexact step.
bool StageSolver::take_inexact(double off) {
  stage_residual_ = off * natural_tolerance();
  return stage_residual_ <= settings_.inexact_tolerance;
}

/// Distance of the motion from the laws [m or rad]: of verticals from their rate, of levels from their range,
/// and of impulses from their level by how much they would move the row.
double StageSolver::law_error(std::span<const double> lambda, std::span<const double> rates, double h) const {
  double error = 0, largest = max_abs(lambda);
  for (int r = 0; r < system_.rows().first_contact_row(); ++r) {  // those of contacts are linear
    const RowLaw& law = laws_[r];
    const int segment = active_->segments()[r];
    const double w = rates[r];
    double off = 0;
    if (RowLaw::is_vertical(segment)) {
      off = std::abs(w - law.rate(segment));
    } else {
      off = std::max({0.0, law.first(segment) - w, w - law.last(segment)});
      const double missing = std::abs(lambda[r] - (law.force(segment) - law.slope * w));
      if (missing > kLevelTolerance * largest)
        off = std::max(off, missing / (effective_mass_[r] + law.slope));
    }
    if (!(h * off <= error)) error = h * off;
  }
  return error;
}

/// The natural map of the rows of axes at impulses of the present stage and their rates w, with no tolerance,
/// over the largest of √S_rr |λ_r|, |b_r|/√S_rr and of the rates that their laws impose over √S_rr; with
/// contacts the larger of this and theirs.  b is that of the last solve, in b_.  Nothing is measured by
/// nothing: the scale of a row is at least what round-off of poses and twists makes of its rate, over 1e-9,
/// for contacts of poses in both stages.
double StageSolver::natural_residual(std::span<const double> lambda, std::span<const double> w) const {
  const double scale = natural_scale(lambda, w);
  const auto noise = rate_noise();
  double largest = relative_contact_residual(
      contacts_, lambda, w, scale,
      {contact_noise_.first / kNaturalTolerance, contact_noise_.second / kNaturalTolerance});
  for (const Rows::AxisRow& axis : system_.rows().axis_rows()) {
    const double off = natural_error(axis.row, lambda, w, scale, noise);
    if (!(off <= largest)) largest = off;
  }
  return largest;
}

/// Size of impulses and rates in a stage [√J].
double StageSolver::natural_scale(std::span<const double> lambda, std::span<const double> w) const {
  double scale = 0;
  for (int r = 0; r < system_.row_count(); ++r) {
    const double root = effective_mass_[r] > 0 ? std::sqrt(effective_mass_[r]) : 1;
    scale = std::max({scale, std::abs(lambda[r]) / root, std::abs(b_[r]) * root});
  }
  for (const Rows::AxisRow& axis : system_.rows().axis_rows()) {
    const int r = axis.row;
    const double root = effective_mass_[r] > 0 ? std::sqrt(effective_mass_[r]) : 1, own = 1 / (root * root);
    const RowLaw::Point answer = laws_[r].resolve(own, w[r] - own * lambda[r]);
    if (RowLaw::is_vertical(answer.segment)) scale = std::max(scale, root * std::abs(answer.w));
  }
  return scale;
}

/// Of one row of a joint or a spring.
double StageSolver::natural_error(int r, std::span<const double> lambda, std::span<const double> w,
                                  double scale, const std::pair<double, double>& rate_noise) const {
  const auto [angular, linear] = rate_noise;
  const double root = effective_mass_[r] > 0 ? std::sqrt(effective_mass_[r]) : 1, own = 1 / (root * root);
  const double off = std::abs(lambda[r] - laws_[r].project(own, lambda[r], w[r])) / root;
  const double noise = root * (system_.rows().row(r).angular ? angular : linear) / kNaturalTolerance;
  return off == 0 ? 0 : off / std::max(scale, noise);  // of a world at rest without loads all three are
}

/// A stage is done, inexactly perhaps.
void StageSolver::note_inexact(std::span<const double> lambda, std::span<const double> rates) {
  if (stage_residual_ > worst_stage_residual_) note_culprits(lambda, rates);
  worst_stage_residual_ = std::max(worst_stage_residual_, stage_residual_);
}

/// Who is furthest from the laws of the present stage, for messages: by the natural map over the scale, with
/// no allowance for round-off.
void StageSolver::note_culprits(std::span<const double> lambda, std::span<const double> w) {
  constexpr std::size_t kMost = 4;
  constexpr double kCulpritShare = 0.01;  // of the first
  culprits_.clear();
  const Rows& rows = system_.rows();
  const double scale = natural_scale(lambda, w);
  const auto add = [this](Culprit culprit) {
    if (!(culprit.share <= std::numeric_limits<double>::max()))
      culprit.share = std::numeric_limits<double>::infinity();
    const auto same = std::find_if(culprits_.begin(), culprits_.end(), [&](const Culprit& other) {
      return other.kind == culprit.kind && other.axis == culprit.axis && other.force == culprit.force &&
             other.a == culprit.a && other.b == culprit.b;
    });
    if (same == culprits_.end())
      culprits_.push_back(culprit);
    else
      same->share = std::max(same->share, culprit.share);
    std::stable_sort(culprits_.begin(), culprits_.end(),
                     [](const Culprit& a, const Culprit& b) { return a.share > b.share; });
    if (culprits_.size() > kMost) culprits_.pop_back();
  };
  const auto counts = [&](double off) {
    return !(off <= (culprits_.size() < kMost ? 0 : culprits_.back().share));
  };
  auto axis = rows.axis_rows().begin();
  for (int r = 0; r < rows.first_contact_row(); ++r) {
    while (axis != rows.axis_rows().end() && axis->row < r) ++axis;
    const double off = natural_error(r, lambda, w, scale, {0, 0});
    if (!counts(off)) continue;
    Culprit culprit{.share = off};
    if (const auto* spring = std::get_if<ForceId>(&rows.owner(r))) {
      culprit.kind = Culprit::Kind::kSpring;
      culprit.force = *spring;
    } else {
      const bool is_axis = axis != rows.axis_rows().end() && axis->row == r && axis->axis.axis >= 0;
      culprit.kind = is_axis ? Culprit::Kind::kAxis : Culprit::Kind::kJoint;
      culprit.axis = is_axis ? axis->axis : AxisId{std::get<JointId>(rows.owner(r)), -1};
    }
    add(culprit);
  }
  const std::span<const ContactSet::Place> places = contacts_.set().places();
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (!places[k].active) continue;
    const double off = relative_contact_residual(contacts_, static_cast<int>(k), lambda, w, scale, {});
    if (!counts(off)) continue;
    const auto [a, b] =
        std::minmax(named_->shape(places[k].contact.a).body, named_->shape(places[k].contact.b).body);
    add({.kind = Culprit::Kind::kContact, .a = a, .b = b, .share = off});
  }
  while (!culprits_.empty() && culprits_.back().share < kCulpritShare * culprits_.front().share)
    culprits_.pop_back();
}

/// What round-off makes of rates [rad/s], [m/s] in this stage: of poses if they are of positions.
std::pair<double, double> StageSolver::rate_noise() const {
  double angular = 0, linear = 0;
  for (const Twist& twist : twists_) {
    angular = std::max(angular, twist.w.squaredNorm());
    linear = std::max(linear, twist.v.squaredNorm());
  }
  return {kRateRoundOff * (std::sqrt(angular) + 1 / stage_h_),
          kRateRoundOff * (std::sqrt(linear) + size_ / stage_h_)};
}

/// What a stage ended with, for the report if its sub-step is kept.
void StageSolver::note_residual(std::span<const double> lambda, std::span<const double> rates) {
  natural_ = std::max(natural_, natural_residual(lambda, rates));
}

/// Only for stages of sub-steps that are kept.
void StageSolver::report_residuals(StepReport& report) const {
  report.natural_residual = std::max(report.natural_residual, natural_);
  if (worst_stage_residual_ == 0) return;
  report.status = Status::kInexact;
  report.complementarity_residual = std::max(report.complementarity_residual, worst_stage_residual_);
  const auto share = [](std::span<const Culprit> all) { return all.empty() ? -1 : all.front().share; };
  if (share(culprits_) > share(report.culprits)) report.culprits = culprits_;
  report.message = "the laws of contacts, friction and limits are not met to 1e-8";
}

/// Friction and loads that make each other grow: their impulses have outgrown all others by now.
void StageSolver::note_jam(std::span<const double> lambda) {
  const Rows& rows = system_.rows();
  const auto size = [&](int r) {
    return effective_mass_[r] > 0 ? std::abs(lambda[r]) / std::sqrt(effective_mass_[r]) : 0;
  };
  double largest = 0;
  for (int r = 0; r < rows.first_contact_row(); ++r) largest = std::max(largest, size(r));
  jammed_.clear();
  const std::span<const char> growing = axes_.growing();
  if (std::find(growing.begin(), growing.end(), 1) == growing.end()) return;  // they only settle slowly
  for (std::size_t i = 0; i < rows.axis_rows().size(); ++i) {
    const int r = rows.axis_rows()[i].row;
    if (size(r) >= kJamShare * largest && (growing[i] || axes_.has_unbounded_motor(i))) jammed_.push_back(r);
  }
  for (int r = 0; r < rows.first_contact_row(); ++r)
    if (rows.is_equality(r) && rows.row(r).store->depends_on_time() && size(r) >= kJamShare * largest)
      jammed_.push_back(r);
}

}  // namespace taut
