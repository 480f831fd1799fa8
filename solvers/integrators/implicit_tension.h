#pragma once

#include <span>
#include <vector>

#include "solvers/laws/breaking.h"
#include "solvers/laws/contact_forces.h"
#include "solvers/system/constraint_system.h"
#include "solvers/system/free_parts.h"

namespace taut {

/// Geometric stiffness at the end of the drift instead of at its start, which is stable for any ω h
/// [Tournier2015]: the kick before the drift has M_h = M + h²/2 K⁺ in place of M, K⁺ the positive part of K,
///
///     p ← F p,   F = M M_h⁻¹ body by body,   which keeps the momenta of what nothing ties to fixed bodies
///
/// (FreeParts).  The system's matrix is J M_h⁻¹ Jᵀ meanwhile.                    (solvers/integrators,
/// "Tension")
class ImplicitTension {
 public:
  explicit ImplicitTension(ConstraintSystem& system);

  /// This step has it.
  bool active() const { return active_; }
  void end() { active_ = false; }
  /// For a step of h from these poses: F, and the roots of M_h⁻¹ in the system, which is to be factored then.
  /// Bodies are tied together by joints that have not broken and by contacts.
  void begin(double h, std::span<const Pose> poses, std::span<const StiffnessBlocks> stiffness,
             const Breaking& breaking, const ContactForces& contacts);
  /// Filters the momenta of all bodies at the poses of begin().
  void filter(std::span<const Pose> poses, std::span<Wrench> momenta);

 private:
  void find_free_parts(std::span<const Pose> poses, const Breaking& breaking, const ContactForces& contacts);

  ConstraintSystem& system_;
  bool active_ = false;
  std::vector<Mat3> rotation_, translation_;  // F
  std::vector<char> stiffened_;               // bodies
  std::vector<char> holding_rows_;
  FreeParts free_parts_;
};

}  // namespace taut
