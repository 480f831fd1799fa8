#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/world/world.h"
#include "solvers/common/settings.h"
#include "solvers/simulator/event.h"

namespace taut {

/// A quantity recorded over time, from a body or a joint.
struct Probe {
  enum class Quantity {  ///< What is read.
    kPosition,           ///< of a body point [m]
    kVelocity,           ///< of a body point [m/s]
    kOrientation,        ///< quaternion w, x, y, z
    kAngularVelocity,    ///< world axes [rad/s]
    kReactionForce,      ///< of a joint on B, world axes [N]
    kReactionTorque,     ///< of a joint on B about its anchor [N·m]
    kGap,                ///< of a joint [m], [rad]
    kEnergy,             ///< kinetic, potential [J]
    kMomentum,           ///< linear [N·s]
    kAngularMomentum,    ///< about the world origin [N·m·s]
    kAxis,               ///< of a free axis: value [rad or m], rate
    kAxisForce,          ///< mean over the last step, by what gave it: AxisReport::force [N·m or N]
    kAxisPower,          ///< AxisReport::power [W]
    kAxisState,          ///< AxisReport: stuck, saturated, at a limit; 0 or 1
  };
  std::string name{};                       ///< of its columns
  Quantity quantity = Quantity::kPosition;  ///< what is read
  BodyId body{};                            ///< for the body quantities
  JointId joint{};                          ///< for the joint quantities
  AxisId axis{};                            ///< for those of axes
  Vec3 point_B = Vec3::Zero();              ///< body point, from the centre of mass
};

/// A shape that a body is drawn as; it neither collides nor weighs.
struct Drawing {
  BodyId body;        ///< that it moves with
  PlacedShape shape;  ///< in the body's frame
};

/// A world with what is needed to run it.  Shared by the program, the tests and the benchmarks.
struct Scene {
  std::string name;                            ///< of the scene
  std::map<std::string, double> parameters{};  ///< as built; booleans are 0 or 1
  /// Of those that have one; "bool": true or false.
  std::map<std::string, std::string> parameter_units{};
  World world{};        ///< bodies, joints, forces and shapes
  Settings settings{};  ///< for its Simulator
  std::set<std::string>
      given_settings{};   ///< by name: what a scene file says, and does not leave to defaults
  double dt = 1.0 / 240;  ///< [s]
  double duration = 1;    ///< [s]
  double energy_scale =
      0;  ///< E_scale by which energy drift is judged [J]; 0: kinetic + |potential| at the start
  std::vector<Probe> probes{};  ///< what is recorded over time
  std::vector<Event> events{};  ///< for Simulator::set_events()
  std::vector<Drawing>
      drawings{};  ///< bodies without one are drawn by their collision shapes or their inertia
  /// Joints may be open at the start: call Simulator::assemble() before the first step.
  bool assemble = false;
  std::vector<std::string> warnings{};  ///< what is strange in the file that it was read from, a line each
};

/// One parameter of a builder.
struct ParameterInfo {
  std::string name;          ///< as in key=value
  double default_value = 0;  ///< where none is given
  std::string unit;          ///< "", "m", "bool", ...
  std::string description;   ///< one line
  double minimum = 0;        ///< that is allowed
  double maximum = 0;        ///< that is allowed
  bool integer = false;      ///< whole numbers only
};

/// A builder of the catalogue.
struct SceneInfo {
  std::string name;                                                 ///< that build_scene() takes
  std::string description;                                          ///< one line
  std::vector<ParameterInfo> parameters;                            ///< all that it has
  Scene (*build)(const std::map<std::string, double>& parameters);  ///< gets all parameters, checked
};

/// All builders, by name; `bridge` and `net` are short names with other defaults.
const std::vector<SceneInfo>& scene_catalogue();
/// @throws std::invalid_argument for an unknown scene or parameter, or a value out of range, naming what
/// exists.
Scene build_scene(const std::string& name, const std::map<std::string, double>& parameters = {});

}  // namespace taut
