#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/math/motion_point.h"
#include "core/world/world.h"

/// What happens in a simulation when something else does: Simulator::set_events().
namespace taut {

class Simulator;

/// A number that an event watches.
struct Watch {
  std::string label;                        ///< for messages: "angle of elbow"
  std::function<double(Simulator&)> value;  ///< at present
  /// It follows from the state alone and is continuous, so that the instant at which it passes a threshold
  /// can be found within a step.  What is a mean over a step, as a reaction is, is not.
  bool of_state = true;

  /// A component of a vector along a direction of unit length in world axes; none: its magnitude.
  using Along = std::optional<Vec3>;
  /// Position [m], velocity [m/s] of point P of a body, or its angular velocity [rad/s], world axes.
  /// @throws std::invalid_argument, all of these, for what the world does not have and a direction that is
  /// not of unit length.  @{
  static Watch position(const World& world, BodyId body, const Vec3& p_BP, const Along& along);
  static Watch velocity(const World& world, BodyId body, const Vec3& p_BP, const Along& along);
  static Watch angular_velocity(const World& world, BodyId body, const Along& along);  /// @}
  /// Distance of point P of A and point Q of B [m].
  static Watch distance(const World& world, BodyId a, const Vec3& p_AP, BodyId b, const Vec3& p_BQ);
  /// Coordinate of a free axis [rad or m], and its rate [rad/s or m/s].  @{
  static Watch axis(const World& world, AxisId axis);
  static Watch axis_rate(const World& world, AxisId axis);  /// @}
  /// Mean force [N], or torque about the anchor [N·m], of a joint on B over the last step: 0 before the first
  /// step and when detached.  Not of the state alone.  @{
  static Watch reaction_force(const World& world, JointId joint, const Along& along);
  static Watch reaction_torque(const World& world, JointId joint, const Along& along);  /// @}
  /// How far a joint is open, detached or not: the larger of [m] and [rad].
  static Watch joint_gap(const World& world, JointId joint);
  /// Smallest gap of the contacts of two bodies [m]; infinite without any, as beyond
  /// Settings::contact_margin, and not known (NaN, which passes nothing) before the first step.  Not of the
  /// state alone, since it jumps at the margin.
  static Watch contact_gap(const World& world, BodyId a, BodyId b);
};

/// At a time [s], which a step then ends at, to the last bit; at once if it has passed when the event is
/// given.
struct AtTime {
  double time = 0;  ///< [s]
};

/// When a number passes a threshold: it was on one side and is at it or beyond.  An event of this that does
/// nothing is a warning: the report has it.
struct WhenPasses {
  enum class Way { kRising, kFalling, kEither };  ///< Which passages count.
  Watch watch;                                    ///< the number
  double threshold = 0;                           ///< in its unit
  Way way = Way::kEither;                         ///< which passages count
  bool each_time = false;                         ///< else the first time only
  /// The step is divided where it passes, if the number is of the state alone: at most a millionth of the
  /// step late.  This costs a checkpoint a step.  Otherwise the event is at the end of that step.
  bool located = true;
};

/// Attaches a joint (World::attach()); nothing happens if it is attached.
struct AttachJoint {
  enum class Where {  ///< What becomes of a joint whose ends are apart.
    kClosed,          ///< it must be closed to `tolerance`, else the step fails with the joint's name
    kAsIs,            ///< its end on B moves to where it is closed (closing_frame())
  };
  JointId joint;                 ///< which
  Where where = Where::kClosed;  ///< what becomes of it if it is open
  double tolerance = 1e-6;       ///< of kClosed [m or rad]; the simulator closes what is left
};
/// Detaches a joint and those that couple its axes (World::detach()).
struct DetachJoint {
  JointId joint;  ///< which
};
/// Changes the motor of a free axis.
struct SetMotor {
  AxisId axis;                        ///< its axis
  std::optional<double> target{};     ///< velocity or position, as its mode is
  std::optional<double> max_force{};  ///< [N·m or N]
  bool remove = false;                ///< takes the motor away; then neither of the others
};
/// A force and a torque on a body for a while, from the event on.
struct ApplyLoad {
  BodyId body;                   ///< on which it acts
  Vec3 p_BP = Vec3::Zero();      ///< where the force acts, body axes from the centre of mass [m]
  Vec3 force = Vec3::Zero();     ///< [N]
  Vec3 torque = Vec3::Zero();    ///< [N·m]
  bool follows_body = false;     ///< both in body axes, else in world axes
  double duration = kUnlimited;  ///< [s]; a step ends at its end
  Motion factor{};               ///< what both are multiplied by, over the time since the event; null: 1
};
/// World::set_gravity().
struct SetGravity {
  Vec3 gravity = Vec3::Zero();  ///< [m/s²]
};
/// Ends the run with the event's name: Simulator::run_until() returns, Simulator::ended_by() says it.
struct EndRun {};

/// One thing that an event does.
using EventAction = std::variant<AttachJoint, DetachJoint, SetMotor, ApplyLoad, SetGravity, EndRun>;

/// Something that happens once, or each time when a number passes a threshold.
struct Event {
  std::string name;                       ///< unique, not empty
  std::variant<AtTime, WhenPasses> when;  ///< its cause
  std::vector<EventAction> actions;       ///< what it does, in this order
};

/// @throws std::invalid_argument, with the event's name, for a cause or action that is not finite or refers
/// to what the world does not have: bodies, joints, motors; a motor that follows a trajectory has no target,
/// and a joint that couples axes or has more than two bodies no end that Where::kAsIs could move.
void check_event(const World& world, const Event& event);

/// "detach hook; motor of winch length: target -0.5".
std::string text_of(const Event& event, const World& world);

}  // namespace taut
