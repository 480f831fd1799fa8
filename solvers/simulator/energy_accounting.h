#pragma once

#include <vector>

#include "core/world/world.h"
#include "solvers/common/step_report.h"

namespace taut {

class Archive;

/// Fills StepReport::ledger: energies before and after a step, and what the works of the step explain of
/// their difference: each impulse j of a kick from V₀ to V₁ does the work j·½ (V₀ + V₁).  Energies after a
/// step serve as those before the next unless the world was changed, so that a step measures them once.
/// (solvers/simulator, "Energy")
class EnergyAccounting {
 public:
  /// Springs between bodies that have rows are no force laws in the works.
  explicit EnergyAccounting(Springs springs) : springs_(springs) {}
  /// Before a step, with the state as the user left it.  `seen` is the world that has it: `world` itself, or
  /// the one whose bodies it has merged.
  void begin(const World& world, const World& seen, StepReport& report);
  /// After joints were closed and velocities made tangent; `state` is where the step starts.
  void start(const World& world, const State& state);
  /// After a step; the world is at its end, joints that broke are detached, and the report has the kinetic
  /// energy.  `by_works`: it has works, too.
  void close(const World& world, StepReport& report, bool by_works);

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive, const World& world);

 private:
  struct Energies {
    double kinetic = 0, potential = 0;
    double springs = 0;      ///< not in the potential
    double dissipative = 0;  ///< that of laws that are not conservative
    double stored() const { return potential + springs; }
    double total() const { return kinetic + stored(); }
  };
  struct Versions {
    std::int64_t topology = -1, state = -1, axes = -1;
    friend bool operator==(const Versions&, const Versions&) = default;
  };
  Energies measure(const World& world, const State& state, double kinetic);
  static Versions versions(const World& world) {
    return {world.topology_version(), world.state_version(), world.axis_version()};
  }

  Springs springs_;
  Energies start_, end_, first_;
  Versions end_versions_;
  double stabilisation_ = 0;
  std::vector<Wrench> scratch_;
};

}  // namespace taut
