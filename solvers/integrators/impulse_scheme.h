#pragma once

#include <span>
#include <vector>

#include "core/world/world.h"
#include "solvers/common/settings.h"
#include "solvers/common/step_report.h"
#include "solvers/complementarity/stage_solver.h"
#include "solvers/integrators/contact_pattern.h"
#include "solvers/integrators/force_iteration.h"
#include "solvers/integrators/impact_stage.h"
#include "solvers/integrators/kick_works.h"
#include "solvers/integrators/multiplier_guess.h"
#include "solvers/integrators/multiplier_prediction.h"
#include "solvers/integrators/phase.h"
#include "solvers/integrators/row_values.h"
#include "solvers/integrators/scheme.h"
#include "solvers/integrators/step_limit.h"
#include "solvers/integrators/velocity_projection.h"
#include "solvers/system/constraint_system.h"

namespace taut {

/// What schemes at the level of impulses have in common: bodies with momenta, rows with laws, contacts that
/// come and go with their rows, and a velocity stage.  RATTLE (rattle.h) and Moreau–Jean (moreau_jean.h) say
/// how a step is made of these.                                          (solvers/integrators, "RATTLE")
class ImpulseScheme : public Scheme {
 public:
  ImpulseScheme(const World& world, ConstraintSystem& system, const Settings& settings);

  /// Takes over a state: factors S there, makes given velocities tangent and estimates the multipliers.
  void start(const State& state, Velocities velocities, SubstepReport& report) override;
  void restart(const State& state, Velocities velocities, SubstepReport& report) override;
  void go_back(const State& state, std::span<const double> impulses, SubstepReport& report) override;
  void begin(double dt) override;
  void accept_inexact(double residual, bool soon) override { stages_.accept_inexact(residual, soon); }
  bool drop_guess() override;

  // Between steps.
  void prepare(double horizon, std::vector<ContactStretch> stretches, Scheme* old) override;
  void forget(std::span<const char> moved) override;
  bool renew_forces() override;
  void set_time(double time) override { phase_.set_time(time); }
  void inherit(const Scheme& old) override;

  // What the last step came to.
  double step_limit() const override { return limit_.step(); }
  const State& state() const override { return phase_.state; }
  std::span<const Wrench> momenta() const override { return phase_.momenta; }
  /// Summed over the advances of the step.
  std::span<const double> impulses() const override { return values_.impulses; }
  std::span<const double> known_residual() const override;
  std::span<const double> forces_of_laws() const override;
  int missing_threads() const override { return stages_.missing_threads(); }

  // For diagnoses.
  const RowValues& values() const { return values_; }
  StageSolver& stages() { return stages_; }
  /// Poses of the last Newton iterate; φ there is values().phi.
  const std::vector<Pose>& trial_poses() const { return phase_.trial_poses; }
  /// The body whose tension asks for the shortest step.
  BodyId stiffest() const { return limit_.stiffest(); }
  /// The body on which forces changed most when they did not settle in the last advance; else the ground.
  BodyId unsettled() const { return force_iteration_.unsettled(); }

  void transfer(Archive& archive) override;

 protected:
  /// Rows have laws of their own, or are to be solved one by one.
  bool bounded() const { return stages_.bounded(); }
  bool struck() const { return axes_.struck() || contacts_.struck(); }

  void find_contacts();
  void linearize(SubstepReport& report);
  void linearize_and_factorize(SubstepReport& report);
  void renew_laws();
  void project_momenta(double h, SubstepReport& report);
  void note_velocities(std::span<const double> mu, SubstepReport& report);
  ForceIteration::Fixed renew_kick_forces(const State& at);
  void finish_laws(std::span<const double> mu);
  void roll_back(SubstepReport& report);
  void update_step_limit() { limit_.update(phase_.state, values_.force_multipliers); }

  const World& world_;
  ConstraintSystem& system_;
  const Settings& settings_;
  Phase phase_;
  StageSolver stages_;
  RowValues values_;
  StepLimit limit_;
  KickWorks works_;
  MultiplierPrediction prediction_;
  VelocityProjection projection_;
  ContactPattern contact_pattern_;
  ImpactStage impact_stage_;
  ForceIteration force_iteration_;
  std::vector<Wrench> last_forces_;  // of the pass before
  /// For the rest of the step contacts are planes, since a sub-step failed with surfaces as they are.
  bool flattened_ = false;

 private:
  void predict_forces();
  void start_axes();
  void take(const MultiplierGuess& guess);
};

}  // namespace taut
