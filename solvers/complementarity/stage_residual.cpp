#include "solvers/complementarity/stage_residual.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/common/max_abs.h"

namespace taut {

void StageResidual::begin_positions(double h, double size, std::span<const Twist> twists) {
  h_ = h;
  size_ = size;
  twists_ = twists;
  start_ = round_off_of(twists);
  note_round_off();
}

void StageResidual::begin_velocities(std::span<const Twist> twists) {
  h_ = std::numeric_limits<double>::infinity();
  twists_ = twists;
}

double StageResidual::natural_tolerance() const {
  return contacts_.any() ? ResidualTuning::kMetByContacts : ResidualTuning::kMet;
}

bool StageResidual::exact(const StageSolution& solution) const {
  return contacts_.any() || natural(solution) <= ResidualTuning::kMet;
}

double StageResidual::exact_rate_tolerance() const {
  return Tuning::kNoises * std::min(contact_noise_.angular, contact_noise_.linear);
}

double StageResidual::motion(const StageSolution& solution, double h) const {
  const auto& [laws, b, effective_mass, lambda, rates] = solution;
  LargestResidual largest;
  const double negligible = Tuning::kLevelTolerance * max_abs(lambda);
  for (int r = 0; r < system_.rows().first_contact_row(); ++r)  // those of contacts are linear
    largest.add(
        h * motion_residual(laws[r], delassus_diagonal(effective_mass[r]), lambda[r], rates[r], negligible));
  return largest.size();
}

double StageResidual::natural(const StageSolution& solution) const {
  const double size = scale(solution);
  const Noise noise = contacts_.empty() ? rate_noise() : contact_noise_;
  const RateSize least{contact_noise_.angular / ResidualTuning::kMet,
                       contact_noise_.linear / ResidualTuning::kMet};
  LargestResidual largest;
  for (int k = 0; k < contacts_.count(); ++k)
    largest.add(relative_contact_residual(contacts_, k, solution.lambda, solution.w, size, least));
  for (const Rows::AxisRow& axis : system_.rows().axis_rows())
    largest.add(of_row(axis.row, solution, size, noise));
  return largest.strict_size();
}

double StageResidual::scale(const StageSolution& solution) const {
  const auto& [laws, b, effective_mass, lambda, w] = solution;
  double scale = 0;
  for (int r = 0; r < system_.row_count(); ++r) {
    const double root_mass = effective_mass[r] > 0 ? std::sqrt(effective_mass[r]) : 1;
    scale = std::max({scale, std::abs(lambda[r]) / root_mass, std::abs(b[r]) * root_mass});
  }
  for (const Rows::AxisRow& axis : system_.rows().axis_rows()) {
    const int r = axis.row;
    const double root_mass = effective_mass[r] > 0 ? std::sqrt(effective_mass[r]) : 1,
                 diagonal = 1 / (root_mass * root_mass);
    const RowLaw::Point answer = laws[r].resolve(diagonal, w[r] - diagonal * lambda[r]);
    if (RowLaw::is_vertical(answer.segment)) scale = std::max(scale, root_mass * std::abs(answer.w));
  }
  return scale;
}

double StageResidual::of_row(int r, const StageSolution& solution, double scale, const Noise& noise) const {
  const auto& [laws, b, effective_mass, lambda, w] = solution;
  const double diagonal = delassus_diagonal(effective_mass[r]), root_mass = 1 / std::sqrt(diagonal);
  const double off = natural_residual(laws[r], diagonal, lambda[r], w[r]).size;
  const double least =
      root_mass * (system_.rows().row(r).angular ? noise.angular : noise.linear) / ResidualTuning::kMet;
  return off == 0 ? 0 : off / std::max(scale, least);  // of a world at rest without loads all three are
}

/// What round-off makes of rates in this stage: of poses if they are of positions, and of the speeds that the
/// step began with, of which impulses may have left next to nothing.
StageResidual::Noise StageResidual::rate_noise() const {
  const Noise now = round_off_of(twists_);
  return {std::max(now.angular, start_.angular) + ResidualTuning::kRoundOff / h_,
          std::max(now.linear, start_.linear) + ResidualTuning::kRoundOff * (size_ / h_)};
}

StageResidual::Noise StageResidual::round_off_of(std::span<const Twist> twists) {
  double angular = 0, linear = 0;
  for (const Twist& twist : twists) {
    angular = std::max(angular, twist.w.squaredNorm());
    linear = std::max(linear, twist.v.squaredNorm());
  }
  return {ResidualTuning::kRoundOff * std::sqrt(angular), ResidualTuning::kRoundOff * std::sqrt(linear)};
}

}  // namespace taut
