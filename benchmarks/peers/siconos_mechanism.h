#pragma once

#include <memory>
#include <string>
#include <vector>

#include "benchmarks/peers/plain_system.h"

/// Siconos behind plain data: with Debian's Boost its headers do not compile as C++20.
namespace taut::peers {

struct SiconosSettings {
  bool projection = false;          ///< positions are projected on the joints after each step
  bool blocks = true;               ///< sparse blocks and MUMPS; otherwise dense LU
  double theta = 0.5;               ///< of the Moreau–Jean scheme
  int newton_iterations = 50;       ///< 1: Siconos's linear mode, without a check of the residual
  double newton_tolerance = 1e-6;   ///< of the momentum balance
  double constraint_tolerance = 0;  ///< of the projection, each row [m or 1]
  int projection_iterations = 50;
  double dt = 0;
};

class SiconosMechanism {
 public:
  /// With more joints the projection of Siconos 4.4 writes past its arrays.
  static constexpr int kMaxProjectedJoints = 199;

  SiconosMechanism(const PlainSystem& system, const SiconosSettings& settings);
  ~SiconosMechanism();
  /// @throws std::exception if Siconos gives up.
  void step();
  /// What the solver said in the last step; 0 if it found nothing wrong.
  int solver_error() const;
  void read(std::vector<PlainMotion>& bodies) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace taut::peers
