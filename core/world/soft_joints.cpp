#include "core/world/soft_joints.h"

#include <algorithm>
#include <utility>

namespace taut::detail {
namespace {

/// Whether the rows in metres, and those in radians, give way.
std::pair<bool, bool> softness(const std::optional<JointCompliance>& compliance) {
  if (!compliance) return {false, false};
  return {compliance->translation > 0, compliance->rotation > 0};
}

}  // namespace

std::optional<JointCompliance> SoftJoints::compliance(int joint) const {
  const auto found = joints_.find(joint);
  if (found == joints_.end()) return {};
  return found->second.compliance;
}

std::map<int, JointCompliance> SoftJoints::compliances() const {
  std::map<int, JointCompliance> all;
  for (const auto& [joint, soft] : joints_) all.emplace_hint(all.end(), joint, soft.compliance);
  return all;
}

double SoftJoints::energy(int joint, const State& state) const {
  const auto found = joints_.find(joint);
  if (found == joints_.end()) return 0;
  const auto& [values, rows] = found->second;
  double energy = 0;
  for (const RowGroup& group : rows) {
    double phi[6];
    group.part->residual(state, phi);
    const double compliance = group.angular ? values.rotation : values.translation;
    for (int i = 0; i < group.rows; ++i) energy += 0.5 * phi[i] * phi[i] / compliance;
  }
  return energy;
}

void SoftJoints::soften(int joint, RowSink& sink) const {
  const auto found = joints_.find(joint);
  if (found == joints_.end()) return;
  const auto [translation, rotation] = softness(found->second.compliance);
  sink.soften(translation, rotation);
}

bool SoftJoints::has_same_joints(const SoftJoints& other) const {
  return std::equal(joints_.begin(), joints_.end(), other.joints_.begin(), other.joints_.end(),
                    [](const auto& a, const auto& b) { return a.first == b.first; });
}

bool SoftJoints::set(int index, const Joint& joint, const std::optional<JointCompliance>& compliance) {
  const auto before = softness(this->compliance(index)), after = softness(compliance);
  joints_.erase(index);
  if (compliance) {
    Entry soft{*compliance, {}};
    RowSink sink;
    sink.soften(after.first, after.second);
    sink.keep_soft_parts(joint, soft.rows);
    joint.append_rows(sink);
    joints_.emplace(index, std::move(soft));
  }
  return before != after;
}

void SoftJoints::copy_compliances(const SoftJoints& from) {
  for (const auto& [joint, soft] : from.joints_) joints_.at(joint).compliance = soft.compliance;
}

}  // namespace taut::detail
