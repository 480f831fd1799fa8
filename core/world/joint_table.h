#pragma once

#include <memory>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/world/id_check.h"
#include "core/world/joint.h"
#include "core/world/name_table.h"

namespace taut::detail {

/// The joints of a World, their names, and which of them are out.
class JointTable {
 public:
  int count() const { return static_cast<int>(joints_.size()); }  ///< detached ones too
  int detached_count() const { return static_cast<int>(detached_.size()); }
  /// Index of a joint.  @throws std::invalid_argument if there is no such one.
  int checked(JointId id) const { return index_of(id, joints_.size(), "joint"); }

  const NameTable& names() const { return names_; }
  const Joint& operator[](int joint) const { return *joints_[joint]; }
  const std::shared_ptr<const Joint>& shared(int joint) const { return joints_[joint]; }
  bool is_attached(int joint) const;
  const std::set<int>& detached() const { return detached_; }  ///< by index, in ascending order
  /// Joints that couple an axis of this one, in ascending order.
  std::vector<JointId> coupled_to(JointId id) const;
  /// Of these joints and all that they couple, directly or not: indices.
  /// @throws std::invalid_argument for a missing joint.
  std::set<int> with_coupled(std::span<const JointId> joints) const;

  /// @throws std::invalid_argument if the name is taken.
  void add(std::string name, std::shared_ptr<const Joint> joint);
  void replace(int joint, std::shared_ptr<const Joint> by);
  void detach(int joint);
  void attach(int joint);

 private:
  NameTable names_{"joint"};
  std::vector<std::shared_ptr<const Joint>> joints_;
  std::set<int> detached_;
};

}  // namespace taut::detail
