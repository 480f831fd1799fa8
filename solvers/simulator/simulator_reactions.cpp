#include <algorithm>

#include "core/base/check.h"
#include "solvers/simulator/simulator_impl.h"

// What joints bear, and what merged bodies return to the user's world.  (solvers/simulator, "Merged bodies")
namespace taut {

/// λ of the acceleration equation in the present state, with a system of its own so that the integrator keeps
/// its factor.
void Simulator::Impl::compute_reactions() {
  flush_mean_reactions();
  sync_from_world();
  if (sleep_) wake_islands(0);
  restart_if_needed();
  publish_to_world();
  if (reaction_version_ == world_.state_version()) return;
  if (scheme_ && (!scheme_->axes().only_springs() || !scheme_->contacts().empty())) {
    const std::span<const double> multipliers = scheme_->values().force_multipliers;
    reaction_multipliers_.assign(multipliers.begin(), multipliers.end());
    reaction_version_ = world_.state_version();
    return;
  }
  const State& state = world_.state();
  StageTimes times;
  ConstraintSystem system(world_, settings_.factor);
  system.linearize(state);
  system.set_mass(state.poses);
  system.factorize(times);
  std::vector<Wrench> forces(world_.body_count());
  std::vector<Twist> accelerations(world_.body_count());
  world_.forces(state, forces);
  free_accelerations(system.mass(), state, forces, accelerations);
  std::vector<double> rates(system.row_count());
  reaction_multipliers_.resize(system.row_count());
  system.rows().bias(state, state.twists, reaction_multipliers_);
  system.rows().apply(system.jacobian(), accelerations, rates);
  for (int r = 0; r < system.row_count(); ++r)
    reaction_multipliers_[r] = -(reaction_multipliers_[r] + rates[r]);
  // The least-norm solution, refined once where rows depend on each other.
  std::vector<double> rhs = reaction_multipliers_, correction(rhs.size());
  system.solve(reaction_multipliers_);
  for (int pass = 0; pass < (system.singular() ? 3 : 1); ++pass) {
    system.multiply(reaction_multipliers_, correction);
    for (std::size_t r = 0; r < rhs.size(); ++r) correction[r] = rhs[r] - correction[r];
    system.solve(correction);
    for (std::size_t r = 0; r < rhs.size(); ++r) reaction_multipliers_[r] += correction[r];
  }
  add_spring_forces();
  reaction_version_ = world_.state_version();
}

/// Springs that have rows, behind those of the joints, give what their laws say.
void Simulator::Impl::add_spring_forces() {
  reaction_multipliers_.resize(system_->row_count(), 0.0);
  if (!scheme_ || scheme_->axes().empty()) return;
  const Rows& rows = system_->rows();
  std::vector<double> theta(rows.row_count()), rates(rows.row_count()), jacobian(rows.jacobian_size());
  rows.residual(world_.state(), theta);
  rows.jacobian(world_.state(), jacobian);
  rows.apply(jacobian, world_.state().twists, rates);
  scheme_->axes().spring_forces(theta, rates, reaction_multipliers_);
}

Reaction Simulator::Impl::reaction_from(JointId joint, std::span<const double> multipliers,
                                        double scale) const {
  const Joint& j = source_.joint(joint);
  const Rows::JointRows& rows = system_->rows().joints()[joint.index];
  if (rows.row_count == 0) return {};
  const Rows& own_rows = source_rows();
  const Rows::Side& side = own_rows.sides()[own_rows.joints()[joint.index].first_side + 1];
  if (wrench_jacobian_version_ != source_.state_version()) {
    wrench_jacobian_.resize(own_rows.jacobian_size());
    own_rows.jacobian(source_.state(), wrench_jacobian_);
    wrench_jacobian_version_ = source_.state_version();
  }
  Eigen::Matrix<double, 6, 1> wrench = Eigen::Matrix<double, 6, 1>::Zero();
  for (int i = 0; i < rows.row_count; ++i)
    wrench += scale * multipliers[rows.first_row + i] * Rows::block_row(side, wrench_jacobian_, i);
  Reaction reaction;
  reaction.force = wrench.tail<3>();
  reaction.torque = wrench.head<3>() - (source_.pose(j.b()).q * j.reaction_point_B()).cross(reaction.force);
  return reaction;
}

Reaction Simulator::Impl::mean_reaction(JointId joint) {
  if (!system_ || report_.dt == 0) return {};
  if (rests(joint)) {
    const auto then = asleep_.reactions.find(joint);
    return then == asleep_.reactions.end() ? Reaction{} : then->second;
  }
  if (merges(joint)) {
    if (start_.poses.empty()) return {};
    solve_weld_means();
    if (joint.index >= std::ssize(mean_reactions_)) return {};  // it has become one since
    return mean_reactions_[joint.index];
  }
  if (joint.index >= system_->rows().joint_count()) return {};  // it is new
  const std::span<const double> impulses =
      force_level_ ? std::span<const double>(force_level_->impulses()) : scheme_->impulses();
  return reaction_from(joint, impulses, 1 / report_.dt);
}

AxisReport Simulator::Impl::axis_report(AxisId axis) const {
  if (!scheme_ || report_.dt == 0) return {};
  if (rests(axis.joint)) {
    const auto then = asleep_.axes.find(axis);
    return then == asleep_.axes.end() ? AxisReport{} : then->second;
  }
  const std::span<const Rows::AxisRow> rows = system_->rows().axis_rows();
  const auto found =
      std::find_if(rows.begin(), rows.end(), [&](const auto& row) { return row.axis == axis; });
  if (found == rows.end()) return {};
  AxisReport report = scheme_->axes().reports()[found - rows.begin()];
  for (auto part : {&AxisImpulse::motor, &AxisImpulse::friction, &AxisImpulse::limit, &AxisImpulse::spring,
                    &AxisImpulse::damping, &AxisImpulse::elastic_limit}) {
    report.force.*part /= report_.dt;
    report.power.*part = report.work.*part / report_.dt;
  }
  return report;
}

std::vector<ContactReport> Simulator::Impl::contacts() const {
  if (!scheme_ || report_.dt == 0) return {};
  std::vector<ContactReport> reports = mean_contacts();
  for (ContactReport& report : reports) refer_to_source(report.contact);
  for (const ContactReport& report : asleep_.contacts)
    if (rests(report)) reports.push_back(report);
  return reports;
}

std::vector<ContactStretch> Simulator::Impl::contact_stretches() const {
  if (!recalled_.empty()) return recalled_;
  if (!scheme_ || state_version_ < 0) return {};
  std::vector<ContactStretch> stretches = scheme_->contacts().stretches();
  if (!merged_) return stretches;
  for (ContactStretch& s : stretches)
    if (const BodyId body = source_.shape(s.a).body; merged_->is_carried(body))
      s.p_AP = merged_->carriers().frames[body.index].local(s.p_AP);
  return stretches;
}

void Simulator::Impl::set_contact_stretches(std::vector<ContactStretch> stretches) {
  for (const ContactStretch& s : stretches) {
    (void)source_.shape(s.a), (void)source_.shape(s.b);  // throws for an id that is not there
    require_all_finite("contact stretch", s.stretch);
    require_all_finite("contact stretch: p_AP", s.p_AP);
  }
  source_.wake_all(), world_.wake_all();
  recalled_ = std::move(stretches);
}

/// To the integrator, which is about to start.
void Simulator::Impl::recall_contacts() {
  if (merged_)
    for (ContactStretch& s : recalled_)
      if (const BodyId body = source_.shape(s.a).body; merged_->is_carried(body))
        s.p_AP = merged_->carriers().frames[body.index].point(s.p_AP);
  scheme_->contact_rows().recall(std::move(recalled_));
  recalled_.clear();
}

/// The source gets what the merged world has come to.
void Simulator::Impl::publish_to_world() {
  if (!merged_) return;
  if (given_version_ == world_.state_version()) return;
  merged_->give_sleep(source_);
  merged_->expand(world_.state(), given_);
  source_.set_state(given_);
  merged_->note_state(source_);
  given_version_ = world_.state_version();
}

/// Mean reactions of the last step are those of the bodies as they then were: solved at the latest when the
/// source has changed and is about to be followed.
void Simulator::Impl::flush_mean_reactions() {
  if (weld_loads_ && !start_.poses.empty() && merged_->is_behind(source_)) solve_weld_means();
}

/// By joint, of what weld_loads_ has solved last.
std::vector<Reaction> Simulator::Impl::weld_reactions() const {
  std::vector<Reaction> reactions(source_.joint_count());
  for (int j = 0; j < source_.joint_count(); ++j) {
    if (!merges(JointId{j})) continue;
    const Joint& weld = source_.joint(JointId{j});
    const Wrench& on_B = weld_loads_->on_B(JointId{j});
    const Vec3 arm = weld_loads_->state().poses[weld.b().index].q * weld.reaction_point_B();
    reactions[j] = {on_B.force, on_B.torque - arm.cross(on_B.force)};
  }
  return reactions;
}

void Simulator::Impl::solve_weld_means() {
  if (!mean_reactions_.empty()) return;
  const double scale = 1 / report_.dt;
  if (force_level_)
    weld_loads_->solve_mean(start_, report_.dt, {system_->rows(), force_level_->impulses(), scale}, {});
  else
    weld_loads_->solve_mean(start_, report_.dt, {system_->rows(), scheme_->impulses(), scale},
                            mean_contacts());
  mean_reactions_ = weld_reactions();
}

/// Contacts of the last step with mean forces, on the bodies of world_.
std::vector<ContactReport> Simulator::Impl::mean_contacts() const {
  std::vector<ContactReport> reports = scheme_->contacts().reports();
  for (ContactReport& report : reports) {
    report.force /= report_.dt;
    report.torque /= report_.dt;
    report.normal_force /= report_.dt;
  }
  return reports;
}

/// In the present state, with the multipliers that compute_reactions() has left.
void Simulator::Impl::solve_present_welds() {
  if (present_version_ == world_.state_version() && !present_reactions_.empty()) return;
  const State& state = world_.state();
  const Rows& rows = system_->rows();
  std::vector<double> jacobian(rows.jacobian_size());
  std::vector<Wrench> forces(world_.body_count()), of_joints(world_.body_count());
  std::vector<Twist> accelerations(world_.body_count());
  rows.jacobian(state, jacobian);
  rows.apply_transpose(jacobian, reaction_multipliers_, of_joints);
  world_.forces(state, forces, laws_springs_);
  for (int b = 0; b < world_.body_count(); ++b) forces[b] = forces[b] + of_joints[b];
  free_accelerations(system_->mass(), state, forces, accelerations);
  weld_loads_->solve_present(
      accelerations, {rows, reaction_multipliers_},
      scheme_ ? scheme_->contacts().set().places() : std::span<const ContactSet::Place>{});
  present_reactions_ = weld_reactions();
  present_version_ = world_.state_version();
}

/// A contact between carriers as one between the bodies that have the shapes.
void Simulator::Impl::refer_to_source(Contact& contact) const {
  if (!merged_) return;
  const auto refer = [&](BodyId& body, Vec3& point, ShapeId shape) {
    body = source_.shape(shape).body;
    if (merged_->is_carried(body)) point = merged_->carriers().frames[body.index].local(point);
  };
  refer(contact.A, contact.p_AP, contact.a);
  refer(contact.B, contact.p_BQ, contact.b);
}

}  // namespace taut
