#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/world/diagnostics.h"
#include "core/world/shape.h"
#include "solvers/simulator/simulator.h"

/// What a recording of a run holds: one header, then frames.  scenes/recording/FORMAT.md describes the file.
namespace taut {

/// A body of a recording.
struct RecordedBody {
  std::string name;    ///< of the body
  double mass = 0;     ///< [kg]; 0 for the ground
  bool fixed = false;  ///< it never moves
};

/// A free axis of a joint, to be drawn where the joint is.
struct RecordedAxis {
  std::string name;             ///< in its joint, as "angle"
  bool angular = true;          ///< B turns about it; else it moves along it
  BodyId body;                  ///< that it is fixed to
  Vec3 axis_B = Vec3::UnitZ();  ///< unit vector, in axes of this body
};

/// A joint of a recording.
struct RecordedJoint {
  std::string name;                  ///< of the joint
  std::string type;                  ///< in the words of a scene file
  BodyId a;                          ///< its body A
  BodyId b;                          ///< its body B, on which its wrench acts
  Vec3 anchor_B = Vec3::Zero();      ///< where its wrench acts: from the centre of mass of B, body axes [m]
  std::vector<WirePoint> course{};   ///< of rods, ropes and wires: their sections go from point to point
  std::vector<RecordedAxis> axes{};  ///< those with a direction of their own
};

/// A force law that pulls along a line: a spring, or a damper alone.
struct RecordedSpring {
  std::string name;     ///< of the force law
  bool elastic = true;  ///< false: a damper without a spring
  WirePoint from;       ///< where it begins
  WirePoint to;         ///< where it ends
};

/// A shape to draw: index into RecordingHeader::shapes, at the pose X_BS in its body.
struct DrawnShape {
  int shape = 0;  ///< index
  BodyId body;    ///< that it moves with
  Pose pose{};    ///< X_BS
};

/// A number per frame, for instance an energy or a component of a probe.
struct RecordedScalar {
  enum class Group { kEnergy, kGap, kProbe };  ///< What it belongs to.
  std::string name;                            ///< of its column
  std::string unit;                            ///< "m", "N", …; "" without
  Group group = Group::kProbe;                 ///< what it belongs to
};

/// What is the same in all frames of a recording.
struct RecordingHeader {
  std::string scene;                                     ///< its name
  std::map<std::string, double> parameters;              ///< that it was built with
  std::map<std::string, std::string> parameter_units{};  ///< as in Scene
  double dt = 0;                                         ///< of the steps [s]
  double frames_per_second = 0;                          ///< as asked for; 0: every step
  Vec3 gravity = Vec3::Zero();                           ///< [m/s²]
  std::vector<RecordedBody> bodies;                      ///< the ground is the first
  std::vector<RecordedJoint> joints;                     ///< in the order of their ids
  std::vector<RecordedSpring> springs;  ///< forces that pull along a line, in the order of their ids
  std::vector<RecordedScalar> scalars;  ///< names of Frame::scalars
  std::vector<Shape> shapes;            ///< that are drawn, each once
  std::vector<DrawnShape> drawn;        ///< where they are drawn
};

/// Force and torque of a joint on its body B, world axes, the torque about its anchor, and how far it is
/// open.  One that is detached, or broken, has none of these.
struct JointSample {
  Reaction wrench;       ///< mean over the last step
  Gap gap;               ///< how far it is open
  bool attached = true;  ///< not detached, and not broken
};

/// A contact of bodies A and B.
struct ContactSample {
  BodyId a;                      ///< its body A
  BodyId b;                      ///< its body B, on which its force acts
  Vec3 position = Vec3::Zero();  ///< world [m]
  Vec3 normal = Vec3::Zero();    ///< unit, from A to B, world axes
  Vec3 force = Vec3::Zero();     ///< on B, world axes [N]
};

/// One instant.  Poses and twists have an entry per body, the ground's first.
struct Frame {
  double time = 0;                      ///< [s]
  std::vector<Pose> poses;              ///< X_WB
  std::vector<Twist> twists;            ///< V_WB
  std::vector<JointSample> joints;      ///< an entry per joint
  std::vector<ContactSample> contacts;  ///< those that gave a force
  std::vector<double> tensions;         ///< of the springs [N], negative: it pushes
  std::vector<double> scalars;          ///< as RecordingHeader::scalars names them
};

/// How the run ended.
struct RecordingEnd {
  std::string status = "success";  ///< in the words of Status
  std::string message;             ///< why, or ""
  int frames = 0;                  ///< that were written
};

}  // namespace taut
