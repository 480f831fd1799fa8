#include "solvers/simulator/weld_reactions.h"

#include "solvers/integrators/body_moves.h"

namespace taut {

void WeldReactions::renew() {
  loads_.reset();
  present_.clear();
  const MergedWorld* merged = bodies_.merged();
  if (merged && !merged->groups().empty()) loads_ = std::make_unique<WeldLoads>(bodies_.source(), *merged);
}

void WeldReactions::start_step(const State& of_world) {
  if (loads_) bodies_.merged()->expand(of_world, start_);
}

Reaction WeldReactions::mean(JointId weld, const Stepper& stepper, double dt) {
  if (start_.poses.empty()) return {};
  solve_means(stepper, dt);
  return weld.index < std::ssize(mean_) ? mean_[weld.index] : Reaction{};
}

void WeldReactions::solve_means_of_old_source(const Stepper& stepper, double dt) {
  if (loads_ && !start_.poses.empty() && bodies_.is_behind()) solve_means(stepper, dt);
}

void WeldReactions::solve_means(const Stepper& stepper, double dt) {
  if (!mean_.empty()) return;
  loads_->solve_mean(start_, dt, {stepper.system().rows(), stepper.impulses(), 1 / dt},
                     stepper.mean_contacts(dt));
  mean_ = by_joint();
}

Reaction WeldReactions::present(JointId weld, const World& world, const Stepper& stepper,
                                std::span<const double> multipliers) {
  if (present_version_ == world.state_version() && !present_.empty()) return present_[weld.index];
  const State& state = world.state();
  const Rows& rows = stepper.system().rows();
  std::vector<double> jacobian(rows.jacobian_size());
  std::vector<Wrench> forces(world.body_count()), of_joints(world.body_count());
  std::vector<Twist> accelerations(world.body_count());
  rows.jacobian(state, jacobian);
  rows.apply_transpose(jacobian, multipliers, of_joints);
  world.forces(state, forces, stepper.force_springs());
  for (int b = 0; b < world.body_count(); ++b) forces[b] = forces[b] + of_joints[b];
  free_accelerations(stepper.system().mass(), state, forces, accelerations);
  loads_->solve_present(accelerations, {rows, multipliers}, stepper.slots());
  present_ = by_joint();
  present_version_ = world.state_version();
  return present_[weld.index];
}

/// What loads_ has solved last.
std::vector<Reaction> WeldReactions::by_joint() const {
  const World& source = bodies_.source();
  std::vector<Reaction> reactions(source.joint_count());
  for (int j = 0; j < source.joint_count(); ++j) {
    if (!is_weld(JointId{j})) continue;
    const Joint& weld = source.joint(JointId{j});
    const Wrench& on_B = loads_->on_B(JointId{j});
    const Vec3 arm = loads_->state().poses[weld.b().index].q * weld.reaction_point_B();
    reactions[j] = {on_B.force, on_B.torque - arm.cross(on_B.force)};
  }
  return reactions;
}

}  // namespace taut
