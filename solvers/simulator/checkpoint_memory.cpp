#include "solvers/simulator/checkpoint_memory.h"

#include <cmath>
#include <numeric>

#include "core/state/same_state.h"
#include "solvers/integrators/force_level.h"
#include "solvers/integrators/rattle.h"
#include "solvers/simulator/energy_accounting.h"
#include "solvers/simulator/sleep.h"

// What each part of a simulation remembers from one step to the next, as Archive writes and reads it.
// Whatever a step makes anew before it reads it is left out, and so are factors, which have the same bits
// when they are made again. (solvers/simulator, "Checkpoints")
namespace taut {

void transfer_fields(Archive& archive, ShapeId& id) { archive(id.index); }
void transfer_fields(Archive& archive, Material& m) {
  archive(m.restitution, m.static_friction, m.dynamic_friction, m.rolling_friction, m.spinning_friction,
          m.compliance);
}
void transfer_fields(Archive& archive, Contact& c) {
  archive(c.a, c.b, c.A, c.B, c.p_AP, c.p_BQ, c.normal, c.gap, c.feature);
}
void transfer_fields(Archive& archive, ContactReport& r) {
  archive(r.contact, r.force, r.torque, r.normal_force, r.sliding, r.impact_time);
}
void transfer_fields(Archive& archive, ContactWork& w) { archive(w.normal, w.friction); }
void transfer_fields(Archive& archive, AxisImpulse& i) {
  archive(i.motor, i.friction, i.limit, i.spring, i.damping, i.elastic_limit);
}
void transfer_fields(Archive& archive, AxisReport& r) {
  archive(r.force, r.work, r.power, r.stuck, r.saturated, r.at_limit, r.impact_time);
}
void transfer_fields(Archive& archive, Reaction& r) { archive(r.force, r.torque); }
void transfer_fields(Archive& archive, BreakEvent& e) {
  archive(e.joint, e.time, e.force, e.torque, e.energy, e.with);
}
void transfer_fields(Archive& archive, Rows::ContactPlace& p) { archive(p.a, p.b, p.twist); }
void transfer_fields(Archive& archive, row_parts::ContactFrame& f) { archive(f.n, f.t1, f.t2); }
void transfer_fields(Archive& archive, row_parts::ContactPoint& p) { archive(p.p_AP, p.p_BQ, p.frame); }
void transfer_fields(Archive& archive, RowLaw& law) {
  archive(law.steps, law.slope, law.at, law.level);
  Archive::index(law.steps, 0, RowLaw::kMaxSteps + 1);
}

namespace {

/// Segments of laws, −1 where there is none.
constexpr int kSegments = 2 * RowLaw::kMaxSteps + 1;

void require_shape(const World& world, ShapeId shape) { Archive::index(shape.index, 0, world.shape_count()); }

void require_bodies(const World& world, const Rows::ContactPlace& at) {
  for (int body : {at.a, at.b}) Archive::index(body, 0, world.body_count());
}

}  // namespace

void AxisForces::transfer(Archive& archive) {
  const auto axis = [&](Axis& a) {
    archive(a.anchor, a.stuck, a.broken, a.known, a.theta0, a.rate0, a.inertia, a.excess, a.limit_excess,
            a.beyond, a.spring, a.damping, a.implicit_damping, a.linear_damping, a.tangent_at, a.root_above,
            a.root_below, a.soft_limit, a.limit_level, a.limit_slope, a.load, a.load_change, a.motor_at,
            a.motor_force, a.friction_at, a.friction_force, a.lower_at, a.upper_at, a.lower_back,
            a.upper_back, a.spring_level, a.damping_level, a.spring_slope, a.damping_slope);
  };
  const std::size_t count = axes_.size();
  archive.each(axes_, axis);
  archive.each(impacts_, [&](Impact& i) { archive(i.stage, i.at_lower, i.rate, i.spent); });
  archive(reports_, struck_, impact_count_);
  archive.sized(released_);
  Archive::require(axes_.size() == count && impacts_.size() == count && reports_.size() == count,
                   "it has other axes");
  std::vector<std::pair<AxisId, int>> resting;  // and their memory, behind
  std::vector<Axis> memory;
  for (const auto& [id, known] : resting_) resting.emplace_back(id, 0), memory.push_back(known);
  archive(resting);
  archive.each(memory, axis);
  Archive::require(memory.size() == resting.size());
  resting_.clear();
  for (std::size_t i = 0; i < memory.size(); ++i) {
    (void)world_.axis_index(resting[i].first);  // throws for one that is not there
    resting_.emplace(resting[i].first, memory[i]);
  }
  before_ = axes_;
}

void ContactSet::transfer(Archive& archive, const World& world) {
  const auto place = [&](Place& p) {
    archive(p.at, p.active, p.unused, p.contact, p.material, p.parted, p.point, p.slip);
    require_bodies(world, p.at);
    if (!p.active && p.contact.a.index < 0) return;  // never used
    require_shape(world, p.contact.a), require_shape(world, p.contact.b);
  };
  archive.each(places_, place);
  archive.each(resting_, place);
  archive(parts_);
  std::vector<Contact> contacts = finder_.contacts();
  archive(contacts);
  for (const Contact& contact : contacts) require_shape(world, contact.a), require_shape(world, contact.b);
  if (!archive.reads()) return;
  finder_.recall(std::move(contacts));
  before_ = places_;
  origin_.resize(places_.size());
  std::iota(origin_.begin(), origin_.end(), 0);
  moved_ = origin_;
  sort_pairs();
}

void ContactLaws::transfer_residuals(Archive& archive) { archive(residual_, scale_, weakened_); }

void ContactForces::transfer(Archive& archive) {
  const auto disc = [&](Disc& d) { archive(d.bound, d.slips, d.direction, d.weight, d.given, d.target); };
  const auto point = [&](Point& p) {
    archive(p.soft.target, p.soft.softness, p.soft.most, p.active, p.live, p.touching, p.pressed, p.gap,
            p.approach, p.fresh, p.back, p.stuck, p.broken, p.stick_candidate, p.slipped, p.slip, p.first,
            p.first_torque, p.spin_bound, p.spin_given, p.impulse, p.torque, p.impact_time, p.slid);
    disc(p.sliding), disc(p.rolling);
  };
  archive.each(table_.points, point);
  archive.each(table_.impacts, [&](Impact& i) { archive(i.stage, i.rate, i.spent); });
  archive.each(resting_points_, point);
  archive(departed_, work_, struck_, impact_count_, table_.h, table_.in_velocities, table_.single_kick);
  Archive::require(table_.points.size() == table_.set.places().size() &&
                       table_.impacts.size() == table_.points.size() &&
                       resting_points_.size() == table_.set.resting().size(),
                   "it has other contacts");
  transfer_residuals(archive);
  before_ = table_.points;
  impacts_before_ = table_.impacts;
}

void RowUpdates::transfer(Archive& archive) {
  bool serves = version_ == system_.factor_version() && system_.factored();
  archive(serves);
  if (archive.reads()) {
    version_ = -1;
    columns_.clear();
    count_ = 0;
    if (serves) forget_old_factor();  // that of the checkpoint is there again
  }
  if (!serves) return;
  const int rows = system_.row_count();
  archive.each(columns_, [&](Column& c) {
    archive(c.row, c.masked);
    Archive::index(c.row, 0, rows);
  });
  Archive::require(columns_.size() <= kMaxRows);
  const std::size_t count = columns_.size();
  std::vector<double> solved(solved_.begin(), solved_.begin() + static_cast<std::ptrdiff_t>(count) * rows);
  archive.sized(solved);
  std::copy(solved.begin(), solved.end(), solved_.begin());
  // Entries beyond those in use are of factors that are gone.
  for (std::size_t i = 0; i < count; ++i) {
    if (columns_[i].masked) archive(diagonal_[i]);
    for (std::size_t k = 0; k < count; ++k) archive(gram_[i * kMaxRows + k]);
  }
  archive.sized(states_);
  archive(count_);
  Archive::index(count_, 0, static_cast<int>(count) + 1);
  for (int i = 0; i < count_; ++i) {
    archive(changed_[i]);
    Archive::index(changed_[i], 0, static_cast<int>(count));
    for (int k = 0; k <= i; ++k) archive(complement_[i * kMaxRows + k]);
  }
}

void ActiveSet::transfer(Archive& archive) {
  archive.sized(segments_), archive.sized(steps_);
  for (int segment : segments_) Archive::index(segment, -1, kSegments);
  updates_.transfer(archive);
}

void PrimalDualActiveSet::transfer(Archive& archive) {
  bool serves = version_ >= 0 && version_ == system_.body_factor_version();
  archive(serves);
  if (archive.reads()) version_ = -1;
  if (!serves) return;
  const std::size_t rows = static_cast<std::size_t>(system_.row_count());
  factored_pieces_.resize(rows), factored_stiffness_.resize(rows);
  factored_weighted_.resize(static_cast<std::size_t>(system_.rows().whole_size()));
  archive.sized(factored_pieces_), archive.sized(factored_stiffness_), archive.sized(factored_weighted_);
  if (!archive.reads()) return;
  StageTimes times;
  if (system_.factorize_bodies(factored_weighted_, factored_stiffness_, times))
    version_ = system_.body_factor_version();
}

void ContactIslands::transfer(Archive& archive) {
  archive(known_);
  if (!known_) {
    if (archive.reads()) islands_.clear();
    return;
  }
  if (archive.reads()) known_ = false, islands_.clear(), find();
  for (std::size_t i = 0; islands_.size() > 1 && i < islands_.size(); ++i) {
    Island& island = *islands_[i];
    bool solved = island.own != nullptr;
    archive(solved);
    if (!solved) continue;
    if (!island.own) make(island, scratch_.front());
    island.solver->transfer(archive);
    island.contacts.transfer_residuals(archive);
    island.own->reset_counters();
  }
}

void Breaking::transfer(Archive& archive) {
  archive.each(last_loads_, [&](Load& l) { archive(l.force, l.torque, l.ratio); });
  archive(has_loads_, last_h_, time_to_break_, due_time_, shortened_, overloaded_, due_, rows_, events_);
  const auto is_joint = [&](JointId joint) { Archive::index(joint.index, 0, world_.joint_count()); };
  for (const auto* joints : {&overloaded_, &due_}) std::for_each(joints->begin(), joints->end(), is_joint);
  for (int r : rows_) Archive::index(r, 0, all_rows_.row_count());
  for (const BreakEvent& event : events_) is_joint(event.joint);
}

void Sleep::transfer(Archive& archive, World& world) {
  read_bodies(world);
  std::vector<char> seen(stirs_.size());
  for (std::size_t b = 0; b < seen.size(); ++b)
    seen[b] = stirs_[b] == world.wake_count({static_cast<int>(b)});
  archive.sized(quiet_), archive.sized(seen), archive.sized(island_of_);
  archive(islands_);
  archive.sized(forces_then_);
  const int bodies = static_cast<int>(quiet_.size());
  for (const auto& island : islands_)
    for (BodyId body : island) Archive::index(body.index, 0, bodies);
  for (int island : island_of_) Archive::index(island, -1, static_cast<int>(islands_.size()));
  if (!archive.reads()) return;
  for (int b = 0; b < bodies; ++b)
    if (island_of_[b] >= 0) world.put_to_sleep({b});
  for (int b = 0; b < bodies; ++b) stirs_[b] = world.wake_count({b}) - !seen[b];
}

void EnergyAccounting::transfer(Archive& archive, const World& world) {
  bool known = end_versions_ == versions(world);
  archive(known, end_.kinetic, end_.potential, end_.springs, end_.dissipative);
  if (archive.reads()) end_versions_ = known ? versions(world) : Versions{};
}

void ForceLevel::transfer(Archive& archive) {
  archive(state_);
  Archive::require(same(state_, world_.state()), "its states disagree");
  archive.sized(impulses_);
  if (archive.reads()) find_momenta();
  system_.transfer(archive, state_);  // whether rows have been dependent lately
  system_.reset_counters();
}

void ConstraintSystem::transfer(Archive& archive, const Configuration& at) {
  bool serves = factored_;
  archive(serves, shifted_, shift_next_, full_rank_streak_, small_pivots_, counted_shift_, tolerance_.shift,
          compliance_, usable_, condition_);
  const int rows = row_count();
  archive.indices(counted_rows_, 0, rows), archive.indices(dependent_rows_, 0, rows);
  archive(states_, factored_states_);
  for (const auto* states : {&states_, &factored_states_})
    Archive::require(states->empty() || std::ssize(*states) == rows, "it has other rows");
  // Rows of contacts were turned with their tangents; those of joints follow from the poses.
  const std::size_t contacts =
      rows_.contact_count() == 0
          ? jacobian_.size()
          : static_cast<std::size_t>(rows_.sides()[rows_.joints()[rows_.contact_joint(0)].first_side].offset);
  std::vector<double> turned(jacobian_.begin() + static_cast<std::ptrdiff_t>(contacts), jacobian_.end());
  archive.sized(turned);
  if (!archive.reads()) return;

  const std::vector<double> states = states_;
  const std::vector<int> dependent = dependent_rows_;
  const bool usable = usable_;
  const double condition = condition_;
  states_ = factored_states_;
  linearize_and_assemble(at);
  if (!turned.empty()) {
    std::copy(turned.begin(), turned.end(), jacobian_.begin() + static_cast<std::ptrdiff_t>(contacts));
    assembled_ = false;
  }
  if (serves) {
    StageTimes times;
    if (!rows_.axis_rows().empty() || rows_.contact_count() > 0 || through_bodies_) weight();
    const bool shifted = shifted_;
    assemble_and_factorize(times);
    shifted_ = shifted;
  }
  states_ = states;
  dependent_rows_ = dependent;
  usable_ = usable;
  condition_ = condition;
}

void StageSolver::transfer(Archive& archive) {
  for (auto* rows : {&effective_mass_, &w_}) archive.sized(*rows);
  archive.sized(laws_);
  archive(good_guess_, rested_, primal_stages_left_, outcome_.status);
}

void StageSolver::transfer_factors(Archive& archive) {
  active_->transfer(archive);
  primal_dual_.transfer(archive);
  contact_solver_.transfer(archive);
  islands_.transfer(archive);
}

void MultiplierPrediction::transfer(Archive& archive) {
  for (auto* rows : {&mu_, &asymmetry_, &last_asymmetry_}) archive.sized(*rows);
  archive(history_, cold_start_steps_, last_h_);
}

void StepLimit::transfer(Archive& archive) { archive(omega_, step_, leaves_out_); }

void VelocityProjection::transfer(Archive& archive) { archive(contraction_, steady_count_); }

void ContactRows::transfer(Archive& archive) { archive(horizon_); }

void ImpulseScheme::transfer(Archive& archive) {
  archive(phase_.state, phase_.linearized_time);
  Archive::require(std::isfinite(phase_.linearized_time) && same(phase_.state, world_.state()),
                   "its states disagree");
  if (!contacts_.empty()) {
    contacts_.table().set.transfer(archive, world_);
    if (archive.reads()) contact_rows_.renew();
    contacts_.transfer(archive);
    if (archive.reads()) contacts_.give_points(system_);
  }
  axes_.transfer(archive);
  breaking_.transfer(archive);
  for (auto* wrenches : {&phase_.momenta, &phase_.start_momenta, &phase_.forces}) archive.sized(*wrenches);
  for (auto* rows : {&values_.lambda, &values_.mu, &values_.impulses, &values_.force_multipliers})
    archive.sized(*rows);
  prediction_.transfer(archive);
  for (auto* rows : {&values_.start_theta, &values_.rates}) archive.sized(*rows);
  projection_.transfer(archive);
  contact_rows_.transfer(archive);
  limit_.transfer(archive);
  stages_.transfer(archive);
  if (archive.reads())
    phase_.poses = phase_.state.poses, std::swap(phase_.state.time, phase_.linearized_time);
  system_.transfer(archive, phase_.state);
  stages_.transfer_factors(archive);
  if (!archive.reads()) return;
  limit_.restore_stiffness(phase_.state, values_.force_multipliers);
  std::swap(phase_.state.time, phase_.linearized_time);
  system_.reset_counters();
}

void Rattle::transfer(Archive& archive) {
  ImpulseScheme::transfer(archive);
  archive(size_, prediction_missed_);
}

}  // namespace taut
