#include "solvers/complementarity/coupled_rounds.h"

#include <algorithm>

namespace taut {

void CoupledRounds::begin(std::span<const double> y, double residual) {
  hold_ = rounds_ = 0;
  kept_.assign(y.begin(), y.end());
  kept_residual_ = looked_residual_ = residual;
}

bool CoupledRounds::keep(std::span<const double> y, bool met, double residual, double& rho) {
  const bool went_well =
      (met && residual <= Tuning::kWorse * kept_residual_) || residual <= Tuning::kWell * kept_residual_;
  if (!went_well) return false;
  const bool well = residual <= Tuning::kWell * kept_residual_,
             fast = residual <= Tuning::kFast * kept_residual_;
  kept_.assign(y.begin(), y.end());
  kept_residual_ = residual;
  if (!met)
    hold_ = 1;
  else if (hold_ > 0 && well)
    --hold_;
  else
    rho = std::max((fast ? Tuning::kFast : Tuning::kDown) * rho, Tuning::kLeastCoupledRho);
  return true;
}

bool CoupledRounds::grow(double& rho) {
  if (rho >= Tuning::kMostRho) return false;
  rho = std::min(Tuning::kUp * rho, Tuning::kMostRho);
  hold_ = Tuning::kHold;
  return true;
}

bool CoupledRounds::progress() {
  if (++rounds_ % Tuning::kLook != 0) return true;
  if (!(kept_residual_ <= Tuning::kProgress * looked_residual_)) return false;
  looked_residual_ = kept_residual_;
  return true;
}

}  // namespace taut
