#include "solvers/laws/axes/axis_forces.h"

#include <algorithm>
#include <cmath>

#include "solvers/laws/axes/axis_unresolved.h"
#include "solvers/system/constraint_system.h"

namespace taut {
namespace {

std::size_t index_in_state(const AxisTable& table, std::size_t i) {
  return table.world().axis_index(*table.axis(i));
}

bool is_winch(const AxisTable& table, std::size_t i) {
  const AxisProperties& p = table.properties(i);
  return !table.released(i) && p.motor && p.motor->pulls_only;
}

/// Rows of axes that motors or friction hold, as the last step has left them.
std::vector<char> held_rows(const AxisTable& table, std::span<const AxisLaw> axes, std::size_t rows) {
  std::vector<char> held(rows, 0);
  for (std::size_t i = 0; i < axes.size(); ++i)
    held[table.row(i)] = !table.released(i) && (axes[i].motor.has_arrived() || axes[i].friction.held());
  return held;
}

}  // namespace

AxisForces::AxisForces(const World& world, const Rows& rows, bool locates_plastic)
    : table_(world, rows),
      axes_(table_.size()),
      before_(axes_),
      loads_(table_.size()),
      impacts_(table_, axes_, locates_plastic),
      work_(table_.size()) {
  if (table_.refresh()) swings_.find(table_);
}

void AxisForces::spring_forces(std::span<const double> theta, std::span<const double> rates,
                               std::span<double> lambda) const {
  for (std::size_t i = 0; i < table_.size(); ++i) {
    const int row = table_.row(i);
    if (!table_.rows()[i].spring()) continue;
    const AxisSpring& spring = *table_.properties(i).spring;
    lambda[row] = spring_force(spring, theta[row]) + damping_force(spring, rates[row]);
  }
}

void AxisForces::start(std::span<const double> theta, std::span<const double> rates) {
  for (std::size_t i = 0; i < axes_.size(); ++i) axes_[i].restart(theta[table_.row(i)], rates[table_.row(i)]);
  before_ = axes_;
}

void AxisForces::begin(double time, double h, std::span<const double> theta, std::span<const double> rates,
                       std::span<const double> effective_mass, std::span<const double> let_out) {
  step_ = {.h = h, .end_time = time + h};
  rounds_.clear();
  not_finite_.reset();
  if (table_.refresh()) swings_.find(table_);
  std::copy(axes_.begin(), axes_.end(), before_.begin());
  work_.begin();
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const int row = table_.row(i);
    axes_[i].start = {theta[row], rates[row], effective_mass[row], axes_[i].start.let_out};
  }
  any_winch_ = false;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (!is_winch(table_, i)) continue;
    any_winch_ = true;
    axes_[i].start.let_out = let_out[index_in_state(table_, i)];
  }
  swings_.begin(table_, axes_, h);
  for (std::size_t i = 0; i < axes_.size(); ++i) axes_[i].begin(table_.properties(i), step_);
}

bool AxisForces::find_unresolved(ConstraintSystem& system, bool single_kick) {
  return taut::find_unresolved(table_, axes_, step_.h, system, single_kick);
}

void AxisForces::find_effective_masses(ConstraintSystem& system, std::span<const double> alone) {
  held_.clear();
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const AxisProperties& p = table_.properties(i);
    if (table_.released(i) || !p.motor || axes_[i].motor.has_arrived() ||
        !needs_effective_mass(*p.motor, step_, axes_[i].start))
      continue;
    if (held_.empty()) held_ = held_rows(table_, axes_, alone.size());
    axes_[i].start.effective_mass = effective_mass_.of(system, table_.row(i), alone, held_);
  }
}

void AxisForces::give_ropes(const Rows& rows, State& state) {
  if (!any_winch_) return;
  rope_ends_.resize(rows.row_count());
  rows.residual(state, rope_ends_);
  for (std::size_t i = 0; i < axes_.size(); ++i)
    if (is_winch(table_, i))
      state.axes[index_in_state(table_, i)] = axes_[i].winch.let_out(rope_ends_[table_.row(i)]);
}

AxisForces::Memory AxisForces::memory() const {
  Memory memory = resting_;
  for (std::size_t i = 0; i < axes_.size(); ++i)
    if (const AxisId* axis = table_.axis(i)) memory.insert_or_assign(*axis, axes_[i]);
  return memory;
}

void AxisForces::inherit(Memory memory) {
  resting_ = std::move(memory);
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const AxisId* axis = table_.axis(i);
    const auto same = axis ? resting_.find(*axis) : resting_.end();
    if (same == resting_.end()) continue;
    if (same->second.known) axes_[i].inherit(same->second);
    resting_.erase(same);
  }
  before_ = axes_;
}

void AxisForces::forget(std::span<const char> moved) {
  const auto is_moved = [&](JointId joint) {
    const std::span<const BodyId> bodies = table_.world().joint(joint).bodies();
    return std::any_of(bodies.begin(), bodies.end(), [&](BodyId body) { return moved[body.index]; });
  };
  for (std::size_t i = 0; i < axes_.size(); ++i)
    if (const auto joint = table_.rows()[i].joint(); joint && is_moved(*joint)) axes_[i].known = false;
  std::erase_if(resting_, [&](const auto& entry) { return is_moved(entry.first.joint); });
}

