#include "solvers/simulator/checkpoint_memory.h"

#include <cmath>
#include <numeric>

#include "core/state/same_state.h"
#include "solvers/integrators/force_level.h"
#include "solvers/integrators/rattle.h"
#include "solvers/integrators/reduced/reduced_coordinates.h"
#include "solvers/simulator/energy_accounting.h"
#include "solvers/simulator/sleep.h"
#include "solvers/simulator/sleeping_loads.h"
#include "solvers/simulator/step_division.h"
#include "solvers/simulator/stepper.h"
#include "solvers/simulator/weld_reactions.h"

// What each part of a simulation remembers from one step to the next, as Archive writes and reads it.
// Whatever a step makes anew before it reads it is left out, and so are factors, which have the same bits
// when they are made again. (solvers/simulator, "Checkpoints")
namespace taut {

void transfer_fields(Archive& archive, ShapeId& id) { archive(id.index); }
void transfer_fields(Archive& archive, Material& m) {
  archive(m.restitution, m.static_friction, m.dynamic_friction, m.rolling_friction, m.spinning_friction,
          m.compliance, m.rolling_friction_linear, m.spinning_friction_linear);
}
void transfer_fields(Archive& archive, LocalSurface& s) { archive(s.ball, s.radii, s.squares); }
void transfer_fields(Archive& archive, Contact& c) {
  archive(c.a, c.b, c.A, c.B, c.p_AP, c.p_BQ, c.normal, c.gap, c.feature, c.surface_A, c.surface_B);
}
void transfer_fields(Archive& archive, ContactReport& r) {
  archive(r.contact, r.force, r.torque, r.normal_force, r.sliding, r.impact_time);
}
void transfer_fields(Archive& archive, ContactWork& w) { archive(w.normal, w.friction); }
void transfer_fields(Archive& archive, AxisImpulse& i) {
  for (const auto& [part, column, term] : kAxisParts) archive(i.*part);
}
void transfer_fields(Archive& archive, AxisReport& r) {
  archive(r.force, r.work, r.power, r.stuck, r.saturated, r.at_limit, r.impact_time);
}
void transfer_fields(Archive& archive, Reaction& r) { archive(r.force, r.torque); }
void transfer_fields(Archive& archive, BreakEvent& e) {
  archive(e.joint, e.time, e.force, e.torque, e.energy, e.with);
}
void transfer_fields(Archive& archive, Rows::ContactSlot& p) { archive(p.a, p.b, p.twist); }
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

void require_bodies(const World& world, int a, int b) {
  for (int body : {a, b}) Archive::index(body, 0, world.body_count());
}

bool has_shapes(const Contact& contact) { return contact.a.index >= 0 && contact.b.index >= 0; }

void require_contact(const World& world, const Contact& contact) {
  require_bodies(world, contact.A.index, contact.B.index);
  require_shape(world, contact.a), require_shape(world, contact.b);
}

}  // namespace

void AxisTable::transfer(Archive& archive) { archive.sized(released_); }

void AxisImpacts::transfer(Archive& archive) {
  const std::size_t count = impacts_.size();
  archive.each(impacts_, [&](AxisImpact& i) { i.transfer(archive), archive(i.at_lower, i.rate); });
  Archive::require(impacts_.size() == count, "it has other axes");
}

void AxisImpacts::transfer_count(Archive& archive) { archive(struck_, count_); }

void AxisWork::transfer(Archive& archive) {
  const std::size_t count = reports_.size();
  archive(reports_);
  Archive::require(reports_.size() == count, "it has other axes");
}

void AxisForces::transfer(Archive& archive) {
  const std::size_t count = axes_.size();
  archive(axes_);
  Archive::require(axes_.size() == count, "it has other axes");
  impacts_.transfer(archive);
  work_.transfer(archive);
  impacts_.transfer_count(archive);
  table_.transfer(archive);
  std::vector<std::pair<AxisId, int>> resting;  // and their memory, behind
  std::vector<AxisLaw> memory;
  for (const auto& [id, known] : resting_) resting.emplace_back(id, 0), memory.push_back(known);
  archive(resting);
  archive(memory);
  Archive::require(memory.size() == resting.size());
  resting_.clear();
  for (std::size_t i = 0; i < memory.size(); ++i) {
    (void)table_.world().axis_index(resting[i].first);  // throws for one that is not there
    resting_.emplace(resting[i].first, memory[i]);
  }
  before_ = axes_;
}

