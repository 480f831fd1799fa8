#pragma once

#include <memory>
#include <vector>

#include "benchmarks/peers/plain_system.h"

/// Simbody behind plain data: its headers do not compile as C++20.
namespace taut::peers {

struct SimbodySettings {
  bool euler = false;               ///< semi-explicit with fixed steps; otherwise Runge–Kutta–Merson
  double accuracy = 1e-3;           ///< of the latter
  double constraint_tolerance = 0;  ///< 0: Simbody's own
  double dt = 0;
};

class SimbodyMechanism {
 public:
  SimbodyMechanism(const PlainSystem& system, const SimbodySettings& settings);
  ~SimbodyMechanism();
  /// @throws std::exception if the integrator gives up.
  void step_to(double time);
  void read(std::vector<PlainMotion>& bodies) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace taut::peers
