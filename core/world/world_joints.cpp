#include <algorithm>

#include "core/base/check.h"
#include "core/world/world.h"

// Joints as a whole: what they bear, how they give way, leaving and coming back.
namespace taut {

void World::set_break(JointId id, std::optional<BreakLimits> limits) {
  identity_.require_free();
  checked(id);
  if (limits) check_joint(name(id), *limits);
  const auto place = std::lower_bound(breakable_.begin(), breakable_.end(), id,
                                      [](const auto& entry, JointId joint) { return entry.first < joint; });
  const bool there = place != breakable_.end() && place->first == id;
  if (there && limits)
    place->second = *limits;
  else if (there)
    breakable_.erase(place);
  else if (limits)
    breakable_.insert(place, {id, *limits});
  wake_bodies_of(id);
  ++property_version_;
}

void World::set_compliance(JointId id, std::optional<JointCompliance> compliance) {
  identity_.require_free();
  const Joint& made = joint(id);
  if (compliance) check_joint(name(id), *compliance);
  const auto old = soft_.find(id.index);
  const auto softness = [](const JointCompliance& c) { return std::pair(c.translation > 0, c.rotation > 0); };
  const auto before = old == soft_.end() ? std::pair(false, false) : softness(old->second.compliance);
  const auto after = compliance ? softness(*compliance) : std::pair(false, false);
  if (old != soft_.end()) soft_.erase(old);
  if (compliance) {
    SoftJoint soft{*compliance, {}};
    RowSink sink;
    sink.groups_ = &soft.rows;
    sink.made_for_ = &made;
    sink.soft_translation_ = after.first;
    sink.soft_rotation_ = after.second;
    made.append_rows(sink);
    soft_.emplace(id.index, std::move(soft));
  }
  wake_bodies_of(id);
  if (before != after) ++topology_version_;
  ++axis_version_;
}

std::optional<JointCompliance> World::compliance(JointId id) const {
  const auto found = soft_.find(checked(id));
  if (found == soft_.end()) return {};
  return found->second.compliance;
}

void World::soften(JointId id, RowSink& sink) const {
  const auto found = soft_.find(id.index);
  if (found == soft_.end()) return;
  sink.soft_translation_ = found->second.compliance.translation > 0;
  sink.soft_rotation_ = found->second.compliance.rotation > 0;
}

/// Σ ½ φ²/compliance over the softened rows.
double World::elastic_energy(const SoftJoint& soft, const State& state) {
  double energy = 0;
  for (const detail::RowGroup& group : soft.rows) {
    double phi[6];
    group.part->residual(state, phi);
    const double compliance = group.angular ? soft.compliance.rotation : soft.compliance.translation;
    for (int i = 0; i < group.rows; ++i) energy += 0.5 * phi[i] * phi[i] / compliance;
  }
  return energy;
}

double World::spring_energy_of(JointId id, const State& state) const {
  double energy = 0;
  for (int k = axis_start_[checked(id)]; k < axis_start_[id.index + 1]; ++k) {
    const AxisProperties& properties = axis_properties_[k];
    const bool soft_limit = properties.limits && properties.limits->compliance > 0;
    if (!properties.spring && !soft_limit) continue;
    double theta = 0;
    axes_[k].coordinate->residual(state, &theta);
    if (properties.spring) energy += taut::spring_energy(*properties.spring, theta);
    if (soft_limit) energy += limit_energy(*properties.limits, theta);
  }
  if (const auto found = soft_.find(id.index); found != soft_.end())
    energy += elastic_energy(found->second, state);
  return energy;
}

void World::detach(JointId id) {
  identity_.require_free();
  if (!is_attached(id)) return;
  detached_.insert(id.index);
  wake_bodies_of(id);
  for (int j = 0; j < joint_count(); ++j) {  // what couples its axes goes with it
    const std::vector<JointId> couples = joints_[j]->couples();
    if (std::find(couples.begin(), couples.end(), id) != couples.end()) detach({j});
  }
  find_jointed_bodies();
  ++topology_version_;
}

void World::detach_all_but(std::span<const JointId> joints) {
  identity_.require_free();
  std::vector<JointId> open(joints.begin(), joints.end());
  std::set<int> stay;
  while (!open.empty()) {
    const int j = checked(open.back());
    open.pop_back();
    if (!stay.insert(j).second) continue;
    for (JointId other : joints_[j]->couples()) open.push_back(other);
  }
  for (int j = 0; j < joint_count(); ++j)
    if (!stay.contains(j)) detached_.insert(detached_.end(), j);
  wake_all();
  find_jointed_bodies();
  ++topology_version_;
}

void World::attach(JointId id) {
  identity_.require_free();
  if (is_attached(id)) return;
  for (JointId other : joint(id).couples())
    if (!is_attached(other)) fail("joint " + name(id), "couples an axis of a detached joint", name(other));
  detached_.erase(id.index);
  wake_bodies_of(id);
  find_jointed_bodies();
  ++topology_version_;
}

void World::find_jointed_bodies() {
  jointed_.clear();
  for (int j = 0; j < joint_count(); ++j)
    if (is_attached({j})) note_jointed_bodies(*joints_[j]);
}

void World::note_jointed_bodies(const Joint& joint) {
  const std::span<const BodyId> bodies = joint.bodies();
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (std::size_t k = i + 1; k < bodies.size(); ++k) jointed_.insert(std::minmax(bodies[i], bodies[k]));
}

}  // namespace taut
