#pragma once

#include <functional>
#include <vector>

#include "collision/narrow/contact.h"
#include "scenes/builders/scene.h"
#include "scenes/recording/gap_meter.h"
#include "scenes/recording/recorder.h"
#include "scenes/recording/recording.h"
#include "solvers/simulator/simulator.h"

namespace taut {

/// Forces of the world that pull along a line, in their order.
std::vector<ForceId> line_forces(const World& world);

/// A contact as a recording has it: half-way between its two points, in the world.
/// @param force on B, world axes [N]
ContactSample contact_sample(const World& world, const Contact& contact, const Vec3& force);

/// Reads the frames of a recording from a running simulation.
class FrameSampler {
 public:
  /// Appends the present contacts with their forces.
  using ContactSource = std::function<void(const Simulator&, std::vector<ContactSample>&)>;

  explicit FrameSampler(const Scene& scene);

  /// In place of the contacts of the simulator that give a force.
  void set_contact_source(ContactSource source) { contacts_ = std::move(source); }

  /// What is the same in all frames.
  RecordingHeader header(double frames_per_second) const;
  /// The present instant.  Wrenches are means over the last step; before the first one, those that the
  /// acceleration equation gives.
  Frame sample(Simulator& simulator);

 private:
  const Scene& scene_;
  std::vector<ForceId> springs_;  // the forces that pull along a line
  GapMeter gaps_;
  Recorder probes_;
  ContactSource contacts_;
};

}  // namespace taut
