#include "solvers/integrators/multiplier_prediction.h"

#include "solvers/common/move_rows.h"

namespace taut {
namespace {

struct MultiplierPredictionTuning {
  /// Steps in which dependent rows start from no impulse after velocities that were not exact.  Chosen.
  static constexpr int kStepsFromZero = 100;
};

}  // namespace

MultiplierPrediction::MultiplierPrediction(int rows) {
  for (auto* values : {&mu_, &asymmetry_, &last_asymmetry_}) values->assign(rows, 0.0);
}

void MultiplierPrediction::start() {
  std::fill(mu_.begin(), mu_.end(), 0.0);
  restart();
}

void MultiplierPrediction::repeat(double h, int count, std::span<double> lambda) const {
  const double scale = history_ > 0 ? h / last_h_ : 0;
  for (int r = 0; r < count; ++r) lambda[r] = scale * mu_[r];
}

void MultiplierPrediction::extrapolate(double h, std::span<double> lambda) const {
  const double scale = h / last_h_, h2 = h * h;
  const double a = history_ >= 3 ? 2 : history_ == 2 ? 1 : 0, b = history_ >= 3 ? -1 : 0;
  for (std::size_t r = 0; r < lambda.size(); ++r)
    lambda[r] = scale * mu_[r] + h2 * (a * asymmetry_[r] + b * last_asymmetry_[r]);
}

bool MultiplierPrediction::takes_from_dependent_rows() {
  const bool exact = cold_start_steps_ == 0;
  cold_start_steps_ = std::max(cold_start_steps_ - 1, 0);
  return exact;
}

void MultiplierPrediction::start_from_zero() {
  cold_start_steps_ = MultiplierPredictionTuning::kStepsFromZero;
}

void MultiplierPrediction::keep(double h, std::span<const double> lambda, std::span<const double> mu,
                                bool struck) {
  const double scale = history_ > 0 ? h / last_h_ : 1, per_h = 1 / h, per_h2 = per_h * per_h;
  for (std::size_t r = 0; r < lambda.size(); ++r) {
    last_asymmetry_[r] = asymmetry_[r];
    asymmetry_[r] = (lambda[r] - scale * mu_[r]) * per_h2;
    mu_[r] = mu[r];
  }
  history_ = struck ? 0 : std::min(history_ + 1, 3);
  last_h_ = h;
}

void MultiplierPrediction::clear(std::span<const int> rows) {
  for (auto* values : {&mu_, &asymmetry_, &last_asymmetry_})
    for (int r : rows) (*values)[r] = 0;
}

void MultiplierPrediction::move_rows(std::span<const int> from) {
  for (auto* values : {&mu_, &asymmetry_, &last_asymmetry_}) taut::move_rows(from, 0.0, *values);
}

}  // namespace taut
