#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "scenes/builders/scene.h"
#include "solvers/common/step_report.h"

namespace taut {

class Simulator;

/// Everything that a run is judged by, gathered step by step.
struct RunRecord {
  // What was asked for.
  std::string scene;
  std::map<std::string, double> parameters;
  std::string integrator, solver;
  int bodies = 0;  ///< moving ones
  int joints = 0, constraint_rows = 0;
  double dt = 0, start_time = 0;
  std::int64_t steps_asked = 0;

  // What was done.  Times are wall time [s].
  std::int64_t steps = 0;
  double simulated_time = 0, wall_time = 0;
  std::vector<double> step_times;  ///< of the call of step() alone
  StageTimes phases;               ///< sums over all steps
  std::int64_t analyses = 0, factorizations = 0, refactorizations = 0, backsolves = 0, newton_iterations = 0;
  std::int64_t substeps = 0;
  int max_substeps = 0;  ///< of one step
  int max_rank_deficiency = 0;
  double max_condition_estimate = 0, max_tension_number = 0;
  Gap max_gap;  ///< over all joints and steps
  double max_velocity_residual = 0;

  // Contacts and axes with laws.
  int max_contacts = 0;                     ///< points of one step, touching or near
  double max_penetration = 0;               ///< largest over all steps [m]
  double final_penetration = 0;             ///< of the last step [m]
  double max_complementarity_residual = 0;  ///< largest over all steps, relative
  double max_natural_residual = 0;          ///< likewise, with no tolerance taken off
  std::int64_t inexact_steps = 0;           ///< whose laws were not met to 1e-8
  int asleep = 0;                           ///< bodies, at the end
  std::int64_t pivots = 0, contact_iterations = 0;
  int missing_threads = 0;        ///< that could not be started
  int max_unsupported_pairs = 0;  ///< of shapes near each other that pass through each other, of one step
  std::set<std::pair<ShapeId, ShapeId>> named_pairs;  ///< those that warnings name

  std::uint64_t reactions = 0;    ///< reactions_fingerprint() at the end
  std::uint64_t axis_forces = 0;  ///< axis_forces_fingerprint() at the end

  double initial_energy = 0, final_energy = 0, energy_scale = 0;  ///< [J]
  bool has_scale = true;          ///< else the scale is the largest kinetic energy so far
  double max_energy_drift = 0;    ///< largest |E(t) − E(0)| [J]
  double max_kinetic_energy = 0;  ///< [J]
  bool has_works = true;          ///< the ledger knows works: not at force level, nor without report_energy
  /// Largest |E(t) − E(0) − Σ works of all that acts| [J]: what the method alone has done to the energy.
  double max_unexplained = 0;
  double stiffness_work = 0;    ///< [J]
  EnergyLedger ledger;          ///< sums over all steps, from the start of the first
  double max_ledger_error = 0;  ///< largest |E_start + ledger − E_end| of a step [J]

  /// What the limits and the motor of a free axis came to.
  struct AxisEvents {
    AxisId axis{};
    std::string label;
    std::int64_t limit_steps = 0;  ///< in which a limit held it, or was struck
    std::int64_t saturated_steps = 0;
    bool at_limit = false, saturated = false;  ///< in the last step
  };
  std::vector<AxisEvents> axes;  ///< those that have limits or a motor

  /// The step that missed its laws most, if any did.
  struct WorstStep {
    double time = 0, residual = 0;
    std::vector<std::string> culprits;  ///< by name, those with the largest share first
  };
  WorstStep worst;

  struct Break {
    std::string joint, with;  ///< that it left with, or empty
    double time = 0, force = 0, torque = 0;
  };
  std::vector<Break> breaks;
  std::vector<EventRecord> events;          ///< that happened in this run
  std::string ended_by;                     ///< the event that ended it
  std::vector<std::string> redundant_rows;  ///< by name, of the last step
  struct Held {
    std::string row;
    std::vector<std::string> by;  ///< joints, those with the largest share first
  };
  std::vector<Held> rows_already_held;            ///< redundant rows, in the last pose
  std::vector<std::string> reactions_not_unique;  ///< of joints, by name, in the last pose

  std::string status = "success", message;
  std::vector<std::string> contradiction;  ///< what cannot hold together, by name
  double contradiction_residual = 0;       ///< [m or rad]
  std::vector<std::string> warnings;

  void start(const Scene& scene, int rows, double energy);
  /// Adds what a step cost, and what became of it if its state was taken over.
  /// @param seconds wall time of the call
  /// @param gap largest joint error, measured from the poses after the step
  /// @param energy total energy after the step [J]
  void add(const StepReport& report, double seconds, const Gap& gap, double energy);

  /// Adds a warning where a step met, for the first time, with what no status tells: shapes that pass through
  /// each other, and threads that could not be started.
  /// @return the new warnings
  std::vector<std::string> note_detection(const StepReport& report, const World& world);

  void add_ledger(const StepReport& report);
  /// Who missed the laws of an inexact step, if none missed them more before.
  void note_inexact(const StepReport& report, const World& world);
  /// Axes at limits, and motors that give all they have.
  void note_axes(const Simulator& simulator);
  /// Joints that broke in a step, by name.
  void note_breaks(const StepReport& report, const World& world);
  /// Events that happened in a step, and whether one of them ends the run.
  bool note_events(const StepReport& report);
  /// Who holds redundant rows, and whose reactions are not unique, by name.
  void note_rank(const RankReport& rank, const World& world);

  /// Steps left out of the statistics of time: the first ten, or a third of a very short run.
  std::size_t warm_up_steps() const;
  double median_step_time() const { return step_time_quantile(0.5); }
  /// 0 ≤ p ≤ 1, linear between order statistics; 0 if there were no steps.
  double step_time_quantile(double p) const;
  double relative_energy_drift() const { return energy_scale > 0 ? max_energy_drift / energy_scale : 0; }
  /// What max_unexplained is judged by [J]: the largest of energy_scale, the kinetic energy, and the work of
  /// any kind.
  double balance_scale() const;
  double relative_unexplained() const;
};

/// FNV-1a over the bits of time, poses and twists: equal for equal states and nothing else that matters.
std::uint64_t fingerprint(const State& state);
/// Likewise of the mean reactions of all joints and the forces of all contacts over the last step.
std::uint64_t reactions_fingerprint(const Simulator& simulator);
/// … and of the mean forces along all axes, part by part.
std::uint64_t axis_forces_fingerprint(const Simulator& simulator);

}  // namespace taut
