#pragma once

#include <string>
#include <vector>

#include "core/constraints/rows.h"
#include "core/world/world.h"

namespace taut {

/// The bodies that move as a forest: each hangs on a fixed body or on another one by all joints between the
/// two, or on nothing.  Joints without equality rows hold nothing and are no edges.
/// (solvers/integrators, "Reduced coordinates")
struct JointTree {
  /// A moving body and the joints to its parent, by their index in Rows::joints(); none: it is free.
  struct Branch {
    int body = 0, parent = 0;  ///< indices of bodies
    std::vector<int> blocks;   ///< of the joints
  };
  std::vector<Branch> branches;  ///< parents before their children
  /// Why these joints make none, naming one of them; empty if they do.
  std::string problem;

  /// `rows` are those of the world.
  JointTree(const World& world, const Rows& rows);
};

/// What of a world integrators in reduced coordinates do not have, naming the joint and its property: joints
/// that make no tree, break, are soft, or have limits, motors and friction whose forces do not follow from
/// the state.  Empty if there is nothing.
std::string tree_problem(const World& world, const Rows& rows);

}  // namespace taut
