#include "solvers/laws/breaking.h"

#include <algorithm>
#include <cmath>

#include "solvers/laws/law_constants.h"

namespace taut {
namespace {

/// Without a unit: parts and counts.  Chosen, where nothing else is said.  (solvers/laws, "Breaking")
struct BreakingTuning {
  /// Overloads that differ by less than this part break together, so that symmetric structures stay so: above
  /// what round-off and tolerances leave of their symmetry.
  static constexpr double kSameOverload = 1e-6;
  /// A load above its limit by no more than this part still holds: round-off.
  static constexpr double kBreakLeeway = 1e-9;
  /// Times, relative to 1 s or the time itself if that is more, that differ by less are the same.
  static constexpr double kSameTime = 1e-9;
  /// A sub-step ends at the first break in it so often in a row; then the break is at its start.
  static constexpr int kMostShortened = 4;
  /// A load that grows by more than this part from one sub-step to the next is no straight line.
  static constexpr double kSmooth = 0.25;
};

}  // namespace

Breaking::Breaking(const World& world, const Rows& rows) : world_(world), all_rows_(rows) {}

bool Breaking::is_out(JointId joint) const {
  return all_rows_.joints()[joint.index].row_count == 0 ||
         std::any_of(events_.begin(), events_.end(), [&](const auto& e) { return e.joint == joint; });
}

/// Mean of the reaction on B over the sub-step, and how much of its limit that is.
Breaking::Load Breaking::load_of(const Substep& step, const std::pair<JointId, BreakLimits>& joint) const {
  const Rows::JointRows& rows = all_rows_.joints()[joint.first.index];
  const Rows::Side& side = all_rows_.sides()[rows.first_side + 1];
  Eigen::Matrix<double, 6, 1> wrench = Eigen::Matrix<double, 6, 1>::Zero();
  for (int i = 0; i < rows.row_count; ++i)
    wrench += (step.lambda[rows.first_row + i] + step.mu[rows.first_row + i]) / step.h *
              Rows::block_row(side, step.system.jacobian(), i);
  const Joint& made = world_.joint(joint.first);
  const Vec3 force = wrench.tail<3>(), arm = step.end.poses[side.body].q * made.reaction_point_B();
  Load load{force.norm(), (wrench.head<3>() - arm.cross(force)).norm(), 0};
  load.ratio = std::max(load.force / joint.second.force, load.torque / joint.second.torque);
  return load;
}

bool Breaking::check(const Substep& step) {
  const double h = step.h;
  overloaded_.clear();
  time_to_break_ = 0;
  const double worst = find_loads(step), first = first_break(h);
  const bool within = first < (1 - LawTuning::kTogether) * h;
  if (worst <= 1 + BreakingTuning::kBreakLeeway && !within) {
    last_loads_ = loads_;
    last_h_ = h;
    has_loads_ = true;
    return false;
  }
  due_.clear();
  if (within && first > LawTuning::kTogether * h)
    shorten(first, step.end.time - h + first, h);
  else
    overload(worst, h);
  return true;
}

/// loads_ of the joints that are left.
/// @returns the largest part of a limit, or what a joint bears by all means if that is more.
double Breaking::find_loads(const Substep& step) {
  const auto breakable = world_.breakable();
  loads_.assign(breakable.size(), {});
  double worst = 1 + BreakingTuning::kBreakLeeway;
  for (std::size_t i = 0; i < breakable.size(); ++i) {
    if (is_out(breakable[i].first)) continue;
    loads_[i] = load_of(step, breakable[i]);
    worst = std::max(worst, loads_[i].ratio);
  }
  return worst;
}

/// The first time within the sub-step, from its start, at which a load comes to its limit; near its end if
/// none does, or if loads are not to be interpolated.
double Breaking::first_break(double h) const {
  double first = (1 - LawTuning::kTogether) * h;
  const bool interpolate = has_loads_ && last_loads_.size() == loads_.size() && due_.empty() &&
                           shortened_ < BreakingTuning::kMostShortened;
  const auto breakable = world_.breakable();
  for (std::size_t i = 0; interpolate && i < breakable.size(); ++i)
    if (!is_out(breakable[i].first)) first = std::min(first, time_to_limit(i, h));
  return first;
}

/// The sub-step is to be taken again up to its first break.
void Breaking::shorten(double first, double time, double h) {
  time_to_break_ = first;
  due_time_ = time;
  append_limited(first + LawTuning::kTogether * h, h, due_);
  ++shortened_;
}

/// The sub-step is to be taken again without the joints that bear less than this, or have their limit at its
/// very start.
void Breaking::overload(double worst, double h) {
  const auto breakable = world_.breakable();
  for (std::size_t i = 0; i < breakable.size(); ++i)
    if (loads_[i].ratio >= (1 - BreakingTuning::kSameOverload) * std::max(1.0, worst))
      overloaded_.push_back(breakable[i].first);
  if (worst <= 1 + BreakingTuning::kBreakLeeway) append_limited(LawTuning::kTogether * h, h, overloaded_);
}

/// Adds the joints whose loads come to their limits until then.
void Breaking::append_limited(double until, double h, std::vector<JointId>& joints) const {
  const auto breakable = world_.breakable();
  for (std::size_t i = 0; i < breakable.size(); ++i)
    if (!is_out(breakable[i].first) && time_to_limit(i, h) <= until) joints.push_back(breakable[i].first);
}

/// When the straight line through the middles of the last sub-step and this one comes to the limit, from the
/// start of this one; h if it does not, or if the load jumped.
double Breaking::time_to_limit(std::size_t i, double h) const {
  const double before = last_loads_[i].ratio, now = loads_[i].ratio;
  if (!(before < 1 && now > before) || now - before > BreakingTuning::kSmooth * now) return h;
  return std::clamp((1 - before) / (now - before) * 0.5 * (last_h_ + h) - 0.5 * last_h_, 0.0, h);
}

/// The rest of a step may have been cut otherwise in between.
bool Breaking::due(double time) {
  overloaded_.clear();
  if (!due_.empty() &&
      std::abs(time - due_time_) <= BreakingTuning::kSameTime * std::max(1.0, std::abs(time)))
    overloaded_ = due_;
  due_.clear();
  return !overloaded_.empty();
}

void Breaking::release(const State& state) {
  const auto breakable = world_.breakable();
  const auto leave = [&](BreakEvent event) {
    const Rows::JointRows& rows = all_rows_.joints()[event.joint.index];
    event.time = state.time;
    event.energy = world_.spring_energy_of(event.joint, state);
    for (int i = 0; i < rows.row_count; ++i) rows_.push_back(rows.first_row + i);
    events_.push_back(event);
  };
  for (const JointId joint : overloaded_) {
    const auto at =
        std::find_if(breakable.begin(), breakable.end(), [&](const auto& b) { return b.first == joint; });
    const Load& load = loads_[at - breakable.begin()];
    const double scale =
        load.ratio < 1 ? 1 / load.ratio : 1;  // the mean up to the break is less than the load there
    leave({.joint = joint, .force = scale * load.force, .torque = scale * load.torque});
  }
  for (std::size_t k = 0; k < events_.size(); ++k)  // grows while it goes
    for (int j = 0; j < world_.joint_count(); ++j) {
      const std::vector<JointId> couples = world_.joint(JointId{j}).couples();
      if (!is_out({j}) && std::find(couples.begin(), couples.end(), events_[k].joint) != couples.end())
        leave({.joint = {j}, .with = events_[k].joint});
    }
  std::sort(rows_.begin(), rows_.end());
  has_loads_ = false;
  shortened_ = 0;
}

}  // namespace taut
