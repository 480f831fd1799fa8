#include "solvers/simulator/stall_diagnosis.h"

#include <algorithm>
#include <cmath>

#include "solvers/diagnosis/contradiction.h"
#include "solvers/integrators/close_joints.h"
#include "solvers/simulator/failure_advice.h"
#include "solvers/simulator/not_finite.h"

namespace taut {
namespace {

/// Chosen, where nothing else is said.
struct StallTuning {
  /// Steps ahead at which a contradiction is looked for if there is none at the end of this one: where rates
  /// grow without bounds the step fails shortly before.
  static constexpr double kStepsAhead[] = {1, 4};
  /// Part of the tolerance that stuck joints must be open by: the step fails as soon as all of them are open
  /// by the whole of it, to a hair.
  static constexpr double kStuckPart = 0.5;
  /// What an active set without a solution leaves at least, as a part of the largest impulse, where laws
  /// contradict each other: far above the 1e-9 to which laws are met, and above its round-off.
  static constexpr double kRoundOffResidual = 1e-6;
};

std::vector<JointId> broken_joints(const Stepper& stepper) {
  std::vector<JointId> joints;
  if (!stepper.made()) return joints;
  const Rows& rows = stepper.system().rows();
  for (int row : stepper.scheme().breaking().rows())
    if (const auto joint = rows.joint_of(row); joint && (joints.empty() || joints.back() != *joint))
      joints.push_back(*joint);
  return joints;
}

}  // namespace

Contradiction contradiction_from(const Inquiry& asked, const State& state, double horizon) {
  const std::vector<JointId> gone = broken_joints(asked.stepper);
  return find_contradiction({.world = asked.world,
                             .from = state,
                             .horizon = horizon,
                             .contact_margin = asked.settings.contacts ? asked.settings.contact_margin : 0,
                             .gone = gone,
                             .named = &asked.source});
}

StallDiagnosis::StallDiagnosis(const Inquiry& asked)
    : asked_(asked),
      scheme_(dynamic_cast<ImpulseScheme&>(asked.stepper.scheme())),
      laws_(scheme_.stages().active_set_outcome()),
      found_(asked.report.contradiction) {}

void StallDiagnosis::end_step(double remaining, bool unstable) {
  if (!is_finite()) return end_not_finite(asked_);
  find_contradiction_ahead(remaining);
  if (found_.empty() && !scheme_.stages().culprits().jammed().empty()) {
    name_jam();
    return asked_.end_step(Status::kContradiction, "friction grows with a load that it makes grow: they jam");
  }
  if (laws_.ok()) find_stuck();
  const Status status = found_.empty() ? Status::kNotConverged : Status::kContradiction;
  if (laws_.ok())
    end_by_open_joints(status, unstable);
  else
    end_by_unmet_laws(status);
}

bool StallDiagnosis::is_finite() const {
  const std::span<const double> phi = scheme_.values().phi;
  return scheme_.axes().finite() &&
         std::all_of(phi.begin(), phi.end(), [](double p) { return std::isfinite(p); });
}

/// At the end of the step, and after it.
void StallDiagnosis::find_contradiction_ahead(double remaining) {
  found_ = contradiction_from(asked_, scheme_.state(), remaining);
  for (double steps : StallTuning::kStepsAhead)
    if (found_.empty()) found_ = contradiction_from(asked_, scheme_.state(), steps * asked_.report.dt);
}

/// Joints that no motion closes.  What leaves less than a tolerance contradicts nothing.
void StallDiagnosis::find_stuck() {
  if (found_.empty())
    found_ = find_stuck_joints(asked_.world, asked_.stepper.system(), scheme_.trial_poses(), asked_.report);
  if (found_.residual <= StallTuning::kStuckPart * asked_.settings.position_tolerance &&
      found_.bounds.empty())
    found_ = {};
}

/// Joints whose friction locks them and those that force them, with motors as bounds.
void StallDiagnosis::name_jam() {
  const Rows& rows = asked_.stepper.system().rows();
  const std::span<const Rows::AxisRow> axes = rows.axis_rows();
  for (int r : scheme_.stages().culprits().jammed()) {
    const auto axis = std::find_if(axes.begin(), axes.end(), [r](const auto& a) { return a.row == r; });
    if (axis != axes.end() && scheme_.axes().has_unbounded_motor(axis - axes.begin()))
      found_.bounds.push_back({*axis->axis(), Contradiction::Bound::Kind::kMotor});
    const AxisId* id = axis != axes.end() ? axis->axis() : nullptr;
    const bool has_friction = id && asked_.world.axis_properties(*id).friction;
    if (const auto joint = rows.joint_of(r); joint && (axis == axes.end() || has_friction))
      found_.joints.push_back(*joint);
  }
  std::sort(found_.joints.begin(), found_.joints.end());
  found_.joints.erase(std::unique(found_.joints.begin(), found_.joints.end()), found_.joints.end());
}

/// Laws are met, but forces do not settle, or positions stay open.
void StallDiagnosis::end_by_open_joints(Status status, bool unstable) {
  const std::string down = " with sub-steps down to dt/" + std::to_string(asked_.settings.max_substeps);
  if (const BodyId body = scheme_.unsettled(); found_.empty() && body.index > 0) {
    const Culprit culprit{.kind = Culprit::Kind::kBody, .a = body};
    asked_.report.culprits = {culprit};
    return asked_.end_step(status, "forces that depend on velocities do not settle" + down + ": most on " +
                                       name_of(culprit, asked_.source) +
                                       "; less damping for its mass, or a shorter step, may help");
  }
  if (!found_.empty()) return asked_.end_step(status, "positions could not be closed" + down);
  if (unstable) {
    const Culprit culprit{.kind = Culprit::Kind::kBody, .a = scheme_.stiffest()};
    asked_.report.culprits = {culprit};
    return asked_.end_step(status, "tension on " + name_of(culprit, asked_.source) + " is too stiff" + down +
                                       ": \"tension\": \"implicit\", a shorter step, or a larger mass helps");
  }
  if (const std::string widest =
          widest_gap(asked_, scheme_.state(), scheme_.values().phi, asked_.settings.position_tolerance);
      !widest.empty())
    return asked_.end_step(status, "positions could not be closed" + down + widest + singular_axis(asked_));
  take_culprits();
  asked_.end_step(status, "joints and laws could not be met together" + down + list_culprits(asked_) +
                              singular_axis(asked_));
}

/// Where they contradict each other, the row that misses its law most is where it shows.
void StallDiagnosis::end_by_unmet_laws(Status status) {
  if (found_.empty() && laws_.status == ActiveSetStatus::kContradiction &&
      laws_.residual > StallTuning::kRoundOffResidual) {
    status = Status::kContradiction;
    found_.residual = laws_.residual;
    if (laws_.worst_row >= 0)
      if (const auto joint = asked_.stepper.system().rows().joint_of(laws_.worst_row))
        found_.joints.push_back(*joint);
  }
  take_culprits();
  asked_.end_step(status, "limits, motors, friction and contacts could not be met together with the joints" +
                              (found_.empty() ? list_culprits(asked_) + singular_axis(asked_) : ""));
}

void StallDiagnosis::take_culprits() {
  const auto& culprits = scheme_.stages().culprits();
  asked_.report.culprits.assign(culprits.begin(), culprits.end());
}

}  // namespace taut
