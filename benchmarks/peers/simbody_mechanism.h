#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

/// Simbody behind plain data: its headers do not compile as C++20.
namespace taut::peers {

struct SimbodyBody {
  double mass = 0;
  std::array<double, 3> moments{}, p{};
  std::array<double, 4> q{};  ///< w, x, y, z, body to world
};

/// A joint with its frames in A and B: origin at the anchor, z along the axis of a hinge.
struct SimbodyJoint {
  enum Kind { kBall, kHinge, kFixed } kind = kBall;
  int a = 0, b = 0;
  std::array<double, 3> p_A{}, p_B{};
  std::array<double, 4> q_A{}, q_B{};
};

struct SimbodySystem {
  std::array<double, 3> gravity{};
  std::vector<SimbodyBody> bodies;  ///< 0 is the ground
  std::vector<SimbodyJoint> tree;   ///< A is the parent, parents before children
  std::vector<SimbodyJoint> loops;
};

struct SimbodySettings {
  bool euler = false;               ///< semi-explicit with fixed steps; otherwise Runge–Kutta–Merson
  double accuracy = 1e-3;           ///< of the latter
  double constraint_tolerance = 0;  ///< 0: Simbody's own
  double dt = 0;
};

class SimbodyMechanism {
 public:
  SimbodyMechanism(const SimbodySystem& system, const SimbodySettings& settings);
  ~SimbodyMechanism();
  /// @throws std::exception if the integrator gives up.
  void step_to(double time);
  /// Per body: p, q (w, x, y, z), ω, v: 13 numbers.
  void read(std::vector<std::array<double, 13>>& bodies) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace taut::peers
