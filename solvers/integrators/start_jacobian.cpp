#include "solvers/integrators/start_jacobian.h"

#include <algorithm>

namespace taut {

StartJacobian::StartJacobian(ConstraintSystem& system) : system_(system) {
  kept_.reserve(system.jacobian().size());
}

bool StartJacobian::keep() {
  if (replaced_) return false;
  kept_.assign(system_.jacobian().begin(), system_.jacobian().end());
  return replaced_ = true;
}

std::size_t StartJacobian::contact_offset() const {
  const Rows& rows = system_.rows();
  if (rows.contact_count() == 0) return rows.jacobian_size();
  return rows.sides()[rows.joints()[rows.contact_joint(0)].first_side].offset;
}

void StartJacobian::mix_into_system() {
  std::span<double> J = system_.change_jacobian();
  for (std::size_t i = 0; i < J.size(); ++i) J[i] = 0.5 * (J[i] + kept_[i]);
  std::copy(kept_.begin() + contact_offset(), kept_.end(), J.begin() + contact_offset());
}

bool StartJacobian::restore() {
  if (!replaced_) return false;
  std::copy(kept_.begin(), kept_.end(), system_.change_jacobian().begin());
  replaced_ = false;
  return true;
}

}  // namespace taut
