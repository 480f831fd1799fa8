#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "core/state/reach.h"
#include "core/world/diagnostics.h"
#include "solvers/common/report_names.h"
#include "solvers/diagnosis/contradiction.h"
#include "solvers/integrators/close_joints.h"
#include "solvers/simulator/simulator_impl.h"

// Why a step failed.  (solvers/diagnosis, "A step that failed")
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
/// Rates that miss their tolerance by less than this part of what acts do so by round-off.
constexpr double kRoundOffShare = 1e-9;
/// Masses that differ by more are worth a word.
constexpr double kManyTimes = 1e4;

}  // namespace

Contradiction Simulator::Impl::contradiction_from(const State& state, double horizon) const {
  std::vector<JointId> gone;
  if (scheme_)
    for (int row : scheme_->breaking().rows())
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
  flush_mean_reactions();
  sync_from_world();
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

/// Names what follows something that is not finite, the motor, or the joint if that shows at the start of the
/// step or at its end; or the joint whose row of S is not, or the force law or the body.
void Simulator::Impl::fail_not_finite() {
  const auto fail = [this](const std::string& what, Culprit culprit, const std::string& why) {
    culprit.share = std::numeric_limits<double>::infinity();
    report_.culprits = {culprit};
    set_failure(Status::kNotFinite, what + name_of(culprit, source_) + why);
  };
  if (scheme_ && !scheme_->axes().finite()) {
    const AxisId axis = scheme_->axes().not_finite();
    return fail("what the motor of ", {.kind = Culprit::Kind::kAxis, .axis = axis}, " follows is not finite");
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
      return fail("what ", {.kind = Culprit::Kind::kJoint, .axis = {*joint}}, " follows is not finite");
    }
  }
  if (const JointId joint = overflowing_joint(start); joint.index >= 0)
    return fail("J M⁻¹ Jᵀ of ", {.kind = Culprit::Kind::kJoint, .axis = {joint}},
                " is not finite: its factors are too large for its bodies");
  if (const ForceId force = force_not_finite(); force.index >= 0) {
    const bool spring = source_.force(force).spring() != nullptr;
    return fail("what ", {.kind = spring ? Culprit::Kind::kSpring : Culprit::Kind::kForce, .force = force},
                spring ? " pulls with is not finite" : " gives is not finite");
  }
  if (const BodyId body = body_not_finite(); body.index > 0) {
    const Twist& V = start.twists[body.index];
    std::ostringstream text;
    text << " does not stay finite (within 1e30 m, m/s and rad/s), from " << V.v.norm() << " m/s and "
         << V.w.norm()
         << " rad/s before the step: a shorter step may help, or forces, speeds and masses of usual sizes";
    return fail("", {.kind = Culprit::Kind::kBody, .a = body}, text.str());
  }
  set_failure(Status::kNotFinite, "a force or the state is not finite");
}

/// The first force law that gives what is not finite at the start of the step, at its end, or where the
/// integrator is; none: index −1.
ForceId Simulator::Impl::force_not_finite() const {
  std::vector<State> states{source_.state(), source_.state()};
  states[1].time += report_.dt;
  if (scheme_ && !weld_loads_) states.push_back(scheme_->state());
  std::vector<Wrench> wrenches;
  for (const State& state : states) {
    const auto finite = [&](const Pose& X) { return X.p.allFinite() && X.q.coeffs().allFinite(); };
    if (!std::all_of(state.poses.begin(), state.poses.end(), finite)) continue;
    for (int i = 0; i < source_.force_count(); ++i) {
      wrenches.assign(source_.body_count(), Wrench{});
      source_.force(ForceId{i}).accumulate(state, wrenches);
      for (const Wrench& F : wrenches)
        if (!(F.force.allFinite() && F.torque.allFinite())) return {i};
    }
  }
  return {};
}

/// The first body whose state is not finite; none: the ground.
BodyId Simulator::Impl::body_not_finite() const {
  if (force_level_) return force_level_->not_finite();
  if (!scheme_) return kGround;
  for (int b = 0; b < world_.body_count(); ++b) {
    const Pose& X = scheme_->state().poses[b];
    const Wrench& p = scheme_->momenta()[b];
    const Twist& V = scheme_->state().twists[b];
    if (!(within_reach(X, V) && X.q.coeffs().allFinite() && p.torque.allFinite() && p.force.allFinite()))
      return {b};
  }
  return kGround;
}

