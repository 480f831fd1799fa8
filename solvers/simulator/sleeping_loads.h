#pragma once

#include <map>
#include <vector>

#include "core/world/world.h"
#include "solvers/common/axis_report.h"
#include "solvers/common/contact_report.h"
#include "solvers/simulator/simulator.h"

namespace taut {

class Archive;

/// What joints, axes and contacts of bodies that sleep bore in the last step before they fell asleep.
/// (solvers/simulator, "Sleep")
class SleepingLoads {
 public:
  explicit SleepingLoads(const World& source) : source_(source) {}

  /// A body of the joint is asleep.
  bool rests(JointId joint) const;
  /// One of the two bodies is asleep, and none moves.
  bool rests(const ContactReport& report) const;

  // Of bodies that are about to fall asleep.
  void note(JointId joint, const Reaction& reaction) { reactions_[joint] = reaction; }
  void note(AxisId axis, const AxisReport& report) { axes_[axis] = report; }
  void note(const ContactReport& report) { contacts_.push_back(report); }
  /// Contacts of bodies that have woken since.
  void forget_woken();

  Reaction reaction(JointId joint) const;
  AxisReport axis(AxisId axis) const;
  void append_contacts(std::vector<ContactReport>& reports) const;

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive);

 private:
  const World& source_;
  // Entries of those that are awake are not looked at.
  std::map<JointId, Reaction> reactions_;
  std::map<AxisId, AxisReport> axes_;
  std::vector<ContactReport> contacts_;
};

}  // namespace taut
