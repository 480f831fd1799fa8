#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "solvers/common/step_report.h"
#include "solvers/simulator/event.h"

namespace taut {

class Archive;

/// An event that is due, with what it watches now and before the step.
struct DueEvent {
  int event = 0;                    ///< its index
  std::optional<double> value{};    ///< now; none: it is at a time
  double before = 0;                ///< before the step
  void transfer(Archive& archive);  ///< to or from bytes
};

/// The events of a simulator, and which of them have happened.            (solvers/simulator/EVENTS, "A step
/// with events")
class EventSchedule {
 public:
  EventSchedule() = default;
  /// @throws std::invalid_argument as check_event(), and for a name that is given twice.
  EventSchedule(const World& world, std::vector<Event> events);

  bool any() const { return !events_.empty(); }  ///< there are events, happened or not
  /// Steps have to ask: an event may still happen, a load acts, or the next step closes a joint that one has
  /// attached.
  bool is_pending() const;
  /// Earliest time after `now` at which an event happens or a load ends; infinite if there is none.
  double next_time(double now) const;
  /// Some event that may happen has to be located within the step.
  bool locates() const;

  /// Notes the numbers that are watched, if they are not known, as those before a step.
  void prime(Simulator& simulator);
  /// Some event that has to be located has happened since the values before the step.
  bool has_passed(Simulator& simulator) const;
  /// After which multiple of the time since then the first of them happens, by straight lines; infinite if
  /// nothing moves towards a threshold.
  double first_passage(Simulator& simulator) const;
  /// What is due now, for times to within `instant` [s], in the order of the events; the numbers that are
  /// watched become those before the next step.
  std::vector<DueEvent> due(Simulator& simulator, double instant);
  /// Why an event could not happen: a joint that it cannot attach.
  struct Refusal {
    std::string what;  ///< in words, after the name of the event
    JointId joint{};   ///< that one
    double gap = 0;    ///< how far it is open [m or rad]
  };
  /// Does to the world what events do, one after the other, up to one that is refused: that one and those
  /// after it are due again.
  std::optional<Refusal> let_happen(World& world, std::span<const DueEvent> due);
  /// Ends the loads whose time is over.
  void end_loads(World& world, double time);
  /// The sum of the loads that act, which is beside the force laws of the world; null: none.
  std::shared_ptr<const Force> loads() const { return loads_; }

  const std::vector<EventRecord>& happened() const { return happened_; }  ///< in their order
  /// Name of the event that has ended the run.
  const std::string& ended_by() const { return ended_by_; }
  /// A joint was attached after the last step; false from then on.
  bool take_attached() { return std::exchange(attached_, false); }
  void note_attached() { attached_ = true; }  ///< that step was not done

  /// What has happened, and what it has set, to or from bytes; apply() then sets it.
  void transfer(Archive& archive, const World& world);
  /// What was due, to or from bytes.
  void transfer(Archive& archive, std::vector<DueEvent>& due) const;
  /// Gravity, motors, frames of joints and loads as they were transferred.
  void apply(World& world) const;
  /// Notes gravity, motors, frames of joints and loads of a world as it is now, for transfer().
  void note_settings(const World& world);

 private:
  /// All of what an event does or, if it is refused, nothing.
  std::optional<Refusal> happen(World& world, const DueEvent& due);
  /// It could not happen, so that it is due again.
  void put_back(const DueEvent& due);

  struct Memory {
    int count = 0;
    bool known = false;  // the value before the next step
    double before = 0;
    void transfer(Archive& archive);
  };
  struct ActingLoad {
    int event = 0, action = 0;
    double start = 0;
    void transfer(Archive& archive);
  };
  struct MotorSetting {
    AxisId axis;
    bool there = false;
    double target = 0, max_force = 0;
    void transfer(Archive& archive);
  };
  static std::optional<Refusal> try_joints(const World& world, const Event& event,
                                           std::map<JointId, Pose>& frames);
  bool may_happen(std::size_t event) const;
  /// What an event waits for, if it may happen and has to be located within the step; else null.
  const WhenPasses* located(std::size_t event) const;
  EventRecord record(int event, double time, std::optional<double> value) const;
  double end_of(const ActingLoad& load) const;
  void make_loads();
  void give_loads(World& world) const;

  std::vector<Event> events_;
  std::vector<std::string> texts_;
  std::vector<Memory> memory_;
  std::vector<EventRecord> happened_;
  std::vector<ActingLoad> acting_;
  std::shared_ptr<const Force> loads_;
  std::string ended_by_;
  bool attached_ = false;

  // What events set in the world beside its state.
  Vec3 gravity_ = Vec3::Zero();
  std::vector<MotorSetting> motors_;             // those that an event concerns
  std::vector<std::optional<AxisMotor>> given_;  // as they were when the events were given
  std::map<JointId, Pose> frames_;               // those that are attached as they are
};

}  // namespace taut