/// ": ball elbow stays open by 1e-09 m; a shorter step …" of the joint that does most, which is noted; "" if
/// none does, or no more than `least`.
std::string Simulator::Impl::widest_gap(const State& state, std::span<const double> phi, double least) {
  std::vector<Gap> gaps = joint_gaps(system_->rows(), phi);
  gaps.resize(system_->rows().joint_count());  // springs and contacts have none
  const auto size = [](const Gap& gap) {
    const double larger = std::max(gap.metres, gap.radians);
    return std::isfinite(gap.metres + gap.radians) ? larger : std::numeric_limits<double>::infinity();
  };
  const auto widest = std::max_element(gaps.begin(), gaps.end(),
                                       [&](const Gap& a, const Gap& b) { return size(a) < size(b); });
  if (widest == gaps.end() || !(size(*widest) > least)) return "";
  const Culprit joint{.kind = Culprit::Kind::kJoint,
                      .axis = {JointId{static_cast<int>(widest - gaps.begin())}},
                      .share = size(*widest)};
  report_.culprits = {joint};
  if (!std::isfinite(joint.share)) return ": " + name_of(joint, source_);
  std::ostringstream text;
  text << ": " << name_of(joint, source_) << " stays open by " << joint.share
       << (widest->metres >= widest->radians ? " m" : " rad") << advice(joint, state);
  return text.str();
}
std::string Simulator::Impl::widest_gap(const State& state) {
  phi_.resize(system_->row_count());
  system_->rows().residual(state, phi_);
  return widest_gap(state, phi_, 0);
}

/// "; its bodies' masses differ by a factor of 1e+09: …", one thing that fits.
std::string Simulator::Impl::advice(const Culprit& culprit, const State& state) const {
  std::ostringstream text;
  text << "; ";
  std::vector<BodyId> bodies{culprit.a, culprit.b};
  if (culprit.kind == Culprit::Kind::kJoint || culprit.kind == Culprit::Kind::kAxis) {
    const std::span<const BodyId> all = source_.joint(culprit.axis.joint).bodies();
    bodies.assign(all.begin(), all.end());
  } else if (culprit.kind == Culprit::Kind::kSpring) {
    bodies = source_.force(culprit.force).bodies();
  }
  if (culprit.kind == Culprit::Kind::kJoint) {
    // What round-off makes of its points.
    double reach = 0;
    for (BodyId body : bodies) reach = std::max(reach, state.poses[body.index].p.norm());
    const Rows& rows = system_->rows();
    std::vector<double> jacobian(rows.jacobian_size());
    rows.jacobian({state.poses, state.time, state.axes}, jacobian);
    const Rows::JointRows& joint = rows.joints()[culprit.axis.joint.index];
    for (int s = joint.first_side; s < joint.first_side + joint.side_count; ++s)
      for (int i = 0; i < joint.row_count; ++i)
        if (!rows.row(joint.first_row + i).angular)
          reach = std::max(reach, Rows::block_row(rows.sides()[s], jacobian, i).head<3>().norm());
    const double round_off = 4 * std::numeric_limits<double>::epsilon() * reach;
    if (round_off > settings_.position_tolerance) {
      text << "round-off at " << reach << " m from the origin or the centres of its bodies is " << round_off
           << " m: nearer ones, or a larger position_tolerance, help";
      return text.str();
    }
  }
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (BodyId body : bodies) {
    if (source_.is_fixed(body)) continue;
    least = std::min(least, source_.mass_properties(body).mass());
    most = std::max(most, source_.mass_properties(body).mass());
  }
  const bool contact = culprit.kind == Culprit::Kind::kContact;
  if (most > kManyTimes * least)
    text << "its bodies' masses differ by a factor of " << most / least << ": nearer ones, or ";
  else
    text << "a shorter step, or ";
  text << (contact                                  ? "a compliance of their material"
           : culprit.kind == Culprit::Kind::kSpring ? "a softer spring"
           : culprit.kind == Culprit::Kind::kAxis   ? "a compliance of its limits or of the joint"
                                                    : "a compliance of the joint")
       << ", may help";
  return text.str();
}

