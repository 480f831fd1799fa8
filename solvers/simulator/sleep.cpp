#include "solvers/simulator/sleep.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "solvers/laws/law_constants.h"

namespace taut {
namespace {

struct SleepTuning {
  /// Forces are the same if they differ by less than this part of themselves and the weight: round-off of
  /// forces that are computed anew.
  static constexpr double kSameForce = 1e-9;
  /// How many times faster bodies may come together by the end of a step than they did before.  Chosen.
  static constexpr double kFaster = 2;
};

}  // namespace

/// Bodies that have been added.
void Sleep::read_bodies(const World& world) {
  for (int b = static_cast<int>(quiet_.size()); b < world.body_count(); ++b) {
    const MassProperties& mass = world.mass_properties({b});
    gyration_.push_back(mass.principal_moments().maxCoeff() / mass.mass());
    quiet_.push_back(0);
    wake_counts_.push_back(world.wake_count({b}));
    island_of_.push_back(-1);
  }
  forces_.resize(quiet_.size());
  forces_then_.resize(quiet_.size());
}

/// v² + ω² k² ≥ 2 T / m.
bool Sleep::is_slow(const World& world, int body) const {
  const Twist& V = world.state().twists[body];
  return V.v.squaredNorm() + gyration_[body] * V.w.squaredNorm() <= speed_ * speed_;
}

void Sleep::watch(const World& world, double dt) {
  if (!enabled_) return;
  read_bodies(world);
  for (int b = 0; b < world.body_count(); ++b) quiet_[b] = is_slow(world, b) ? quiet_[b] + dt : 0;
}

void Sleep::join(const World& world, std::span<const BodyId> bodies) {
  int first = -1;
  for (BodyId body : bodies) {
    if (!world.moves(body)) continue;
    if (first < 0) first = body.index;
    connected_.join(first, body.index);
  }
}

void Sleep::connect(const World& world, std::span<const ContactCache::Slot> slots) {
  connected_.reset(static_cast<int>(quiet_.size()));
  for (int j = 0; j < world.joint_count(); ++j)
    if (world.is_attached(JointId{j})) join(world, world.joint(JointId{j}).bodies());
  for (int f = 0; f < world.force_count(); ++f) join(world, world.force(ForceId{f}).bodies());
  for (const ContactCache::Slot& slot : slots)
    if (slot.active) join(world, std::array{BodyId{slot.at.a}, BodyId{slot.at.b}});
}

/// Islands with a joint that follows the time, or a motor that would turn if it could.
void Sleep::note_restless(const World& world, const Rows& rows) {
  restless_.assign(quiet_.size(), false);
  const auto note = [&](JointId joint) {
    for (BodyId body : world.joint(joint).bodies())
      if (world.moves(body)) restless_[connected_.find(body.index)] = true;
  };
  for (int r = 0; r < rows.first_contact_row(); ++r)
    if (rows.row(r).store->depends_on_time())
      if (const std::optional<JointId> joint = rows.joint_of(r)) note(*joint);
  for (const Rows::AxisRow& row : rows.axis_rows())
    if (const AxisId* axis = row.axis(); axis && world.axis_properties(*axis).keeps_going())
      note(axis->joint);
  for (int b = 0; b < world.body_count(); ++b)
    if (world.moves({b}) && !(is_quiet(b) && is_slow(world, b))) restless_[connected_.find(b)] = true;
}

void Sleep::choose_candidates(const World& world, const Rows& rows,
                              std::span<const ContactCache::Slot> slots) {
  candidates_ = collect_sleep_candidates(world, rows, slots);
  candidate_twists_.clear();
  for (BodyId body : candidates_) candidate_twists_.push_back(world.twist(body));
}

std::vector<BodyId> Sleep::collect_sleep_candidates(const World& world, const Rows& rows,
                                                    std::span<const ContactCache::Slot> slots) {
  std::vector<BodyId> bodies;
  const auto may_sleep = [&](int b) { return is_quiet(b) && world.moves({b}) && is_slow(world, b); };
  int first = 0;
  while (first < std::ssize(quiet_) && !may_sleep(first)) ++first;
  if (first == std::ssize(quiet_)) return bodies;
  connect(world, slots);
  note_restless(world, rows);
  for (int b = first; b < std::ssize(quiet_); ++b)
    if (may_sleep(b) && !restless_[connected_.find(b)]) bodies.push_back({b});
  return bodies;
}

/// By islands, as collect_sleep_candidates() has sorted them.
void Sleep::put_to_sleep(World& world) {
  if (candidates_.empty()) return;
  std::vector<int> island_of_first(quiet_.size(), -1);
  for (BodyId body : candidates_) {
    int& island = island_of_first[connected_.find(body.index)];
    if (island < 0) {
      const auto place =
          std::find_if(islands_.begin(), islands_.end(), [](const auto& i) { return i.empty(); });
      island = static_cast<int>(place - islands_.begin());
      if (place == islands_.end()) islands_.emplace_back();
    }
    islands_[island].push_back(body);
    island_of_[body.index] = island;
    world.put_to_sleep(body);
  }
  world.forces(world.state(), forces_);
  for (BodyId body : candidates_) forces_then_[body.index] = forces_[body.index];
}

void Sleep::wake_island(World& world, int island) {
  for (BodyId body : islands_[island]) {
    world.wake(body);
    wake_counts_[body.index] = world.wake_count(body);
    island_of_[body.index] = -1;
    quiet_[body.index] = 0;
  }
  islands_[island].clear();
}

bool Sleep::forces_changed(const World& world, int body) const {
  const Wrench &now = forces_[body], &then = forces_then_[body];
  const double weight = world.mass_properties({body}).mass() * world.gravity().norm();
  const double size = then.force.norm() + weight,
               turn = then.torque.norm() + size * std::sqrt(gyration_[body]);
  return !((now.force - then.force).norm() <= SleepTuning::kSameForce * size &&
           (now.torque - then.torque).norm() <= SleepTuning::kSameForce * turn);
}

bool Sleep::any_asleep() const {
  return std::any_of(islands_.begin(), islands_.end(), [](const auto& island) { return !island.empty(); });
}

void Sleep::wake(World& world, std::span<const ContactCache::Slot> slots, double h) {
  if (!enabled_) return;
  read_bodies(world);
  wake_stirred(world);
  if (!any_asleep()) return;
  wake_pulled(world);
  wake_approached(world, slots, h);
}

/// Islands of bodies that were woken.
void Sleep::wake_stirred(World& world) {
  for (int b = 0; b < world.body_count(); ++b) {
    if (island_of_[b] < 0 && world.is_asleep({b})) world.wake({b});  // it sleeps for another simulator
    const bool slept = island_of_[b] >= 0 && !world.is_asleep({b});
    if (wake_counts_[b] == world.wake_count({b}) && !slept) continue;
    quiet_[b] = 0;
    if (island_of_[b] >= 0) wake_island(world, island_of_[b]);
    wake_counts_[b] = world.wake_count({b});
  }
}

/// Islands on which forces have changed.
void Sleep::wake_pulled(World& world) {
  if (world.force_count() == 0) return;
  world.forces(world.state(), forces_);
  for (int b = 0; b < world.body_count(); ++b)
    if (island_of_[b] >= 0 && forces_changed(world, b)) wake_island(world, island_of_[b]);
}

/// Islands that a moving body may touch within h.
void Sleep::wake_approached(World& world, std::span<const ContactCache::Slot> slots, double h) {
  const State& state = world.state();
  for (const ContactCache::Slot& slot : slots) {
    if (!slot.active || world.moves({slot.at.a}) == world.moves({slot.at.b})) continue;
    const int asleep = island_of_[world.moves({slot.at.a}) ? slot.at.b : slot.at.a];
    if (asleep < 0) continue;  // a fixed body
    const Contact& contact = slot.contact;
    const Vec3 v = state.twists[slot.at.b].at(state.poses[slot.at.b].q * contact.p_BQ) -
                   state.twists[slot.at.a].at(state.poses[slot.at.a].q * contact.p_AP);
    const double approach = std::max(0.0, -contact.normal.dot(v)) + world.gravity().norm() * h;
    if (contact.gap <= LawTuning::kTouch + SleepTuning::kFaster * h * approach) wake_island(world, asleep);
  }
}

bool Sleep::wake_after(World& world, std::span<const ContactReport> contacts, bool done) {
  if (done) return wake_touched(world, contacts);
  if (world.asleep_count() == 0) return false;
  world.wake_all();
  restore_awake(world);
  return true;
}

void Sleep::restore_awake(World& world) {
  for (std::size_t i = 0; i < candidates_.size(); ++i) world.set_twist(candidates_[i], candidate_twists_[i]);
  forget_candidates();
}

bool Sleep::wake_touched(World& world, std::span<const ContactReport> contacts) {
  bool any = false;
  for (const ContactReport& report : contacts) {
    if (report.force.isZero(0)) continue;
    for (BodyId body : {report.contact.A, report.contact.B}) {
      const int island = body.index < std::ssize(island_of_) ? island_of_[body.index] : -1;
      if (island < 0) continue;
      wake_island(world, island);
      any = true;
    }
  }
  return any;
}

}  // namespace taut
