#include "solvers/simulator/merged_bodies.h"

namespace taut {

MergedBodies::MergedBodies(World& source, const Settings& settings)
    : source_(source),
      merged_(settings.merge_fixed_joints ? std::make_unique<MergedWorld>(source, settings.position_tolerance)
                                          : nullptr),
      world_(merged_ ? merged_->world() : source) {}

void MergedBodies::wake_all() {
  source_.wake_all();
  world_.wake_all();
}

void MergedBodies::follow() {
  if (merged_ && merged_->update(source_)) set_since_step_ = true;
}

MergedWorld::OpenWeld MergedBodies::place_members(const State& state) {
  merged_->expand(state, placed_);
  return merged_->widest_weld(source_, placed_);
}

void MergedBodies::publish() {
  if (!merged_ || published_version_ == world_.state_version()) return;
  merged_->give_sleep(source_);
  merged_->expand(world_.state(), placed_);
  source_.set_state(placed_);
  merged_->note_state(source_);
  note_published();
}

void MergedBodies::give_sleep() {
  if (merged_) merged_->give_sleep(source_);
}

void MergedBodies::note_restored() {
  if (merged_) merged_->note_state(source_), merged_->note_wakes(source_);
}

void MergedBodies::refer_to_source(Contact& contact) const {
  if (!merged_) return;
  const auto refer = [&](BodyId& body, Vec3& point, ShapeId shape) {
    body = source_.shape(shape).body;
    if (merged_->is_carried(body)) point = merged_->carriers().frames[body.index].local(point);
  };
  refer(contact.A, contact.p_AP, contact.a);
  refer(contact.B, contact.p_BQ, contact.b);
}

void MergedBodies::refer_to_carriers(std::vector<ContactStretch>& stretches) const {
  if (!merged_) return;
  for (ContactStretch& s : stretches)
    if (const BodyId body = source_.shape(s.a).body; merged_->is_carried(body))
      s.p_AP = merged_->carriers().frames[body.index].point(s.p_AP);
}

void MergedBodies::refer_to_source(std::vector<ContactStretch>& stretches) const {
  if (!merged_) return;
  for (ContactStretch& s : stretches)
    if (const BodyId body = source_.shape(s.a).body; merged_->is_carried(body))
      s.p_AP = merged_->carriers().frames[body.index].local(s.p_AP);
}

}  // namespace taut
