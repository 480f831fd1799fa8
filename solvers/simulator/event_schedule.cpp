#include "solvers/simulator/event_schedule.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>

#include "core/base/check.h"
#include "core/state/archive.h"
#include "core/world/joint_frame.h"
#include "core/world/passing_loads.h"
#include "solvers/simulator/simulator.h"

namespace taut {
namespace {

/// The passage counts: from one side of the threshold to it or beyond.
bool has_passed_to(const WhenPasses& when, double before, double now) {
  using enum WhenPasses::Way;
  const bool rises = before < when.threshold && now >= when.threshold;
  const bool falls = before > when.threshold && now <= when.threshold;
  return (rises && when.way != kFalling) || (falls && when.way != kRising);
}

/// Calls `each` with all actions of a kind.
template <typename Action, typename Each>
void each_action(const std::vector<Event>& events, Each each) {
  for (const Event& event : events)
    for (const EventAction& action : event.actions)
      if (const Action* its = std::get_if<Action>(&action)) each(*its);
}

/// Laws that act together.
class LawSum final : public Force {
 public:
  explicit LawSum(std::vector<std::shared_ptr<const Force>> laws) : laws_(std::move(laws)) {}
  void accumulate(const State& state, std::span<Wrench> wrenches) const override {
    for (const auto& law : laws_) law->accumulate(state, wrenches);
  }
  std::vector<BodyId> bodies() const override {
    std::vector<BodyId> bodies;
    for (const auto& law : laws_)
      for (const BodyId body : law->bodies()) bodies.push_back(body);
    return bodies;
  }

