#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "solvers/complementarity/contact_stage.h"
#include "solvers/simulator/simulator.h"

namespace taut {

/// Writes the last stages of each step, of positions and of velocities, as friction problems for `taut
/// friction`: joints are eliminated.                                        (scenes/files/FRICTION.md)
class StageDump {
 public:
  /// The folder is made if it is not there.
  explicit StageDump(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// From now on it keeps what `simulator` tells of its stages; it must live as long.
  void watch(Simulator& simulator);
  /// STEP-positions.dat and STEP-velocities.dat of a step that has ended, as far as it had such stages.
  /// @returns what could not be written and why, or "".
  std::string write(std::int64_t step);

 private:
  std::filesystem::path folder_;
  std::array<std::optional<FrictionProblem>, 2> last_;  // by ContactStage::Kind
};

}  // namespace taut
