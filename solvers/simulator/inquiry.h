#pragma once

#include <string>

#include "solvers/simulator/stepper.h"

namespace taut {

/// What those look at who say why a step or a start failed, or what cannot hold together.
struct Inquiry {
  const World& source;  ///< the user's, whose names are given
  const World& world;   ///< that is stepped, at the state before the step
  bool merges;          ///< some bodies of `source` are one in `world`
  Stepper& stepper;
  const Settings& settings;
  StepReport& report;  ///< gets the reason

  /// Ends the step with a status and a message, which goes on with the members of report.contradiction for
  /// Status::kContradiction.
  void end_step(Status status, std::string message) const;
};

}  // namespace taut
