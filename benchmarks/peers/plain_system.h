#pragma once

#include <array>
#include <vector>

/// A System in plain data, for engines whose headers do not compile as C++20.
namespace taut::peers {

struct PlainBody {
  double mass = 0;
  std::array<double, 3> moments{}, p{};
  std::array<double, 4> q{};  ///< w, x, y, z, body to world
};

/// A joint with its frames in A and B: origin at the anchor, z along the axis of a hinge.
struct PlainJoint {
  enum Kind { kBall, kHinge, kFixed } kind = kBall;
  int a = 0, b = 0;
  std::array<double, 3> p_A{}, p_B{};
  std::array<double, 4> q_A{}, q_B{};
};

struct PlainSystem {
  std::array<double, 3> gravity{};
  std::vector<PlainBody> bodies;  ///< 0 is the ground
  std::vector<PlainJoint> tree;   ///< A is the parent, parents before children
  std::vector<PlainJoint> loops;
};

/// What an engine gives of a body: p, q (w, x, y, z), ω, v, the last two in world axes.
using PlainMotion = std::array<double, 13>;

}  // namespace taut::peers