void AxisForces::roll_back() {
  std::copy(before_.begin(), before_.end(), axes_.begin());
  work_.roll_back();
}

/// Those of axes that are released are none.
void AxisForces::set_laws(std::span<const double> theta, std::span<const double> rates,
                          std::span<RowLaw> laws) {
  const bool jolt = step_.in(Kick::kSecond) && impacts_.any_unlocated(theta);
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const int row = table_.row(i);
    AxisLaw& axis = axes_[i];
    if (table_.released(i)) {
      axis.release();
      laws[row] = RowLaw::none();
      continue;
    }
    const AxisProperties& p = table_.properties(i);
    const AxisRound* round = rounds_.empty() ? nullptr : &rounds_[i];
    if (!axis.set({p, step_, axis.start, impacts_[i], work_.first_kick(i), slack_, rates[row], theta[row],
                   jolt, round}))
      not_finite_ = *table_.axis(i);
    laws[row] = axis.sum(p);
  }
}

/// What the first kick took of an approach that is due belongs to the impact.
void AxisForces::begin_round(std::span<const double> mu, std::span<const double> rates, double restitution) {
  const bool first = rounds_.empty();
  step_.restitution = restitution;
  rounds_.resize(axes_.size());
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (table_.released(i)) continue;
    const double impulse = mu[table_.row(i)], rate = rates[table_.row(i)];
    const AxisLaw& axis = axes_[i];
    const bool slowed = first && impacts_[i].due() && work_.first_kick(i).limit != 0;
    rounds_[i] = {slowed ? impacts_[i].rate : rate,
                  axis.split(impulse, axis.rate_of(table_.properties(i), impulse, rate)).limit};
  }
}

void AxisForces::begin_single_kick(double vartheta) {
  step_.kick = Kick::kSingle;
  step_.vartheta = vartheta;
  work_.clear_first_kick();
}

bool AxisForces::laws_move(const ConstraintSystem& system, std::span<const double> lambda,
                           std::span<const double> w, double rate_tolerance) {
  bool moved = false;
  for (std::size_t i = 0; i < axes_.size(); ++i)
    if (!table_.released(i))
      moved = axes_[i].move(table_.properties(i), step_, w[table_.row(i)], rate_tolerance) || moved;
  const bool turned = swings_.turn(table_, axes_, lambda, w);
  return loads_.update(table_, axes_, system.rows(), system.jacobian(), lambda) || moved || turned;
}

bool AxisForces::any_slipping() const {
  for (std::size_t i = 0; i < axes_.size(); ++i)
    if (axes_[i].friction.slides(table_.properties(i).friction)) return true;
  return false;
}

void AxisForces::clear_loose(std::span<char> rows) const {
  for (std::size_t i = 0; i < axes_.size(); ++i)
    if (!axes_[i].friction.held() || !table_.properties(i).friction || table_.released(i) || !table_.axis(i))
      rows[table_.row(i)] = 0;
}

void AxisForces::rigid_limits(std::vector<Bound>& bounds) const {
  bounds.clear();
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (is_winch(table_, i) && axes_[i].winch.holds_rope())
      bounds.push_back({table_.row(i), -kUnlimited, axes_[i].winch.length, *table_.axis(i)});
    if (!table_.has_rigid_limit(i)) continue;
    const AxisLimits& limits = *table_.properties(i).limits;
    bounds.push_back({table_.row(i), limits.lower, limits.upper, *table_.axis(i)});
  }
}

Gap AxisForces::beyond_limits(std::span<const double> theta) const {
  Gap gap;
  for (const int i : table_.limited()) {
    if (table_.released(i)) continue;
    double& worst = table_.angular(i) ? gap.radians : gap.metres;
    worst = std::max(worst, std::abs(beyond(*table_.properties(i).limits, theta[table_.row(i)])));
  }
  return gap;
}

void AxisForces::finish_positions(std::span<const double> w) {
  step_.kick = Kick::kSecond;
  for (std::size_t i = 0; i < axes_.size(); ++i)
    axes_[i].finish_first_kick(table_.properties(i), w[table_.row(i)]);
}

void AxisForces::finish_velocities(std::span<const double> theta, std::span<const double> w, double time) {
  const std::span<AxisReport> reports = work_.reports();
  impacts_.finish(w, time, reports);
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const double rate = w[table_.row(i)];
    axes_[i].finish(reports[i], {theta[table_.row(i)], rate, rate - axes_[i].start.rate, work_.impulse(i)});
  }
}

void AxisForces::clear_reports() {
  work_.clear();
  impacts_.clear();
}

bool AxisForces::only_springs() const {
  return std::all_of(table_.rows().begin(), table_.rows().end(),
                     [](const auto& row) { return row.spring() != nullptr; });
}

}  // namespace taut
