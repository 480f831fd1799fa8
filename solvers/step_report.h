#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/diagnostics.h"
#include "core/state.h"
#include "solvers/axis_report.h"
#include "solvers/contact_report.h"

namespace taut {

enum class Status {
  kSuccess,
  kNotConverged,   ///< positions could not be closed down to the smallest sub-step; the state is that before
                   ///< the step
  kContradiction,  ///< some joints cannot hold together: see StepReport::contradiction; state as before the
                   ///< step
  kNotFinite,      ///< a force or a state is not finite; state as before the step
};
std::string_view to_string(Status status);

/// Wall time of the stages of a step [s].
struct StageTimes {
  double forces = 0;
  double positions = 0;  ///< drift, residuals and back-solves of the position stage
  double assembly = 0;   ///< Jacobian and system matrix
  double factorization = 0;
  double velocities = 0;  ///< back-solves of the velocity stage
  double analysis = 0;    ///< ordering and symbolic factorisation; 0 unless the topology changed
  double total = 0;
};

/// Joints that cannot hold together, and the gap that is left when they share it.
struct Contradiction {
  std::vector<JointId> joints;
  double residual = 0;  ///< [m or rad]
};

/// The proof of quality of one step.
struct StepReport {
  Status status = Status::kSuccess;
  std::string message;  ///< empty on success
  double time = 0;      ///< at the end of the step [s]
  double dt = 0;

  Gap gap;                       ///< largest joint error at the end
  double velocity_residual = 0;  ///< largest |J V| [m/s or rad/s]
  int newton_iterations = 0;     ///< position stage, all sub-steps
  int substeps = 0;
  int analyses = 0;
  int factorizations = 0;
  int backsolves = 0;
  int refactorizations = 0;             ///< of these, at a Newton iterate that converged too slowly
  int rank_deficiency = 0;              ///< dependent rows at the end of the step
  double condition_estimate = 0;        ///< of S, from the pivots: a lower bound
  double tension_number = 0;            ///< largest ω h of the sub-steps taken
  int pivots = 0;                       ///< rows that changed their place in the active sets of the step
  double complementarity_residual = 0;  ///< largest of the active sets of the step, relative (active_set.h)
  int splitting_iterations = 0;         ///< of the fall-back for contacts; 0: the active set did it
  int contacts = 0;                     ///< points at the end of the step, touching or near
  double penetration = 0;               ///< deepest of them, ≥ 0 [m]
  StageTimes times;

  // With Settings::report_energy:
  double kinetic_energy = 0, potential_energy = 0;  ///< [J]
  Vec3 linear_momentum = Vec3::Zero();              ///< [N·s]
  Vec3 angular_momentum = Vec3::Zero();             ///< about the world origin [N·m·s]
  double constraint_work = 0;                       ///< of all ideal joints' impulses in this step [J]
  AxisImpulse axis_work;      ///< of motors, friction, limits, springs and dampers of the axes [J]
  ContactWork contact_work;   ///< of contacts [J]
  double stiffness_work = 0;  ///< energy taken by implicit geometric stiffness [J]

  Contradiction contradiction;  ///< with Status::kContradiction

  bool ok() const { return status == Status::kSuccess; }
  double energy() const { return kinetic_energy + potential_energy; }
};

}  // namespace taut
