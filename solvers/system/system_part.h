#pragma once

#include <vector>

namespace taut {

/// Some joints and contacts of a system with their bodies, as indices there, ascending; rows follow from the
/// joints.
struct SystemPart {
  std::vector<int> bodies, joints, rows;
  std::vector<int> slots;  ///< of contacts: the last of the joints

  friend bool operator==(const SystemPart&, const SystemPart&) = default;
};

}  // namespace taut
