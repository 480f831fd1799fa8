#pragma once

#include <functional>
#include <span>
#include <vector>

#include "solvers/common/settings.h"
#include "solvers/common/step_report.h"
#include "solvers/integrators/phase.h"
#include "solvers/integrators/row_values.h"
#include "solvers/integrators/start_jacobian.h"
#include "solvers/system/constraint_system.h"

namespace taut {

/// Diagonal of the box around all bodies, but at least 1 m.
double system_size(std::span<const Pose> poses);

/// Positions of dependent rows: how far they are from closed, and closing what the step's own Newton cannot.
/// (solvers/integrators, "Weak directions")
class PositionProjection {
 public:
  /// All of them must outlive it.
  PositionProjection(ConstraintSystem& system, const Settings& settings, StartJacobian& start, Phase& phase,
                     RowValues& values);

  /// How far the bodies are from closed joints, to first order: the largest move in M⁻¹ Jᵀ S_ε⁻¹ φ [m or
  /// rad].  `correction` ← S_ε⁻¹ φ.
  double distance_to_closure(std::span<double> correction, SubstepReport& report);
  /// Closes what the step's own Newton cannot: by impulses with a finer factor, or by moves of the bodies
  /// alone. `drift` makes poses and φ of λ; `far`: the distance to closure [m or rad] that counts as none.
  /// @returns whether φ is within position_tolerance; poses and φ are the best that were found.
  bool close(double h, double far, const std::function<void()>& drift, SubstepReport& report);

 private:
  bool close_light_bodies(double h, double far, const std::function<void()>& drift, SubstepReport& report);
  bool close_by_moves(double h, SubstepReport& report);
  void factorize_finely(SubstepReport& report);

  ConstraintSystem& system_;
  const Settings& settings_;
  StartJacobian& start_;
  Phase& phase_;
  RowValues& values_;
  std::vector<Wrench> move_;  // M times a move of the bodies
  std::vector<Pose> best_;
  std::vector<double> lambda_;  // from before
};

}  // namespace taut
