#include <algorithm>
#include <cstdio>

#include "core/base/check.h"
#include "solvers/linear/cholmod_factor.h"
#include "solvers/simulator/simulator_impl.h"
#include "solvers/simulator/stall_diagnosis.h"

// What a simulator answers between steps: reactions, axes, contacts, and what cannot hold together.
namespace taut {

Reaction Simulator::Impl::mean_reaction(JointId joint) {
  if (!stepper_.made() || report_.dt == 0) return {};
  if (sleeping_.rests(joint)) return sleeping_.reaction(joint);
  if (welds_.is_weld(joint)) return welds_.mean(joint, stepper_, report_.dt);
  const Rows& rows = stepper_.system().rows();
  if (joint.index >= rows.joint_count()) return {};  // it is new
  return reactions_.of(joint, source_, source_rows(), rows, stepper_.impulses(), 1 / report_.dt);
}

/// At the present instant; of bodies that sleep, what they bore before.
Reaction Simulator::Impl::reaction(JointId joint) {
  if (sleeping_.rests(joint)) return mean_reaction(joint);
  welds_.solve_means_of_old_source(stepper_, report_.dt);
  bring_up_to_date(0);
  bodies_.publish();
  reactions_.solve(world_, settings_, stepper_);
  if (welds_.is_weld(joint)) return welds_.present(joint, world_, stepper_, reactions_.multipliers());
  return reactions_.of(joint, source_, source_rows(), stepper_.system().rows(), reactions_.multipliers(), 1);
}

AxisReport Simulator::Impl::axis_report(AxisId axis) const {
  if (!stepper_.made() || report_.dt == 0) return {};
  if (sleeping_.rests(axis.joint)) return sleeping_.axis(axis);
  const std::span<const Rows::AxisRow> rows = stepper_.system().rows().axis_rows();
  const auto found = std::find_if(rows.begin(), rows.end(),
                                  [&](const auto& row) { return row.axis() && *row.axis() == axis; });
  if (found == rows.end()) return {};
  AxisReport report = stepper_.scheme().axis_reports()[found - rows.begin()];
  for (const auto& [part, column, term] : kAxisParts) {
    report.force.*part /= report_.dt;
    report.power.*part = report.work.*part / report_.dt;
  }
  return report;
}

std::vector<ContactReport> Simulator::Impl::contacts() const {
  if (!stepper_.made() || report_.dt == 0) return {};
  std::vector<ContactReport> reports = stepper_.mean_contacts(report_.dt);
  for (ContactReport& report : reports) bodies_.refer_to_source(report.contact);
  sleeping_.append_contacts(reports);
  return reports;
}

std::vector<ContactStretch> Simulator::Impl::contact_stretches() const {
  if (!recalled_.empty()) return recalled_;
  if (!stepper_.made() || !stepper_.is_started()) return {};
  std::vector<ContactStretch> stretches = stepper_.scheme().contacts().stretches();
  bodies_.refer_to_source(stretches);
  return stretches;
}

void Simulator::Impl::set_contact_stretches(std::vector<ContactStretch> stretches) {
  for (const ContactStretch& s : stretches) {
    (void)source_.shape(s.a), (void)source_.shape(s.b);  // throws for an id that is not there
    require_all_finite("contact stretch", s.stretch);
    require_all_finite("contact stretch: p_AP", s.p_AP);
  }
  bodies_.wake_all();
  recalled_ = std::move(stretches);
}

Contradiction Simulator::Impl::contradiction(double horizon) {
  welds_.solve_means_of_old_source(stepper_, report_.dt);
  bodies_.follow();
  return contradiction_from(inquiry(), world_.state(), horizon);
}

std::string Simulator::Impl::solver_description() {
  if (!stepper_.made()) {
    bring_up_to_date(0);
    undo_.restore_state();  // joints that it has closed are for a step to close
  }
  if (settings_.solver != Solver::kDirect)
    return "iterative impulses, " + std::to_string(settings_.iterations) + " sweeps a stage";
  const Factor& factor = stepper_.system().factor();
  char flops[32];
  std::snprintf(flops, sizeof flops, "%.3g", factor.flops());
  return factor.name() + ", " + std::string(factor.ordering()) + " (" + flops + " flops), " + blas_name() +
         (CholmodFactor::has_supernodal() ? "" : ", CHOLMOD without its GPL modules");
}

Reaction Simulator::mean_reaction(JointId joint) const {
  (void)impl().source_.joint(joint);  // throws for an id that is not there
  return impl().mean_reaction(joint);
}

Reaction Simulator::reaction(JointId joint) {
  (void)impl().source_.joint(joint);
  return impl().reaction(joint);
}

AxisReport Simulator::axis_report(AxisId axis) const {
  (void)impl().source_.axis_index(axis);  // throws for an id that is not there
  return impl().axis_report(axis);
}

std::vector<ContactReport> Simulator::contacts() const { return impl().contacts(); }

std::vector<ContactStretch> Simulator::contact_stretches() const { return impl().contact_stretches(); }

void Simulator::set_contact_stretches(std::vector<ContactStretch> stretches) {
  impl().set_contact_stretches(std::move(stretches));
}

Contradiction Simulator::contradiction(double horizon) {
  require_not_negative("contradiction horizon", horizon);
  return impl().contradiction(horizon);
}

std::vector<JointId> Simulator::merged_joints() const {
  std::vector<JointId> joints;
  if (!impl().bodies_.merged()) return joints;
  // Those that the next step will have, which is not taken in advance.
  for (const MergedGroup& group : merged_groups(impl().source_, impl().settings_.position_tolerance))
    for (const auto* welds : {&group.welds, &group.loops})
      for (JointId weld : *welds)
        if (weld.index >= 0) joints.push_back(weld);
  std::sort(joints.begin(), joints.end());
  return joints;
}

std::string Simulator::solver_description() const { return impl().solver_description(); }

}  // namespace taut
