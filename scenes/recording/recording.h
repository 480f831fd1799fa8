#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/world/diagnostics.h"
#include "core/world/shape.h"
#include "solvers/simulator/simulator.h"

/// What a recording of a run holds: one header, then frames.  scenes/recording/FORMAT.md describes the file.
namespace taut {

struct RecordedBody {
  std::string name;
  double mass = 0;  ///< [kg]; 0 for the ground
  bool fixed = false;
};

struct RecordedJoint {
  std::string name, type;
  BodyId a, b;
  Vec3 anchor_B = Vec3::Zero();     ///< where its wrench acts: from the centre of mass of B, body axes [m]
  std::vector<WirePoint> course{};  ///< of rods, ropes and wires: their sections go from point to point
};

/// A force law that pulls along a line: a spring, or a damper alone.
struct RecordedSpring {
  std::string name;
  bool elastic = true;  ///< false: a damper without a spring
  WirePoint from, to;
};

/// A shape to draw: index into RecordingHeader::shapes, at the pose X_BS in its body.
struct DrawnShape {
  int shape = 0;
  BodyId body;
  Pose pose{};
};

/// A number per frame, for instance an energy or a component of a probe.
struct RecordedScalar {
  enum class Group { kEnergy, kGap, kProbe };
  std::string name, unit;
  Group group = Group::kProbe;
};

struct RecordingHeader {
  std::string scene;
  std::map<std::string, double> parameters;
  double dt = 0;                     ///< of the steps [s]
  double frames_per_second = 0;      ///< as asked for; 0: every step
  Vec3 gravity = Vec3::Zero();       ///< [m/s²]
  std::vector<RecordedBody> bodies;  ///< the ground is the first
  std::vector<RecordedJoint> joints;
  std::vector<RecordedSpring> springs;
  std::vector<RecordedScalar> scalars;
  std::vector<Shape> shapes;
  std::vector<DrawnShape> drawn;
};

/// Force and torque of a joint on its body B, world axes, the torque about its anchor, and how far it is
/// open.  One that is detached, or broken, has none of these.
struct JointSample {
  Reaction wrench;
  Gap gap;
  bool attached = true;
};

/// A contact of bodies A and B.
struct ContactSample {
  BodyId a, b;
  Vec3 position = Vec3::Zero();  ///< world [m]
  Vec3 normal = Vec3::Zero();    ///< unit, from A to B, world axes
  Vec3 force = Vec3::Zero();     ///< on B, world axes [N]
};

/// One instant.  Poses and twists have an entry per body, the ground's first.
struct Frame {
  double time = 0;  ///< [s]
  std::vector<Pose> poses;
  std::vector<Twist> twists;
  std::vector<JointSample> joints;
  std::vector<ContactSample> contacts;
  std::vector<double> tensions;  ///< of the springs [N], negative: it pushes
  std::vector<double> scalars;
};

/// How the run ended.
struct RecordingEnd {
  std::string status = "success", message;
  int frames = 0;
};

}  // namespace taut