/// ": contact of box and ground (3e-07), … ; a shorter step …" of those that miss their laws most.
std::string Simulator::Impl::list_culprits() const {
  if (report_.culprits.empty()) return "";
  std::ostringstream text;
  text.precision(2);
  for (std::size_t i = 0; i < report_.culprits.size(); ++i)
    text << (i == 0 ? ": " : ", ") << name_of(report_.culprits[i], source_) << " ("
         << report_.culprits[i].share << ")";
  const Culprit& first = report_.culprits.front();
  if (first.kind != Culprit::Kind::kContact && first.share < kRoundOffShare)
    text << "; that is round-off of large impulses: masses nearer to each other, lower speeds or a larger "
            "velocity_tolerance help";
  else
    text << advice(first, world_.state());
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

/// `unstable`: the last sub-step was too long for tension.
void Simulator::Impl::diagnose_stall(double remaining, bool unstable) {
  const std::span<const double> phi = scheme_->values().phi;
  if (!scheme_->axes().finite() ||
      std::any_of(phi.begin(), phi.end(), [](double p) { return !std::isfinite(p); }))
    return fail_not_finite();
  Contradiction& found = report_.contradiction;
  found = contradiction_from(scheme_->state(), remaining);
  for (double steps : kStepsAhead)
    if (found.empty()) found = contradiction_from(scheme_->state(), steps * report_.dt);
  if (found.empty() && !scheme_->stages().jammed().empty()) {
    name_jam();
    return set_failure(Status::kContradiction, "friction grows with a load that it makes grow: they jam");
  }
  const ActiveSetOutcome& outcome = scheme_->stages().active_set_outcome();
  if (outcome.ok() && found.empty())
    found = find_stuck_joints(world_, *system_, scheme_->trial_poses(), report_);
  if (found.residual <= kStuckPart * settings_.position_tolerance && found.bounds.empty() && outcome.ok())
    found = {};
  Status status = found.empty() ? Status::kNotConverged : Status::kContradiction;
  if (outcome.ok()) {
    std::ostringstream message;
    if (const BodyId body = scheme_->unsettled(); found.empty() && body.index > 0) {
      const Culprit culprit{.kind = Culprit::Kind::kBody, .a = body};
      report_.culprits = {culprit};
      message << "forces that depend on velocities do not settle with sub-steps down to dt/"
              << settings_.max_substeps << ": most on " << name_of(culprit, source_)
              << "; less damping for its mass, or a shorter step, may help";
      return set_failure(status, message.str());
    }
    const std::string down = " with sub-steps down to dt/" + std::to_string(settings_.max_substeps);
    if (!found.empty()) return set_failure(status, "positions could not be closed" + down);
    if (unstable) {
      const Culprit culprit{.kind = Culprit::Kind::kBody, .a = scheme_->stiffest()};
      report_.culprits = {culprit};
      return set_failure(status, "tension on " + name_of(culprit, source_) + " is too stiff" + down +
                                     ": \"tension\": \"implicit\", a shorter step, or a larger mass helps");
    }
    if (const std::string widest = widest_gap(scheme_->state(), phi, settings_.position_tolerance);
        !widest.empty())
      return set_failure(status, "positions could not be closed" + down + widest + singular_axis());
    report_.culprits.assign(scheme_->stages().culprits().begin(), scheme_->stages().culprits().end());
    return set_failure(
        status, "joints and laws could not be met together" + down + list_culprits() + singular_axis());
  }
  // The row that misses its law most is where it shows.
  if (found.empty() && outcome.status == ActiveSetStatus::kContradiction &&
      outcome.residual > kRoundOffResidual) {
    status = Status::kContradiction;
    found.residual = outcome.residual;
    if (outcome.worst_row >= 0)
      if (const auto joint = system_->rows().joint_of(outcome.worst_row)) found.joints.push_back(*joint);
  }
  report_.culprits.assign(scheme_->stages().culprits().begin(), scheme_->stages().culprits().end());
  set_failure(status, "limits, motors, friction and contacts could not be met together with the joints" +
                          (found.empty() ? list_culprits() + singular_axis() : ""));
}

/// Joints whose friction locks them and those that force them, with motors as bounds.
void Simulator::Impl::name_jam() {
  Contradiction& found = report_.contradiction;
  const Rows& rows = system_->rows();
  const std::span<const Rows::AxisRow> axes = rows.axis_rows();
  for (int r : scheme_->stages().jammed()) {
    const auto axis = std::find_if(axes.begin(), axes.end(), [r](const auto& a) { return a.row == r; });
    if (axis != axes.end() && scheme_->axes().has_unbounded_motor(axis - axes.begin()))
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
