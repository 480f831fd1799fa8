#pragma once

#include <string>
#include <vector>

#include "core/constraints/rows.h"
#include "core/world/world.h"

namespace taut {

/// The bodies that move as a forest: each hangs on a fixed body or on another one by all joints between the
/// two, or on nothing.  Joints without equality rows hold nothing and are no edges; those that close loops or
/// have more than two bodies are cut.  Where joints make loops, the ones with most rows are branches.
/// (solvers/integrators, "Reduced coordinates")
struct JointTree {
  /// A moving body and the joints to its parent, by their index in Rows::joints(); none: it is free.
  struct Branch {
    int body = 0, parent = 0;  ///< indices of bodies
    std::vector<int> blocks;   ///< of the joints
  };
  std::vector<Branch> branches;  ///< parents before their children
  std::vector<int> cuts;         ///< the joints that are in no branch and hold something, ascending

  /// `rows` are those of the world.
  JointTree(const World& world, const Rows& rows);
};

/// What of a world integrators in reduced coordinates do not have, naming the joint and its property: joints
/// that break or are soft, winches, motors that brake, and friction that grows with the load or is that of a
/// swing.  Empty if there is nothing.
std::string tree_problem(const World& world, const Rows& rows);

}  // namespace taut