void ContactCache::transfer(Archive& archive, const World& world) {
  const auto slot = [&](Slot& p) {
    archive(p.at, p.active, p.unused, p.contact, p.material, p.parted, p.point);
    require_bodies(world, p.at.a, p.at.b);
    if (p.active || has_shapes(p.contact))
      require_contact(world, p.contact);
    else  // never used
      require_bodies(world, p.contact.A.index, p.contact.B.index);
  };
  archive.each(slots_, slot);
  archive.each(resting_, slot);
  archive(parts_);
  std::vector<Contact> contacts = finder_.contacts();
  archive(contacts);
  for (const Contact& contact : contacts) require_contact(world, contact);
  if (!archive.reads()) return;
  finder_.recall(std::move(contacts));
  before_ = slots_;
  origin_.resize(slots_.size());
  std::iota(origin_.begin(), origin_.end(), 0);
  moved_ = origin_;
  sort_pairs();
}

void FrictionLinearization::transfer(Archive& archive) { archive(residual_, scale_); }

void ContactLaws::transfer_residuals(Archive& archive) { friction_.transfer(archive); }

void ContactImpacts::transfer(Archive& archive) { archive(count_); }

void ContactWorks::transfer(Archive& archive) { archive(sum_); }

void ContactForces::transfer(Archive& archive, const World& world) {
  const auto disc = [&](Disc& d) {
    archive(d.bound, d.slips, d.direction, d.cross_slope, d.given, d.target);
  };
  const auto point = [&](Point& p) {
    archive(p.soft.target, p.soft.softness, p.soft.most, p.soft_slip.target, p.soft_slip.softness, p.active,
            p.live, p.touching, p.pressed, p.gap, p.approach, p.least_rate, p.fresh, p.back, p.stuck,
            p.slipping, p.stick_candidate, p.slipped, p.first, p.first_torque, p.first_normal, p.spin_bound,
            p.spin_given, p.borne, p.impulse, p.torque, p.impact_time, p.slid);
    disc(p.sliding), disc(p.rolling);
  };
  archive.each(table_.points, point);
  archive(table_.impacts);
  archive.each(resting_points_, point);
  archive(departed_, struck_);
  works_.transfer(archive);
  for (const ContactReport& report : departed_) require_contact(world, report.contact);
  impacts_.transfer(archive);
  archive(table_.h, table_.still_rate, table_.in_velocities, table_.single_kick);
  Archive::require(table_.points.size() == table_.cache.slots().size() &&
                       table_.impacts.size() == table_.points.size() &&
                       resting_points_.size() == table_.cache.resting().size(),
                   "it has other contacts");
  for (std::size_t k = 0; k < table_.points.size(); ++k)
    Archive::require(!table_.points[k].active || has_shapes(table_.cache.slots()[k].contact));
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
  factored_segments_.resize(rows), factored_stiffness_.resize(rows);
  factored_weighted_.resize(static_cast<std::size_t>(system_.rows().whole_size()));
  archive.sized(factored_segments_), archive.sized(factored_stiffness_), archive.sized(factored_weighted_);
  if (!archive.reads()) return;
  StageTimes times;
  if (system_.factorize_bodies(factored_weighted_, factored_stiffness_, times))
    version_ = system_.body_factor_version();
}

