#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/merging/merged_world.h"
#include "solvers/common/setting_checks.h"
#include "solvers/integrators/composition.h"
#include "solvers/integrators/force_level.h"
#include "solvers/integrators/impulse_scheme.h"
#include "solvers/simulator/energy_accounting.h"
#include "solvers/simulator/simulator.h"
#include "solvers/simulator/sleep.h"
#include "solvers/simulator/substeps.h"
#include "solvers/simulator/weld_loads.h"
#include "solvers/system/constraint_system.h"

namespace taut {

class Archive;

/// What the methods of Simulator work with; simulator.cpp steps, simulator_reactions.cpp answers what joints
/// bear, simulator_diagnosis.cpp says why a step failed.
class Simulator::Impl {
 public:
  Impl(World& world, const Settings& settings)
      : source_(world),
        merged_(settings.merge_fixed_joints
                    ? std::make_unique<MergedWorld>(world, settings.position_tolerance)
                    : nullptr),
        world_(merged_ ? merged_->world() : world),
        settings_(settings) {
    check_settings(settings);
    source_.wake_all(), world_.wake_all();  // who sleeps is known to the simulator that let them
    if (settings.sleep) sleep_.emplace(world_, settings);
    if (settings_.drift_cure != DriftCure::kAuto) return;
    settings_.drift_cure =
        settings.integrator == Integrator::kMoreauJean ? DriftCure::kPositionPush : DriftCure::kBaumgarte;
  }

  template <typename Work>
  void undoable(Work work);
  template <typename Work>
  void reported(Work work);
  void begin_report();
  void make_system();
  void move_world(const State& state);
  bool settle();
  void transfer(Archive& archive, std::span<const char> gone);
  void step(double dt);
  void assemble();
  void close_all_joints();
  Contradiction contradiction(double horizon);
  void refresh();
  void restart_if_needed();
  void add_spring_forces();
  Reaction reaction_from(JointId joint, std::span<const double> multipliers, double scale) const;
  void compute_reactions();

  Reaction mean_reaction(JointId joint);
  AxisReport axis_report(AxisId axis) const;
  std::vector<ContactReport> contacts() const;
  std::vector<ContactStretch> contact_stretches() const;
  void set_contact_stretches(std::vector<ContactStretch> stretches);

  // What was moved, and sleep (simulator_sleep.cpp).
  std::span<const ContactSet::Place> places() const;
  bool has_started() const;
  bool is_moved(int body) const;
  std::vector<char> moved_bodies() const;
  void note_moved_bodies();
  void wake_islands(double h);
  void collect_sleep_candidates(double dt);
  void restore_awake();
  bool wakes(bool done);
  void note_reports_of(std::span<const BodyId> tired);
  bool rests(const ContactReport& report) const;
  bool rests(JointId joint) const;

  // With merged bodies (merged_): world_ is a copy of the source, which is followed and kept up to date.
  void sync_from_world() { moved_ = (merged_ && merged_->update(source_)) || moved_; }
  void flush_mean_reactions();
  void publish_to_world();
  bool merges(JointId joint) const { return weld_loads_ && weld_loads_->is_weld(joint); }
  std::vector<Reaction> weld_reactions() const;
  void solve_present_welds();
  std::vector<ContactReport> mean_contacts() const;
  void solve_weld_means();
  void refer_to_source(Contact& contact) const;
  void recall_contacts();
  const Rows& source_rows() const { return weld_loads_ ? weld_loads_->rows() : system_->rows(); }

  /// How a simulation divides its steps.
  struct Pace {
    double substeps = 1,
           most_substeps = 1;  ///< sub-steps at present, and the most asked for in the quiet time
    int quiet = 0;             ///< steps in a row that asked for fewer
    int hard_steps = 0;        ///< to come, in which inexact laws are taken at once
  };
  struct Versions {
    std::int64_t source_topology = -1, source_state = -1, geometry = -1, sleep = -1, topology = -1,
                 state = -1;
    friend bool operator==(const Versions&, const Versions&) = default;
  };
  Versions versions() const;
  void take_back(const Pace& pace, std::vector<ContactStretch> stretches);

