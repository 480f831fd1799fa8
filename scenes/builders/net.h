#pragma once

#include <vector>

#include "scenes/builders/scene.h"

namespace taut {

/// n × n nodes joined by rods of 0.1 m with a ball joint from one rod end of each node to every other:
///   net-flag      pinned at two neighbouring corners
///   net-corners   pinned at all four corners, with some slack
///   net-catch     net-corners whose rods touch a ball that falls into it
///   net           short name of net-corners with other defaults
/// All rows are independent.
std::vector<SceneInfo> net_scenes();

/// Bodies of a net whose rods are added first of all, x rods with j outer, then y rods with i outer, and what
/// meets at its nodes.
struct NetRods {
  static constexpr double kHalf = 0.05;  ///< half the length of a rod [m]
  /// An end of a rod, from its centre.
  struct End {
    BodyId rod;
    Vec3 p;
  };
  BodyId x(int i, int j) const { return {1 + j * (n - 1) + i}; }  ///< from node (i, j) to (i+1, j)
  BodyId y(int i, int j) const { return {1 + n * (n - 1) + i * (n - 1) + j}; }  ///< … to (i, j+1)
  /// The ends at node (i, j), those of x rods first.  The first one is the hub, which the others hang on.
  std::vector<End> ends(int i, int j) const;
  int n = 0;  ///< nodes along an edge
};

}  // namespace taut
