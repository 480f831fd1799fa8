#pragma once

#include <vector>

#include "solvers/common/settings.h"
#include "solvers/common/step_report.h"
#include "solvers/integrators/phase.h"
#include "solvers/integrators/row_values.h"
#include "solvers/laws/breaking.h"
#include "solvers/system/constraint_system.h"

namespace taut {

class Archive;

/// Joints without laws at the level of velocities: μ with J M⁻¹ (p + Jᵀμ) + φ_t = 0, refined until
/// |J V + φ_t| is within its tolerance.  It is in the range of S, also with dependent rows.
///
/// Each pass leaves the part ε/(σ + ε) of a rate along a direction that rows hold weakly, and next to nothing
/// of all others.  If one smooth direction is left, as that of a long bridge, that part hardly changes from
/// step to step, and the geometric series is summed up in the second pass.  (solvers/integrators, "RATTLE")
class VelocityProjection {
 public:
  /// All of them must outlive it.
  VelocityProjection(ConstraintSystem& system, const Settings& settings, const Breaking& breaking,
                     Phase& phase, RowValues& values);

  /// Momenta, twists and μ.  With h ≠ 0 the momenta are those after the second kick of h without μ.
  /// @returns whether the rates are within velocity_tolerance; report.velocity_residual is what is left.
  bool project(double h, SubstepReport& report);
  /// Rates are within velocity_tolerance, or what is left of them is so little along directions that
  /// dependent rows hold weakly that no projection would go on.
  bool accepts(double velocity_residual) const;
  /// Zero in rows that hold nothing by themselves: of axes, soft joints, contacts, and joints that broke.
  void clear_loose_rows(std::span<double> rows) const;

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive);

 private:
  template <typename Change>
  void twists_and_rates(Change change);
  void push(std::span<const double> impulses, double by);
  bool refine(double sum, SubstepReport& report);
  void project_by_descent(SubstepReport& report);
  double doubled_kinetic_energy() const;
  void descend(SubstepReport& report);
  void watch_contraction(double sum);

  ConstraintSystem& system_;
  const Settings& settings_;
  const Breaking& breaking_;
  Phase& phase_;
  RowValues& values_;
  std::vector<double> last_rates_;  // of rows, before the second pass
  double contraction_ = 0;          // part of them that it leaves
  int steady_count_ = 0;            // sub-steps in which that was the same
};

}  // namespace taut