  World& source_;  // the user's
  std::uint64_t identity_ = source_.identity();
  std::unique_ptr<MergedWorld> merged_;
  World& world_;  // that is stepped: source_ itself, or the merged one
  Settings settings_;
  std::function<bool()> interrupt_;
  StepReport report_;
  std::unique_ptr<ConstraintSystem> system_;
  std::unique_ptr<ImpulseScheme> scheme_;
  std::optional<Composition> composition_;  // of scheme_
  std::unique_ptr<ForceLevel> force_level_;
  double horizon_ = 0;  // the step to come
  Pace pace_;
  StepReport last_report_;  // while a step makes a new one
  State undo_;              // of world_, before the present step moved it
  bool has_moved_ = false;
  std::vector<JointId> broken_;  // … and what has broken in it
  Versions end_versions_;        // at the end of the last step
  bool restarted_ = false;  // the integrator has made velocities tangent, which the books do not know yet
  bool retaken_ = false;    // the integrator is at the end of a step that is taken again: its memory holds
  std::int64_t topology_version_ = -1, geometry_version_ = -1, state_version_ = -1, reaction_version_ = -1,
               sleep_version_ = -1;
  std::vector<double> reaction_multipliers_, phi_, rates_;
  mutable std::vector<double> wrench_jacobian_;  // J of the present state, made when the first joint asks
  mutable std::int64_t wrench_jacobian_version_ = -1;
  /// Only RATTLE of order 2 and Moreau–Jean take springs between bodies implicitly, as rows.
  Springs springs_ =  // among the rows
      settings_.integrator == Integrator::kRattle || settings_.integrator == Integrator::kMoreauJean
          ? Springs::kIncluded
          : Springs::kLeftOut;
  /// … and then they are no force laws.
  Springs laws_springs_ = springs_ == Springs::kIncluded ? Springs::kLeftOut : Springs::kIncluded;
  EnergyAccounting books_{laws_springs_};
  std::unique_ptr<WeldLoads> weld_loads_;  // null if nothing is merged
  bool moved_ = false;                     // the source, since the last step
  std::optional<Sleep> sleep_;
  std::vector<BodyId> sleep_candidates_;  // that fall asleep with this step
  std::vector<Twist> candidate_twists_;
  /// What sleeping bodies bore in the last step before; entries of others are not looked at.
  struct {
    std::map<JointId, Reaction> reactions;
    std::map<AxisId, AxisReport> axes;
    std::vector<ContactReport> contacts;
  } asleep_;
  std::vector<ContactStretch> recalled_;  // for the next start, as the source has them
  State start_, given_;                   // of the source: at the start of the step, as given back last
  std::int64_t given_version_ = -1, present_version_ = -1;    // of world_
  std::vector<Reaction> mean_reactions_, present_reactions_;  // of welds, by joint; empty: not solved

 private:
  bool knows_pattern() const;
  bool advance_to_end(double dt);
  bool integrate(double dt);
  bool after_stall(Substeps& substeps, bool hard, bool forgot);
  double choose_substeps(double dt);
  void finish(double dt);
  bool welds_hold();
  Gap gap_of(std::span<const double> phi) const;
  void detach_broken();
  void forget_step();
  void diagnose_stall(double remaining, bool unstable);
  void fail_not_finite();
  void fail_blind();
  void note_detection();
  JointId overflowing_joint(const State& state);
  std::string widest_gap(const State& state);
  std::string widest_gap(const State& state, std::span<const double> phi, double least);
  std::string advice(const Culprit& culprit, const State& state) const;
  std::string list_culprits() const;
  ForceId force_not_finite() const;
  BodyId body_not_finite() const;
  std::string singular_axis() const;
  void name_jam();
  Contradiction contradiction_from(const State& state, double horizon) const;
  void count_work();
  void name_dependent_rows();
  void set_failure(Status status, std::string message);
};

}  // namespace taut
