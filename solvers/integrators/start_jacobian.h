#pragma once

#include <span>
#include <vector>

#include "solvers/system/constraint_system.h"

namespace taut {

/// J(q₀) through the position stage of a step: λ acts along it, while the system may have the Jacobian of an
/// iterate instead, with which its factor is a better one.
class StartJacobian {
 public:
  explicit StartJacobian(ConstraintSystem& system);

  /// To be called before the system gets another one in this step.  False if it has got one already.
  bool keep();
  std::span<const double> get() const { return replaced_ ? kept_ : system_.jacobian(); }
  /// The system's is that of the mean of J(q₀) and J(q₁), but for contacts, which belong to the start.
  void mix_into_system();
  /// The system has J(q₀) again, or another step begins with the Jacobian that it has.  False if it has had
  /// no other.
  bool restore();
  void end() { replaced_ = false; }

 private:
  std::size_t contact_offset() const;

  ConstraintSystem& system_;
  bool replaced_ = false;
  std::vector<double> kept_;
};

}  // namespace taut
