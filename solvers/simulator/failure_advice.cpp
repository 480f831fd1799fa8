#include "solvers/simulator/failure_advice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "core/world/diagnostics.h"

namespace taut {
namespace {

/// Of messages alone; parts and counts, chosen unless something else is said.
struct FailureAdviceTuning {
  /// An angle that changes by so many times what its bodies turn is next to where it has no value.
  static constexpr double kSingular = 50;
  /// Rates that miss their tolerance by less than this part of what acts do so by round-off.
  static constexpr double kRoundOffPart = 1e-9;
  /// An end of a wire is at its guide point if it gets there in fewer steps.
  static constexpr double kStepsToGuide = 2;
  /// Masses that differ by more times are worth a word.
  static constexpr double kManyTimes = 1e4;
};

double larger_gap(const Gap& gap) {
  const double larger = std::max(gap.metres, gap.radians);
  return std::isfinite(gap.metres + gap.radians) ? larger : std::numeric_limits<double>::infinity();
}

std::vector<BodyId> bodies_of(const Culprit& culprit, const World& world) {
  switch (culprit.kind) {
    case Culprit::Kind::kJoint:
    case Culprit::Kind::kAxis: {
      const std::span<const BodyId> all = world.joint(culprit.axis.joint).bodies();
      return {all.begin(), all.end()};
    }
    case Culprit::Kind::kSpring:
      return world.force(culprit.force).bodies();
    default:
      return {culprit.a, culprit.b};
  }
}

/// The largest coordinate or arm of a joint's points [m], of which they have the round-off.
double reach_of_points(JointId id, std::span<const BodyId> bodies, const Rows& rows, const State& state) {
  double reach = 0;
  for (BodyId body : bodies) reach = std::max(reach, state.poses[body.index].p.norm());
  std::vector<double> jacobian(rows.jacobian_size());
  rows.jacobian({state.poses, state.time, state.axes}, jacobian);
  const Rows::JointRows& joint = rows.joints()[id.index];
  for (int s = joint.first_side; s < joint.first_side + joint.side_count; ++s)
    for (int i = 0; i < joint.row_count; ++i)
      if (!rows.row(joint.first_row + i).angular)
        reach = std::max(reach, Rows::block_row(rows.sides()[s], jacobian, i).head<3>().norm());
  return reach;
}

/// Of bodies that are not fixed [kg].
struct MassRange {
  double least = std::numeric_limits<double>::infinity(), most = 0;
};
MassRange mass_range(std::span<const BodyId> bodies, const World& world) {
  MassRange masses;
  for (BodyId body : bodies) {
    if (world.is_fixed(body)) continue;
    masses.least = std::min(masses.least, world.mass_properties(body).mass());
    masses.most = std::max(masses.most, world.mass_properties(body).mass());
  }
  return masses;
}

const char* softer(Culprit::Kind kind) {
  switch (kind) {
    case Culprit::Kind::kContact:
      return "a compliance of their material";
    case Culprit::Kind::kSpring:
      return "a softer spring";
    case Culprit::Kind::kAxis:
      return "a compliance of its limits or of the joint";
    default:
      return "a compliance of the joint";
  }
}

/// "; its bodies' masses differ by a factor of 1e+09: …", one thing that fits.
std::string advice(const Inquiry& asked, const Culprit& culprit, const State& state) {
  std::ostringstream text;
  text << "; ";
  const std::vector<BodyId> bodies = bodies_of(culprit, asked.source);
  if (culprit.kind == Culprit::Kind::kJoint) {
    const double reach = reach_of_points(culprit.axis.joint, bodies, asked.stepper.system().rows(), state);
    const double round_off = 4 * std::numeric_limits<double>::epsilon() * reach;
    if (round_off > asked.settings.position_tolerance) {
      text << "round-off at " << reach << " m from the origin or the centres of its bodies is " << round_off
           << " m: nearer ones, or a larger position_tolerance, help";
      return text.str();
    }
  }
  if (const auto [least, most] = mass_range(bodies, asked.source);
      most > FailureAdviceTuning::kManyTimes * least)
    text << "its bodies' masses differ by a factor of " << most / least << ": nearer ones, or ";
  else
    text << "a shorter step, or ";
  text << softer(culprit.kind) << ", may help";
  return text.str();
}

/// An end of a wire that gets to its guide point within a few steps: its direction there is undefined.
std::string short_span(const Inquiry& asked, const State& state) {
  const World& world = asked.world;
  for (int j = 0; j < world.joint_count(); ++j) {
    if (!world.is_attached({j})) continue;
    const std::vector<WirePoint> course = world.joint({j}).course();
    for (std::size_t i = 0; course.size() > 2 && i + 1 < course.size(); ++i) {
      const WirePoint &P = course[i], &Q = course[i + 1];
      if (P.body == Q.body) continue;
      const Pose &A = state.poses[P.body.index], &B = state.poses[Q.body.index];
      const Vec3 v = state.twists[Q.body.index].at(rotate(B.q, Q.p_BP)) -
                     state.twists[P.body.index].at(rotate(A.q, P.p_BP));
      const double span = (B.point(Q.p_BP) - A.point(P.p_BP)).norm();
      if (span > FailureAdviceTuning::kStepsToGuide * asked.report.dt * v.norm()) continue;
      std::ostringstream text;
      text << "; section " << i + 1 << " of " << world.joint({j}).type() << " "
           << asked.source.name(JointId{j}) << ", from " << world.name(P.body) << " to " << world.name(Q.body)
           << ", is used up, only " << span
           << " m are left: a rope with a stop holds there, or a limit before it";
      return text.str();
    }
  }
  return "";
}

}  // namespace

std::string widest_gap(const Inquiry& asked, const State& state, std::span<const double> phi, double least) {
  const Rows& rows = asked.stepper.system().rows();
  std::vector<Gap> gaps = joint_gaps(rows, phi);
  gaps.resize(rows.joint_count());  // springs and contacts have none
  const auto widest = std::max_element(
      gaps.begin(), gaps.end(), [](const Gap& a, const Gap& b) { return larger_gap(a) < larger_gap(b); });
  if (widest == gaps.end() || !(larger_gap(*widest) > least)) return "";
  const Culprit joint{.kind = Culprit::Kind::kJoint,
                      .axis = {JointId{static_cast<int>(widest - gaps.begin())}},
                      .share = larger_gap(*widest)};
  asked.report.culprits = {joint};
  if (!std::isfinite(joint.share)) return ": " + name_of(joint, asked.source);
  std::ostringstream text;
  text << ": " << name_of(joint, asked.source) << " stays open by " << joint.share
       << (widest->metres >= widest->radians ? " m" : " rad") << advice(asked, joint, state);
  return text.str();
}

std::string widest_gap(const Inquiry& asked, const State& state) {
  std::vector<double> phi(asked.stepper.system().row_count());
  asked.stepper.system().rows().residual(state, phi);
  return widest_gap(asked, state, phi, 0);
}

std::string list_culprits(const Inquiry& asked) {
  const std::vector<Culprit>& culprits = asked.report.culprits;
  if (culprits.empty()) return "";
  std::ostringstream text;
  text.precision(2);
  for (std::size_t i = 0; i < culprits.size(); ++i)
    text << (i == 0 ? ": " : ", ") << name_of(culprits[i], asked.source) << " (" << culprits[i].share << ")";
  const Culprit& first = culprits.front();
  if (first.kind != Culprit::Kind::kContact && first.share < FailureAdviceTuning::kRoundOffPart)
    text << "; that is round-off of large impulses: masses nearer to each other, lower speeds or a larger "
            "velocity_tolerance help";
  else
    text << advice(asked, first, asked.world.state());
  return text.str();
}

std::string singular_axis(const Inquiry& asked) {
  if (const std::string span = short_span(asked, asked.stepper.state()); !span.empty()) return span;
  const Rows& rows = asked.stepper.system().rows();
  for (const Rows::AxisRow& axis : rows.axis_rows()) {
    if (!axis.axis() || !rows.row(axis.row).angular) continue;
    const Rows::JointRows& joint = rows.joints()[rows.row(axis.row).block];
    for (int s = joint.first_side; s < joint.first_side + joint.side_count; ++s) {
      const auto block =
          Rows::block_row(rows.sides()[s], asked.stepper.system().jacobian(), axis.row - joint.first_row);
      if (!(block.head<3>().norm() > FailureAdviceTuning::kSingular)) continue;
      return "; " + std::string(asked.source.joint(axis.axis()->joint).type()) + " " +
             asked.source.axis_label(*axis.axis()) + " is next to where it has no value";
    }
  }
  return "";
}

}  // namespace taut