void ContactIslands::transfer(Archive& archive) {
  archive(known_);
  if (archive.reads()) restore();
  if (known().size() <= 1) return;
  for (const std::unique_ptr<Island>& of_present_rows : known()) {
    Island& island = *of_present_rows;
    bool solved = island.system != nullptr;
    archive(solved);
    if (!solved) continue;
    if (!island.system) make(island, scratch_.front());
    island.solver->transfer(archive);
    island.contacts.transfer_residuals(archive);
    island.system->reset_counters();
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
  if (!enabled()) return;
  read_bodies(world);
  std::vector<char> seen(wake_counts_.size());
  std::vector<char> asleep(wake_counts_.size());  // those of an island may have been woken since
  for (int b = 0; b < std::ssize(seen); ++b) {
    seen[b] = wake_counts_[b] == world.wake_count({b});
    asleep[b] = world.is_asleep({b});
  }
  archive.sized(quiet_), archive.sized(seen), archive.sized(asleep), archive.sized(island_of_);
  archive(islands_);
  archive.sized(forces_then_);
  const int bodies = static_cast<int>(quiet_.size());
  for (const auto& island : islands_)
    for (BodyId body : island) Archive::index(body.index, 0, bodies);
  for (int island : island_of_) Archive::index(island, -1, static_cast<int>(islands_.size()));
  if (!archive.reads()) return;
  for (int b = 0; b < bodies; ++b)
    if (asleep[b]) world.put_to_sleep({b});
  for (int b = 0; b < bodies; ++b) wake_counts_[b] = world.wake_count({b}) - !seen[b];
}

void SleepingLoads::transfer(Archive& archive) {
  archive(reactions_, axes_, contacts_);
  for (const ContactReport& report : contacts_) require_contact(source_, report.contact);
}

void WeldReactions::transfer(Archive& archive) {
  if (loads_) archive(start_);
}

void StepDivision::transfer(Archive& archive, double most) {
  archive(substeps_, most_substeps_, quiet_, reduced_budget_steps_);
  const auto is_count = [&](double n) { return n >= 1 && n <= most; };
  Archive::require(is_count(substeps_) && is_count(most_substeps_) && quiet_ >= 0);
}

void Stepper::transfer(Archive& archive) { scheme_->transfer(archive); }

void EnergyAccounting::transfer(Archive& archive, const World& world) {
  bool known = end_versions_ == versions(world);
  archive(known, end_.kinetic, end_.potential, end_.springs, end_.dissipative);
  if (archive.reads()) end_versions_ = known ? versions(world) : Versions{};
}

void ForceLevel::transfer(Archive& archive) {
  archive(state_);
  Archive::require(same(state_, world_.state()), "its states disagree");
  archive.sized(impulses_);
  system_.transfer(archive, state_);  // whether rows have been dependent lately
  system_.reset_counters();
}

void AxisModes::transfer(Archive& archive) {
  archive.sized(axes_);
  list_held();
}

void ClosedTree::transfer(Archive& archive) {
  archive(deficit_.rows);
  Archive::index(deficit_.rows, -1, static_cast<int>(beyond_.size()) + 1);
}

void ReducedCoordinates::transfer(Archive& archive) {
  archive(state_);
  Archive::require(same(state_, world_.state()), "its states disagree");
  archive.sized(impulses_);
  archive.sized(flow_.reports());
  modes_.transfer(archive);
  tree_.hold(modes_.held());
  tree_.transfer(archive);
  archive(omega_);
  system_.transfer(archive, state_);
  system_.reset_counters();
}

void RankEstimate::transfer_shift(Archive& archive) {
  archive(shift_next_, full_rank_streak_, small_pivots_, counted_shift_, tolerance_.shift);
}

void RankEstimate::transfer_findings(Archive& archive, int rows) {
  archive(condition_);
  archive.indices(counted_rows_, 0, rows), archive.indices(dependent_rows_, 0, rows);
}

void RowStates::transfer(Archive& archive, int rows) {
  archive(states_);
  Archive::require(all_free() || std::ssize(states_) == rows, "it has other rows");
}

void ConstraintSystem::transfer(Archive& archive, const Configuration& at) {
  bool serves = factored();
  archive(serves, factored_.shifted);
  rank_.transfer_shift(archive);
  archive(compliance_, factored_.usable);
  rank_.transfer_findings(archive, row_count());
  for (RowStates* states : {&states_, &factored_.states}) states->transfer(archive, row_count());
  if (!archive.reads()) return;

  const RowStates states = states_;
  const RankEstimate rank = rank_;
  const Factored factored = factored_;
  states_ = factored_.states;
  linearize_and_assemble(at);
  if (serves) {
    StageTimes times;
    factorize_once(times);
  }
  states_ = states;
  rank_ = rank;
  factored_.usable = factored.usable;
  factored_.shifted = factored.shifted;
}

void StageWarmStart::transfer(Archive& archive) { archive(rested_); }

void StagePivoting::transfer(Archive& archive) { archive(outcome_.status); }

void StageSolver::transfer(Archive& archive) {
  for (auto* rows : {&effective_mass_, &w_}) archive.sized(*rows);
  archive.sized(laws_);
  warm_start_.transfer(archive);
  pivoting_.transfer(archive);
}

void StageSolver::transfer_factors(Archive& archive) {
  pivoting_.active_set().transfer(archive);
  primal_.transfer(archive);
  contact_solver_.transfer(archive);
  islands_.transfer(archive);
}

void MultiplierPrediction::transfer(Archive& archive) {
  for (auto* rows : {&mu_, &asymmetry_, &last_asymmetry_}) archive.sized(*rows);
  archive(history_, cold_start_steps_, last_h_);
}

void StepLimit::transfer(Archive& archive) { archive(omega_, step_, leaves_out_); }

void VelocityProjection::transfer(Archive& archive) { archive(contraction_, steady_count_); }

void ContactPattern::transfer(Archive& archive) { archive(horizon_); }

void ImpulseScheme::transfer(Archive& archive) {
  archive(phase_.state, phase_.linearized_time);
  Archive::require(std::isfinite(phase_.linearized_time) && same(phase_.state, world_.state()),
                   "its states disagree");
  if (!contacts_.empty()) {
    contacts_.table().cache.transfer(archive, world_);
    if (archive.reads()) contact_pattern_.renew();
    contacts_.transfer(archive, world_);
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
  contact_pattern_.transfer(archive);
  limit_.transfer(archive);
  stages_.transfer(archive);
  if (archive.reads())
    phase_.trial_poses = phase_.start_poses = phase_.state.poses,
    std::swap(phase_.state.time, phase_.linearized_time);
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
