#include "core/world/joint_table.h"

#include <algorithm>

namespace taut::detail {

void JointTable::add(std::string name, std::shared_ptr<const Joint> joint) {
  names_.add(std::move(name));
  joints_.push_back(std::move(joint));
}

std::vector<JointId> JointTable::coupled_to(JointId id) const {
  std::vector<JointId> found;
  for (int j = 0; j < count(); ++j) {
    const std::vector<JointId> couples = joints_[j]->couples();
    if (std::find(couples.begin(), couples.end(), id) != couples.end()) found.push_back({j});
  }
  return found;
}

std::set<int> JointTable::with_coupled(std::span<const JointId> joints) const {
  std::vector<JointId> open(joints.begin(), joints.end());
  std::set<int> all;
  while (!open.empty()) {
    const int j = checked(open.back());
    open.pop_back();
    if (!all.insert(j).second) continue;
    for (JointId other : joints_[j]->couples()) open.push_back(other);
  }
  return all;
}

bool JointTable::is_attached(int joint) const { return !detached_.contains(joint); }
void JointTable::replace(int joint, std::shared_ptr<const Joint> by) { joints_[joint] = std::move(by); }
void JointTable::detach(int joint) { detached_.insert(joint); }
void JointTable::attach(int joint) { detached_.erase(joint); }

}  // namespace taut::detail
