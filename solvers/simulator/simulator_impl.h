#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/interruption.h"
#include "solvers/common/setting_checks.h"
#include "solvers/common/stopwatch.h"
#include "solvers/complementarity/contact_stage.h"
#include "solvers/simulator/energy_accounting.h"
#include "solvers/simulator/event_schedule.h"
#include "solvers/simulator/inquiry.h"
#include "solvers/simulator/joint_reactions.h"
#include "solvers/simulator/merged_bodies.h"
#include "solvers/simulator/simulator.h"
#include "solvers/simulator/sleep.h"
#include "solvers/simulator/sleeping_loads.h"
#include "solvers/simulator/step_loads.h"
#include "solvers/simulator/step_quality.h"
#include "solvers/simulator/step_undo.h"
#include "solvers/simulator/stepper.h"
#include "solvers/simulator/substepping.h"
#include "solvers/simulator/weld_reactions.h"

namespace taut {

class Archive;

/// What Simulator::step() consists of (simulator.cpp), and the answers between steps
/// (simulator_reactions.cpp).
class Simulator::Impl {
 public:
  Impl(World& world, const Settings& settings);

  // The steps of a step, in their order.
  /// What is taken back beside the worlds if something is thrown.
  struct Before {
    StepDivision division;
    std::vector<ContactStretch> stretches;
  };
  Before begin_step(double dt);
  /// While a step is taken: its time, who may interrupt it, who looks at its stages.
  struct Watches {
    explicit Watches(Impl& now)
        : time(now.report_.times.total), interrupt(&now.hooks_.interrupt), stages(&now.hooks_.stage_watch) {}
    Stopwatch time;
    detail::InterruptScope interrupt;
    detail::StageWatchScope stages;
  };
  void fall_asleep();
  bool start_advancing();
  bool finish_advancing(double dt);
  void give_up(Before before);
  void end_step();

  void assemble();

  // Questions between steps.
  Reaction mean_reaction(JointId joint);
  Reaction reaction(JointId joint);
  AxisReport axis_report(AxisId axis) const;
  std::vector<ContactReport> contacts() const;
  std::vector<ContactStretch> contact_stretches() const;
  void set_contact_stretches(std::vector<ContactStretch> stretches);
  Contradiction contradiction(double horizon);
  std::string solver_description();

  // Checkpoints (checkpoint.cpp).
  bool settle();
  void transfer(Archive& archive, std::span<const char> gone);

  MergedBodies bodies_;
  World& source_ = bodies_.source();  // the user's
  World& world_ = bodies_.world();    // that is stepped
  std::uint64_t identity_ = source_.identity();
  Settings settings_;
  /// What a step calls: one that is made anew for the same Simulator has it, too.
  struct Hooks {
    std::function<bool()> interrupt;
    std::function<void(const ContactStage&)> stage_watch;
  };
  Hooks hooks_;
  StepReport report_;
  Stepper stepper_;
  Substepping substepping_{settings_};
  EventSchedule events_;
  std::optional<double> goal_;       // of a part between events: the time at its end, to the last bit
  std::optional<StepReport> whole_;  // of a step with events, of all its parts

  /// Versions of both worlds.
  struct Versions {
    std::int64_t source_topology = -1, source_state = -1, geometry = -1, sleep = -1, topology = -1,
                 state = -1;
    friend bool operator==(const Versions&, const Versions&) = default;
  };
  Versions versions() const;
  /// A checkpoint from before the events after the last step, which goes on with them, and the versions since
  /// they have happened: while they hold, it is the present one.  What events change has no checkpoint of its
  /// own, since the integrator takes it up with the next step.
  struct SinceEvents {
    Checkpoint checkpoint;
    Versions versions;
  };
  std::optional<SinceEvents> since_events_;

 private:
  Before begin_undoable();
  void take_back(Before before);
  void begin_report();
  void count_work();
  Inquiry inquiry() { return {source_, world_, welds_.any(), stepper_, settings_, report_}; }

  // What they consist of.
  void choose_sleepers(double dt);
  void note_loads_of_sleepers();
  void wake_islands(double h);
  bool welds_hold();
  void finish(double dt);
  void close_ledger();
  void stay_where_it_was();
  void detach_broken();

  // Pattern and start of the integrator.
  void refresh();
  Stepper::Predecessor renew_pattern();
  void note_renewed();
  bool close_at_start();
  void start_scheme(bool goes_on, Stepper::Predecessor& old);
  void bring_up_to_date(double h);
  void close_all_joints();
  const Rows& source_rows() const { return welds_.any() ? welds_.rows() : stepper_.system().rows(); }

  StepReport last_report_;  // while a step makes a new one
  double horizon_ = 0;      // the step to come
  StepUndo undo_{world_, source_};
  StepQuality quality_;
  EnergyAccounting accounting_{stepper_.force_springs()};
  bool restarted_ = false;  // the integrator has made velocities tangent, which the ledger does not know yet
  Sleep sleep_{settings_};
  SleepingLoads sleeping_{source_};
  WeldReactions welds_{bodies_};
  JointReactions reactions_;
  std::vector<ContactStretch> recalled_;  // for the next start, as the source has them
  Versions end_versions_;                 // at the end of the last step
};

}  // namespace taut