 private:
  std::vector<std::shared_ptr<const Force>> laws_;
};

Motion delayed(const Motion& factor, double start) {
  if (!factor) return {};
  return [=](double time) { return factor(time - start); };
}

std::string open_text(const World& world, const AttachJoint& action, const Gap& gap) {
  std::ostringstream text;
  text << world.joint(action.joint).type() << ' ' << world.name(action.joint)
       << " cannot be attached, since it is open by " << gap.metres << " m and " << gap.radians
       << " rad, and the event allows " << action.tolerance << "; \"where\": \"as_is\" attaches it as it is";
  return text.str();
}

}  // namespace

EventSchedule::EventSchedule(const World& world, std::vector<Event> events)
    : events_(std::move(events)), memory_(events_.size()), gravity_(world.gravity()) {
  std::set<std::string> names;
  for (const Event& event : events_) {
    check_event(world, event);
    if (!names.insert(event.name).second) fail("event", "name is already taken", event.name);
    texts_.push_back(text_of(event, world));
  }
  std::set<AxisId> axes;
  each_action<SetMotor>(events_, [&](const SetMotor& action) {
    if (!axes.insert(action.axis).second) return;
    motors_.push_back({action.axis});
    given_.push_back(world.axis_properties(action.axis).motor);
  });
  each_action<AttachJoint>(events_, [&](const AttachJoint& action) {
    if (action.where == AttachJoint::Where::kAsIs) frames_[action.joint] = {};
  });
}

bool EventSchedule::may_happen(std::size_t event) const {
  const WhenPasses* passes = std::get_if<WhenPasses>(&events_[event].when);
  return memory_[event].count == 0 || (passes && passes->each_time);
}

const WhenPasses* EventSchedule::located(std::size_t event) const {
  const WhenPasses* when = std::get_if<WhenPasses>(&events_[event].when);
  return when && when->located && when->watch.of_state && may_happen(event) ? when : nullptr;
}

bool EventSchedule::is_pending() const {
  if (attached_ || !acting_.empty()) return true;
  for (std::size_t i = 0; i < events_.size(); ++i)
    if (may_happen(i)) return true;
  return false;
}

double EventSchedule::next_time(double now) const {
  double next = kUnlimited;
  const auto add = [&](double time) {
    if (time > now) next = std::min(next, time);
  };
  for (std::size_t i = 0; i < events_.size(); ++i)
    if (const AtTime* at = std::get_if<AtTime>(&events_[i].when); at && may_happen(i)) add(at->time);
  for (const ActingLoad& load : acting_) add(end_of(load));
  return next;
}

bool EventSchedule::locates() const {
  for (std::size_t i = 0; i < events_.size(); ++i)
    if (located(i)) return true;
  return false;
}

void EventSchedule::prime(Simulator& simulator) {
  for (std::size_t i = 0; i < events_.size(); ++i) {
    const WhenPasses* when = std::get_if<WhenPasses>(&events_[i].when);
    if (!when || memory_[i].known || !may_happen(i)) continue;
    memory_[i].before = when->watch.value(simulator);
    memory_[i].known = !std::isnan(memory_[i].before);
  }
}

bool EventSchedule::has_passed(Simulator& simulator) const {
  for (std::size_t i = 0; i < events_.size(); ++i) {
    const WhenPasses* when = located(i);
    if (when && memory_[i].known && has_passed_to(*when, memory_[i].before, when->watch.value(simulator)))
      return true;
  }
  return false;
}

double EventSchedule::first_passage(Simulator& simulator) const {
  double first = kUnlimited;
  for (std::size_t i = 0; i < events_.size(); ++i) {
    const WhenPasses* when = located(i);
    if (!when || !memory_[i].known) continue;
    const double before = memory_[i].before, now = when->watch.value(simulator);
    const double multiple = (when->threshold - before) / (now - before);
    if (multiple > 0 && has_passed_to(*when, before, when->threshold)) first = std::min(first, multiple);
  }
  return first;
}

std::vector<DueEvent> EventSchedule::due(Simulator& simulator, double instant) {
  std::vector<DueEvent> due;
  const double time = simulator.world().time();
  for (std::size_t i = 0; i < events_.size(); ++i) {
    if (!may_happen(i)) continue;
    const int event = static_cast<int>(i);
    if (const AtTime* at = std::get_if<AtTime>(&events_[i].when)) {
      if (at->time <= time + instant) due.push_back({event});
      continue;
    }
    const WhenPasses& when = std::get<WhenPasses>(events_[i].when);
    Memory& memory = memory_[i];
    const double now = when.watch.value(simulator);
    if (memory.known && has_passed_to(when, memory.before, now)) due.push_back({event, now, memory.before});
    memory.before = now;
    memory.known = !std::isnan(now);
  }
  return due;
}

void EventSchedule::put_back(const DueEvent& due) {
  if (due.value) memory_[due.event].before = due.before;
}

/// What can be refused is tried on a copy first, so that an event does all or nothing; `frames` of joints
/// that are attached as they are.
std::optional<EventSchedule::Refusal> EventSchedule::try_joints(const World& world, const Event& event,
                                                                std::map<JointId, Pose>& frames) {
  const auto attaches = [](const EventAction& action) { return std::holds_alternative<AttachJoint>(action); };
  if (std::none_of(event.actions.begin(), event.actions.end(), attaches)) return {};
  World trial = world;
  for (const EventAction& action : event.actions) {
    if (const DetachJoint* detach = std::get_if<DetachJoint>(&action)) trial.detach(detach->joint);
    const AttachJoint* attach = std::get_if<AttachJoint>(&action);
    if (!attach || trial.is_attached(attach->joint)) continue;
    try {
      if (attach->where == AttachJoint::Where::kAsIs) {
        trial.set_joint_frame(attach->joint, {});
        frames[attach->joint] = closing_frame(trial, attach->joint);
      } else if (const Gap gap = gap_of(trial, attach->joint);
                 !(std::max(gap.metres, gap.radians) <= attach->tolerance)) {
        return Refusal{open_text(world, *attach, gap), attach->joint, std::max(gap.metres, gap.radians)};
      }
      trial.attach(attach->joint);
    } catch (const std::invalid_argument& error) {
      return Refusal{error.what(), attach->joint, kUnlimited};
    }
  }
  return {};
}

std::optional<EventSchedule::Refusal> EventSchedule::happen(World& world, const DueEvent& due) {
  const Event& event = events_[due.event];
  std::map<JointId, Pose> frames;
  if (std::optional<Refusal> refusal = try_joints(world, event, frames)) return refusal;
  const auto set_motor = [&](const SetMotor& action) {
    std::optional<AxisMotor> motor = world.axis_properties(action.axis).motor;
    if (!motor) return;  // taken away since
    if (action.target) motor->target = *action.target;
    if (action.max_force) motor->max_force = *action.max_force;
    world.set_motor(action.axis, action.remove ? std::nullopt : motor);
  };
  for (std::size_t k = 0; k < event.actions.size(); ++k) {
    const EventAction& action = event.actions[k];
    if (const AttachJoint* attach = std::get_if<AttachJoint>(&action)) {
      if (world.is_attached(attach->joint)) continue;
      if (const auto frame = frames.find(attach->joint); frame != frames.end()) {
        world.set_joint_frame(attach->joint, frame->second);
        frames_[attach->joint] = frame->second;
      }
      world.attach(attach->joint);
      attached_ = true;
    } else if (const DetachJoint* detach = std::get_if<DetachJoint>(&action)) {
      world.detach(detach->joint);
    } else if (const SetMotor* motor = std::get_if<SetMotor>(&action)) {
      set_motor(*motor);
    } else if (const SetGravity* gravity = std::get_if<SetGravity>(&action)) {
      world.set_gravity(gravity->gravity);
    } else if (std::holds_alternative<ApplyLoad>(action)) {
      acting_.push_back({due.event, static_cast<int>(k), world.time()});
      make_loads();
      give_loads(world);
      world.wake(std::get<ApplyLoad>(action).body);
    } else {
      ended_by_ = event.name;
    }
  }
  ++memory_[due.event].count;
  happened_.push_back(record(due.event, world.time(), due.value));
  return {};
}

EventRecord EventSchedule::record(int event, double time, std::optional<double> value) const {
  const std::vector<EventAction>& actions = events_[event].actions;
  const bool ends = std::any_of(actions.begin(), actions.end(), [](const EventAction& action) {
    return std::holds_alternative<EndRun>(action);
  });
  return {event, events_[event].name, texts_[event], time, value, ends};
}

double EventSchedule::end_of(const ActingLoad& load) const {
  return load.start + std::get<ApplyLoad>(events_[load.event].actions[load.action]).duration;
}

void EventSchedule::end_loads(World& world, double time) {
  if (std::erase_if(acting_, [&](const ActingLoad& load) { return end_of(load) <= time; }) == 0) return;
  make_loads();
  give_loads(world);
}

void EventSchedule::give_loads(World& world) const { PassingLoads::set(world, {}, loads_); }

void EventSchedule::make_loads() {
  std::vector<std::shared_ptr<const Force>> laws;
  for (const ActingLoad& acting : acting_) {
    const ApplyLoad& load = std::get<ApplyLoad>(events_[acting.event].actions[acting.action]);
    const Motion factor = delayed(load.factor, acting.start);
    if (!load.force.isZero(0))
      laws.push_back(
          std::make_shared<PointForce>(load.body, load.p_BP, load.force, load.follows_body, factor));
    if (!load.torque.isZero(0))
      laws.push_back(std::make_shared<BodyTorque>(load.body, load.torque, load.follows_body, factor));
  }
  loads_ = laws.empty() ? nullptr : std::make_shared<const LawSum>(std::move(laws));
}

void EventSchedule::Memory::transfer(Archive& archive) {
  archive(count, known, before);
  Archive::require(count >= 0);
}

void DueEvent::transfer(Archive& archive) { archive(event, value, before); }

void EventSchedule::transfer(Archive& archive, std::vector<DueEvent>& due) const {
  archive(due);
  for (const DueEvent& its : due) Archive::index(its.event, 0, static_cast<int>(events_.size()));
}

void EventSchedule::ActingLoad::transfer(Archive& archive) { archive(event, action, start); }

void EventSchedule::MotorSetting::transfer(Archive& archive) { archive(axis, there, target, max_force); }

std::optional<EventSchedule::Refusal> EventSchedule::let_happen(World& world, std::span<const DueEvent> due) {
  std::optional<Refusal> refusal;
  for (const DueEvent& event : due) {
    if (!refusal && (refusal = happen(world, event)))
      refusal->what = events_[event.event].name + ": " + refusal->what;
    if (refusal) put_back(event);
  }
  return refusal;
}

void EventSchedule::note_settings(const World& world) {
  gravity_ = world.gravity();
  for (MotorSetting& setting : motors_) {
    const std::optional<AxisMotor>& motor = world.axis_properties(setting.axis).motor;
    setting = {setting.axis, motor.has_value(), motor ? motor->target : 0, motor ? motor->max_force : 0};
  }
}

void EventSchedule::transfer(Archive& archive, const World& world) {
  std::vector<std::string> names;
  for (const Event& event : events_) names.push_back(event.name);
  const std::vector<std::string> own = names;
  archive(names);
  Archive::require(names == own, "it is of a run with other events");
  for (Memory& memory : memory_) archive(memory);
  archive.each(happened_, [&](EventRecord& its) {
    archive(its.event, its.time, its.value);
    Archive::index(its.event, 0, static_cast<int>(events_.size()));
    its = record(its.event, its.time, its.value);
  });
  archive(acting_, ended_by_, attached_, gravity_);
  for (const ActingLoad& load : acting_) {
    Archive::index(load.event, 0, static_cast<int>(events_.size()));
    const std::vector<EventAction>& actions = events_[load.event].actions;
    Archive::index(load.action, 0, static_cast<int>(actions.size()));
    Archive::require(std::holds_alternative<ApplyLoad>(actions[load.action]));
  }
  Archive::require(gravity_.allFinite());
  archive.sized(motors_);
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    const MotorSetting& setting = motors_[i];
    (void)world.axis_index(setting.axis);  // throws for one that is not there
    Archive::require(std::isfinite(setting.target) && setting.max_force >= 0);
    Archive::require(!setting.there || given_[i] || world.axis_properties(setting.axis).motor);
  }
  for (auto& [joint, frame] : frames_) {
    archive(frame);
    Archive::require(frame.p.allFinite() && std::abs(frame.q.norm() - 1) < kUnitTolerance);
  }
  if (archive.reads()) make_loads();
}

void EventSchedule::apply(World& world) const {
  if (!any()) return;
  if (world.gravity() != gravity_) world.set_gravity(gravity_);
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    const MotorSetting& setting = motors_[i];
    const std::optional<AxisMotor>& present = world.axis_properties(setting.axis).motor;
    if (!setting.there) {
      world.set_motor(setting.axis, std::nullopt);
    } else if (present || given_[i]) {
      AxisMotor motor = present ? *present : *given_[i];
      motor.target = setting.target, motor.max_force = setting.max_force;
      world.set_motor(setting.axis, motor);
    }
  }
  for (const auto& [joint, frame] : frames_) world.set_joint_frame(joint, frame);
  give_loads(world);
}

}  // namespace taut
