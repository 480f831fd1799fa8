#include <algorithm>

#include "core/state/same_state.h"
#include "solvers/simulator/simulator_impl.h"

// What was moved between steps; islands that fall asleep and wake. (solvers/simulator, "Sleep")
namespace taut {

std::span<const ContactSet::Place> Simulator::Impl::places() const {
  if (!scheme_ || scheme_->contacts().empty()) return {};
  return scheme_->contacts().set().places();
}

/// The integrator has a state, which that of the world can be compared with.
bool Simulator::Impl::has_started() const {
  return force_level_ ? !force_level_->state().poses.empty() : scheme_ && !scheme_->state().poses.empty();
}

/// The state of a body is not what the integrator has left.
bool Simulator::Impl::is_moved(int body) const {
  const State &now = world_.state(), &then = force_level_ ? force_level_->state() : scheme_->state();
  return !same(now.poses[body], then.poses[body]) || !same(now.twists[body], then.twists[body]);
}

/// Which they are, of all bodies; those that have just fallen asleep are where they were.
std::vector<char> Simulator::Impl::moved_bodies() const {
  std::vector<char> moved(world_.body_count(), false);
  if (retaken_) return moved;
  for (int b = 0; b < std::ssize(scheme_->state().poses); ++b)
    moved[b] = !world_.is_asleep({b}) && is_moved(b);
  return moved;
}

/// What the user has moved since the last step is not at rest, nor is anything if it was a fixed body.
void Simulator::Impl::note_moved_bodies() {
  if (!system_ || !has_started() || state_version_ == world_.state_version()) return;
  for (int b = 0; b < system_->rows().body_count(); ++b)
    if (is_moved(b)) world_.is_fixed({b}) ? world_.wake_all() : world_.wake({b});
}

void Simulator::Impl::wake_islands(double h) {
  note_moved_bodies();
  sleep_->wake(world_, places(), h);
}

/// Before a step of dt, with all that the last one has left: the bodies that fall asleep, what they bear
/// noted.
void Simulator::Impl::collect_sleep_candidates(double dt) {
  wake_islands(dt);
  sleep_candidates_.clear(), candidate_twists_.clear();
  const bool known = system_ && topology_version_ == world_.topology_version() &&
                     geometry_version_ == world_.geometry_version();
  if (!known || !report_.advanced() || report_.dt == 0) return;
  sleep_candidates_ = sleep_->tired(world_, system_->rows(), places());
  for (BodyId body : sleep_candidates_) candidate_twists_.push_back(world_.twist(body));
  if (!sleep_candidates_.empty()) note_reports_of(sleep_candidates_);
}

/// A step that failed changes nothing: not who sleeps, either.
void Simulator::Impl::restore_awake() {
  for (std::size_t i = 0; i < sleep_candidates_.size(); ++i)
    world_.set_twist(sleep_candidates_[i], candidate_twists_[i]);
  sleep_candidates_.clear(), candidate_twists_.clear();
}

/// After a step that is done, or could not be: whether bodies woke for it.
bool Simulator::Impl::wakes(bool done) {
  if (done) return sleep_->wake_touched(world_, scheme_->contacts().reports());
  if (world_.asleep_count() == 0) return false;
  world_.wake_all();
  restore_awake();
  return true;
}

/// Reactions, axes and contacts of bodies that are about to fall asleep stay as they were in the last step.
void Simulator::Impl::note_reports_of(std::span<const BodyId> tired) {
  std::vector<char> is_tired(world_.body_count(), false);
  for (BodyId body : tired) is_tired[body.index] = true;
  const auto carrier = [&](BodyId body) { return merged_ ? merged_->carriers().bodies[body.index] : body; };
  for (int j = 0; j < source_.joint_count(); ++j) {
    const JointId joint{j};
    const std::span<const BodyId> bodies = source_.joint(joint).bodies();
    if (!source_.is_attached(joint) ||
        std::none_of(bodies.begin(), bodies.end(), [&](BodyId b) { return is_tired[carrier(b).index]; }))
      continue;
    asleep_.reactions[joint] = mean_reaction(joint);
    for (int k = 0; k < source_.axis_count(joint); ++k) asleep_.axes[{joint, k}] = axis_report({joint, k});
  }
  std::erase_if(asleep_.contacts, [&](const ContactReport& c) { return !rests(c); });
  for (const ContactReport& c : contacts())
    if (is_tired[carrier(c.contact.A).index] || is_tired[carrier(c.contact.B).index])
      asleep_.contacts.push_back(c);
}

/// A contact between bodies of which one is asleep and none moves.
bool Simulator::Impl::rests(const ContactReport& report) const {
  const BodyId A = report.contact.A, B = report.contact.B;
  return !source_.moves(A) && !source_.moves(B) && (source_.is_asleep(A) || source_.is_asleep(B));
}

bool Simulator::Impl::rests(JointId joint) const {
  if (source_.asleep_count() == 0) return false;
  const std::span<const BodyId> bodies = source_.joint(joint).bodies();
  return std::any_of(bodies.begin(), bodies.end(), [&](BodyId b) { return source_.is_asleep(b); });
}

}  // namespace taut
