#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/diagnostics.h"
#include "core/reach.h"
#include "solvers/assembly.h"
#include "solvers/contradiction.h"
#include "solvers/simulator_impl.h"

// Why a step failed.  (solvers/README, "Contradiction")
namespace taut {
namespace {

/// Steps ahead at which a contradiction is looked for if there is none at the end of this one: where rates
/// grow without bounds the step fails shortly before.
constexpr double kStepsAhead[] = {1, 4};
/// Part of the tolerance that stuck joints must be open by: the step fails as soon as all of them are open by
/// the whole of it, to a hair.
constexpr double kStuckPart = 0.5;
/// What an active set without a solution leaves at least, relative, where laws contradict each other.
constexpr double kRoundOffResidual = 1e-6;
/// An angle that changes by so much more than its bodies turn is next to where it has no value.
constexpr double kSingular = 50;

}  // namespace

Contradiction Simulator::Impl::contradiction_from(const State& state, double horizon) const {
  std::vector<JointId> gone;
  if (rattle_)
    for (int row : rattle_->breaking().rows())
      if (const auto joint = system_->rows().joint_of(row); joint && (gone.empty() || gone.back() != *joint))
        gone.push_back(*joint);
  return find_contradiction({.world = world_,
                             .from = state,
                             .horizon = horizon,
                             .contact_margin = settings_.contacts ? settings_.contact_margin : 0,
                             .gone = gone,
                             .named = &source_});
}

Contradiction Simulator::Impl::contradiction(double horizon) {
  keep_means();
  follow_source();
  return contradiction_from(world_.state(), horizon);
}

/// The first joint with a row whose S_rr overflows; none: index −1.
JointId Simulator::Impl::overflowing_joint(const State& state) {
  system_->linearize({state.poses, state.time, state.axes});
  system_->set_mass(state.poses);
  const std::span<const double> W = system_->weighted();
  const Rows& rows = system_->rows();
  for (const Rows::Side& side : rows.sides()) {
    const auto* joint = std::get_if<JointId>(&rows.joints()[side.block].owner);
    for (int i = 0; joint && i < side.row_count; ++i)
      if (std::isinf(
              Eigen::Map<const Eigen::Matrix<double, 6, 1>>(W.data() + side.whole + 6 * i).squaredNorm()))
        return *joint;
  }
  return {};
}

/// Names the motor or the joint that follows what is not finite, the latter if that shows at the start of the
/// step or at its end, or the joint whose row of S is not.
void Simulator::Impl::fail_not_finite() {
  if (rattle_ && !rattle_->axes().finite()) {
    Contradiction motor;
    motor.bounds.push_back({rattle_->axes().not_finite(), Contradiction::Bound::Kind::kMotor});
    return set_failure(Status::kNotFinite,
                       "what the " + names_of(motor, source_).front() + " follows is not finite");
  }
  const State& start = world_.state();
  const Rows& rows = system_->rows();
  std::vector<double> gap(rows.row_count()), rate(rows.row_count());
  for (const double time : {start.time, start.time + report_.dt}) {
    const Configuration at(start.poses, time, start.axes);
    rows.residual(at, gap);
    std::fill(rate.begin(), rate.end(), 0.0);
    rows.add_rate(at, rate);
    for (int r = 0; r < rows.row_count(); ++r) {
      const std::optional<JointId> joint = rows.joint_of(r);
      if (std::isfinite(gap[r] + rate[r]) || !joint) continue;
      return set_failure(Status::kNotFinite, "what " + std::string(source_.joint(*joint).type()) + " " +
                                                 source_.name(*joint) + " follows is not finite");
    }
  }
  if (const JointId joint = overflowing_joint(start); joint.index >= 0)
    return set_failure(Status::kNotFinite, "J M⁻¹ Jᵀ of " + std::string(source_.joint(joint).type()) + " " +
                                               source_.name(joint) +
                                               " is not finite: its factors are too large for its bodies");
  if (rattle_)
    for (int b = 0; b < world_.body_count(); ++b)
      if (const State& end = rattle_->state(); !within_reach(end.poses[b], end.twists[b]))
        return set_failure(Status::kNotFinite,
                           "body " + world_.name(BodyId{b}) + " comes beyond 1e30 m, m/s or rad/s");
  set_failure(Status::kNotFinite, "a force or the state is not finite");
}

/// ": ball elbow stays open by 1e-09 m", of the joint that does most; "" if none does.
std::string Simulator::Impl::widest_gap(const State& state) {
  phi_.resize(system_->row_count());
  system_->rows().residual(state, phi_);
  std::vector<Gap> gaps = joint_gaps(system_->rows(), phi_);
  gaps.resize(system_->rows().joint_count());  // springs and contacts have none
  const auto size = [](const Gap& gap) { return std::max(gap.metres, gap.radians); };
  const auto widest = std::max_element(gaps.begin(), gaps.end(),
                                       [&](const Gap& a, const Gap& b) { return size(a) < size(b); });
  if (widest == gaps.end() || !(size(*widest) > 0)) return "";
  const JointId joint{static_cast<int>(widest - gaps.begin())};
  std::ostringstream text;
  text << ": " << source_.joint(joint).type() << " " << source_.name(joint) << " stays open by "
       << size(*widest) << (widest->metres >= widest->radians ? " m" : " rad");
  return text.str();
}

/// "; ball hip twist is next to where it has no value", as at a swing of π; "" if no axis is.
std::string Simulator::Impl::singular_axis() const {
  const Rows& rows = system_->rows();
  for (const Rows::AxisRow& axis : rows.axis_rows()) {
    if (axis.axis.axis < 0 || !rows.row(axis.row).angular) continue;
    const Rows::JointRows& joint = rows.joints()[rows.row(axis.row).block];
    for (int s = joint.first_side; s < joint.first_side + joint.side_count; ++s) {
      const auto block = Rows::block_row(rows.sides()[s], system_->jacobian(), axis.row - joint.first_row);
      if (!(block.head<3>().norm() > kSingular)) continue;
      return "; " + std::string(source_.joint(axis.axis.joint).type()) + " " + source_.axis_label(axis.axis) +
             " is next to where it has no value";
    }
  }
  return "";
}

void Simulator::Impl::diagnose_stall(double remaining) {
  const std::span<const double> phi = rattle_->residual();
  if (!rattle_->axes().finite() ||
      std::any_of(phi.begin(), phi.end(), [](double p) { return !std::isfinite(p); }))
    return fail_not_finite();
  Contradiction& found = report_.contradiction;
  found = contradiction_from(rattle_->state(), remaining);
  for (double steps : kStepsAhead)
    if (found.empty()) found = contradiction_from(rattle_->state(), steps * report_.dt);
  if (found.empty() && !rattle_->jammed().empty()) {
    name_jam();
    return set_failure(Status::kContradiction, "friction grows with a load that it makes grow: they jam");
  }
  const ActiveSetOutcome& outcome = rattle_->active_set_outcome();
  if (outcome.ok() && found.empty())
    found = find_stuck_joints(world_, *system_, rattle_->trial_poses(), report_);
  if (found.residual <= kStuckPart * settings_.position_tolerance && found.bounds.empty() && outcome.ok())
    found = {};
  Status status = found.empty() ? Status::kNotConverged : Status::kContradiction;
  if (outcome.ok()) {
    std::ostringstream message;
    message << "positions could not be closed with sub-steps down to dt/" << settings_.max_substeps;
    if (found.empty()) message << singular_axis();
    return set_failure(status, message.str());
  }
  // The row that misses its law most is where it shows.
  if (found.empty() && outcome.status == ActiveSetStatus::kContradiction &&
      outcome.residual > kRoundOffResidual) {
    status = Status::kContradiction;
    found.residual = outcome.residual;
    if (outcome.worst_row >= 0)
      if (const auto joint = system_->rows().joint_of(outcome.worst_row)) found.joints.push_back(*joint);
  }
  set_failure(status, "limits, motors, friction and contacts could not be met together with the joints" +
                          (found.empty() ? singular_axis() : ""));
}

/// Joints whose friction locks them and those that force them, with motors as bounds.
void Simulator::Impl::name_jam() {
  Contradiction& found = report_.contradiction;
  const Rows& rows = system_->rows();
  const std::span<const Rows::AxisRow> axes = rows.axis_rows();
  for (int r : rattle_->jammed()) {
    const auto axis = std::find_if(axes.begin(), axes.end(), [r](const auto& a) { return a.row == r; });
    if (axis != axes.end() && rattle_->axes().has_unbounded_motor(axis - axes.begin()))
      found.bounds.push_back({axis->axis, Contradiction::Bound::Kind::kMotor});
    const bool rubs =
        axis != axes.end() && axis->axis.axis >= 0 && world_.axis_properties(axis->axis).friction;
    if (const auto joint = rows.joint_of(r); joint && (axis == axes.end() || rubs))
      found.joints.push_back(*joint);
  }
  std::sort(found.joints.begin(), found.joints.end());
  found.joints.erase(std::unique(found.joints.begin(), found.joints.end()), found.joints.end());
}

void Simulator::Impl::set_failure(Status status, std::string message) {
  report_.status = status;
  if (status == Status::kContradiction) {
    const Contradiction& found = report_.contradiction;
    const std::vector<std::string> names = names_of(found, source_);
    std::ostringstream text;
    text << message << (found.joints.size() == names.size() ? "; these joints" : "; these")
         << " cannot hold together";
    if (found.residual > 0) text << " (" << found.residual << " is left)";
    text << ": " << list_of(names);
    message = text.str();
  }
  report_.message = std::move(message);
}

}  // namespace taut
