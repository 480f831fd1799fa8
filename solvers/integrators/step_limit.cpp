#include "solvers/integrators/step_limit.h"

#include <algorithm>
#include <cmath>

namespace taut {
namespace {

constexpr int kFixed = 0;  ///< the ground, with all bodies that stick to it

}  // namespace

double fastest_transverse_frequency(std::span<const InverseMassRoot> roots,
                                    std::span<const StiffnessBlocks> stiffness) {
  // The maximum row sum of |Aᵀ K A| bounds its spectral radius, and is exact where the load is along a
  // principal axis.
  const auto row_sum = [](const Mat3& K) {
    const double xy = std::abs(K(0, 1)), xz = std::abs(K(0, 2)), yz = std::abs(K(1, 2));
    return std::max({std::abs(K(0, 0)) + xy + xz, xy + std::abs(K(1, 1)) + yz, xz + yz + std::abs(K(2, 2))});
  };
  double largest = 0;  // ω²
  for (std::size_t b = 0; b < roots.size(); ++b) {
    const Mat3& A = roots[b].rotation;
    const double t = roots[b].translation;
    const Mat3 KA = stiffness[b].rotation.lazyProduct(A);
    largest = std::max(
        {largest, row_sum(A.transpose().lazyProduct(KA)), t * t * row_sum(stiffness[b].translation)});
  }
  return std::sqrt(largest);
}

/// Who is held by friction is left out only where a step in which it lets go is looked at again.
StepLimit::StepLimit(const World& world, ConstraintSystem& system, const Settings& settings,
                     const AxisForces& axes, const Breaking& breaking, const StageSolver& stages)
    : world_(world),
      system_(system),
      settings_(settings),
      axes_(axes),
      breaking_(breaking),
      stages_(stages),
      may_leave_out_(!system.rows().depends_on_time() && settings.tension == TensionPolicy::kSubstep &&
                     settings.integrator != Integrator::kMoreauJean) {
  stiffness_.resize(world.body_count());
}

/// The step that keeps ω h ≤ max_tension_number and every body's rotation below max_rotation.
void StepLimit::update(const State& state, std::span<const double> force_multipliers) {
  step_ = std::numeric_limits<double>::infinity();
  omega_ = 0;
  if (settings_.tension != TensionPolicy::kIgnore &&
      !stages_.iterative()) {  // whose multipliers are no measure
    find_held_bodies();
    const std::span<StiffnessBlocks> stiffness = stiffness_;
    for (const Rows::BodyChunk& chunk : system_.rows().chunks()) {
      for (StiffnessBlocks& block : stiffness.subspan(chunk.begin, chunk.end - chunk.begin)) block = {};
      system_.rows().stiffness(state, force_multipliers, stiffness, chunk);
      const int settled = chunk.settled_begin, count = chunk.settled_end - settled;
      if (leaves_out_) clear_held_bodies(settled, chunk.settled_end);
      omega_ = std::max(omega_,
                        fastest_transverse_frequency(std::span(system_.mass_roots()).subspan(settled, count),
                                                     stiffness.subspan(settled, count)));
    }
    if (settings_.tension == TensionPolicy::kSubstep && omega_ > 0)
      step_ = settings_.max_tension_number / omega_;
  }
  double spin2 = 0;
  for (const Twist& V : state.twists) spin2 = std::max(spin2, V.w.squaredNorm());
  if (spin2 > 0) step_ = std::min(step_, settings_.max_rotation / std::sqrt(spin2));
}

BodyId StepLimit::stiffest() const {
  BodyId stiffest;
  double largest = 0;
  for (int b = 0; b < world_.body_count(); ++b) {
    const double omega = fastest_transverse_frequency(std::span(system_.mass_roots()).subspan(b, 1),
                                                      std::span(stiffness_).subspan(b, 1));
    if (omega > largest) largest = omega, stiffest = {b};
  }
  return stiffest;
}

/// Bodies that friction holds to the ground, directly or through others, do not move whatever their load.
/// Only where a step in which it lets go is looked at again.
void StepLimit::find_held_bodies() {
  leaves_out_ = false;
  if (!may_leave_out_ || !stages_.friction_dominated()) return;
  const Rows& rows = system_.rows();
  holding_rows_.assign(rows.row_count(), 1);
  axes_.clear_loose(holding_rows_);
  for (int r : breaking_.rows()) holding_rows_[r] = 0;
  // Sets of bodies that stick together; fixed ones are in that of the ground.
  constexpr int kLocked = 6;
  stuck_together_.reset(world_.body_count());
  for (int b = 0; b < world_.body_count(); ++b)
    if (system_.mass()[b].fixed) stuck_together_.join(kFixed, b);
  for (const Rows::JointRows& joint : rows.joints()) {
    const auto first = holding_rows_.begin() + joint.first_row;
    if (joint.side_count != 2 || joint.row_count != kLocked || std::count(first, first + kLocked, 0) > 0)
      continue;
    stuck_together_.join(rows.sides()[joint.first_side].body, rows.sides()[joint.first_side + 1].body);
  }
  for (int b = 0; b < world_.body_count() && !leaves_out_; ++b) leaves_out_ = is_held(b);
}

bool StepLimit::misses_freed_bodies() const { return leaves_out_ && axes_.any_slipping(); }

bool StepLimit::is_held(int body) {
  return !system_.mass()[body].fixed && stuck_together_.find(body) == kFixed;
}

void StepLimit::clear_held_bodies(int begin, int end) {
  for (int b = begin; b < end; ++b)
    if (is_held(b)) stiffness_[b] = {};
}

void StepLimit::restore_stiffness(const State& state, std::span<const double> force_multipliers) {
  const double omega = omega_, step = step_;
  const bool leaves_out = leaves_out_;
  update(state, force_multipliers);
  omega_ = omega, step_ = step, leaves_out_ = leaves_out;
}

}  // namespace taut
