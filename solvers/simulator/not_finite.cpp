#include "solvers/simulator/not_finite.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>

#include "core/state/reach.h"

namespace taut {
namespace {

/// The first joint that follows something which is not finite at the start of the step or at its end.
std::optional<JointId> joint_that_follows_no_number(const Inquiry& asked) {
  const State& start = asked.world.state();
  const Rows& rows = asked.stepper.system().rows();
  std::vector<double> gap(rows.row_count()), rate(rows.row_count());
  for (const double time : {start.time, start.time + asked.report.dt}) {
    const Configuration at(start.poses, time, start.axes);
    rows.residual(at, gap);
    std::fill(rate.begin(), rate.end(), 0.0);
    rows.add_rate(at, rate);
    for (int r = 0; r < rows.row_count(); ++r)
      if (const std::optional<JointId> joint = rows.joint_of(r); joint && !std::isfinite(gap[r] + rate[r]))
        return joint;
  }
  return std::nullopt;
}

/// The first joint with a row whose S_rr overflows at the start of the step.
std::optional<JointId> overflowing_joint(const Inquiry& asked) {
  const State& state = asked.world.state();
  ConstraintSystem& system = asked.stepper.system();
  system.linearize({state.poses, state.time, state.axes});
  system.set_mass(state.poses);
  const std::span<const double> W = system.weighted();
  const Rows& rows = system.rows();
  for (const Rows::Side& side : rows.sides()) {
    const auto* joint = std::get_if<JointId>(&rows.joints()[side.block].owner);
    for (int i = 0; joint && i < side.row_count; ++i)
      if (std::isinf(
              Eigen::Map<const Eigen::Matrix<double, 6, 1>>(W.data() + side.whole + 6 * i).squaredNorm()))
        return *joint;
  }
  return std::nullopt;
}

bool all_finite(const State& state) {
  return std::all_of(state.poses.begin(), state.poses.end(),
                     [](const Pose& X) { return X.p.allFinite() && X.q.coeffs().allFinite(); });
}

/// The first force law that gives what is not finite at the start of the step, at its end, or where the
/// integrator is, unless it has merged bodies.
std::optional<ForceId> force_not_finite(const Inquiry& asked) {
  const World& source = asked.source;
  std::vector<State> states{source.state(), source.state()};
  states[1].time += asked.report.dt;
  if (!asked.merges) states.push_back(asked.stepper.state());
  std::vector<Wrench> wrenches;
  for (const State& state : states) {
    if (!all_finite(state)) continue;
    for (int i = 0; i < source.force_count(); ++i) {
      wrenches.assign(source.body_count(), Wrench{});
      source.force(ForceId{i}).accumulate(state, wrenches);
      for (const Wrench& F : wrenches)
        if (!(F.force.allFinite() && F.torque.allFinite())) return ForceId{i};
    }
  }
  return std::nullopt;
}

/// The first body whose state is not finite; none: the ground.
BodyId body_not_finite(const Scheme& scheme) {
  if (scheme.not_finite() != kGround) return scheme.not_finite();
  const std::span<const Wrench> momenta = scheme.momenta();
  for (int b = 0; b < std::ssize(scheme.state().poses); ++b) {
    const Pose& X = scheme.state().poses[b];
    const Wrench& p = momenta[b];
    const Twist& V = scheme.state().twists[b];
    if (!(within_reach(X, V) && X.q.coeffs().allFinite() && p.torque.allFinite() && p.force.allFinite()))
      return {b};
  }
  return kGround;
}

std::string speeds_of(const Twist& V) {
  std::ostringstream text;
  text << " does not stay finite (within 1e30 m, m/s and rad/s), from " << V.v.norm() << " m/s and "
       << V.w.norm()
       << " rad/s before the step: a shorter step may help, or forces, speeds and masses of usual sizes";
  return text.str();
}

}  // namespace

void end_not_finite(const Inquiry& asked) {
  const auto end = [&](const std::string& what, Culprit culprit, const std::string& why) {
    culprit.share = std::numeric_limits<double>::infinity();
    asked.report.culprits = {culprit};
    asked.end_step(Status::kNotFinite, what + name_of(culprit, asked.source) + why);
  };
  const Scheme& scheme = asked.stepper.scheme();
  if (const std::optional<AxisId>& axis = scheme.axes().not_finite()) {
    const std::optional<AxisMotor>& motor = asked.source.axis_properties(*axis).motor;
    const bool follows = motor && motor->mode == AxisMotor::Mode::kTrajectory;
    return end(follows ? "what the motor of " : "the law of ", {.kind = Culprit::Kind::kAxis, .axis = *axis},
               follows ? " follows is not finite" : " is not finite");
  }
  if (const auto joint = joint_that_follows_no_number(asked))
    return end("what ", {.kind = Culprit::Kind::kJoint, .axis = {*joint}}, " follows is not finite");
  if (const auto joint = overflowing_joint(asked))
    return end("J M⁻¹ Jᵀ of ", {.kind = Culprit::Kind::kJoint, .axis = {*joint}},
               " is not finite: its factors are too large for its bodies");
  if (const auto force = force_not_finite(asked)) {
    const bool spring = asked.source.force(*force).spring() != nullptr;
    return end("what ", {.kind = spring ? Culprit::Kind::kSpring : Culprit::Kind::kForce, .force = *force},
               spring ? " pulls with is not finite" : " gives is not finite");
  }
  if (const BodyId body = body_not_finite(scheme); body.index > 0)
    return end("", {.kind = Culprit::Kind::kBody, .a = body},
               speeds_of(asked.world.state().twists[body.index]));
  asked.end_step(Status::kNotFinite, "a force or the state is not finite");
}

}  // namespace taut
