#include "solvers/simulator/joint_reactions.h"

#include "solvers/integrators/acceleration_equation.h"

namespace taut {

struct JointReactionsTuning {
  /// Refinements of the least-norm solution, and of that where rows depend on each other: each takes the
  /// error down by the shift of S over its least eigenvalue but 0.  Chosen.
  static constexpr int kPasses = 1, kPassesOfDependent = 3;
};

void JointReactions::renew(int row_count) {
  multipliers_.assign(row_count, 0.0);
  version_ = jacobian_version_ = -1;
}

void JointReactions::solve(const World& world, const Settings& settings, Stepper& stepper) {
  if (version_ == world.state_version()) return;
  const std::span<const double> of_laws = stepper.scheme().forces_of_laws();
  if (const std::span<const double> own = stepper.scheme().present_forces(); !own.empty()) {
    multipliers_.assign(own.begin(), own.end());
  } else if (!of_laws.empty()) {
    multipliers_.assign(of_laws.begin(), of_laws.end());
  } else {
    solve_accelerations(world, settings);
    add_spring_forces(world, stepper);
  }
  version_ = world.state_version();
}

void JointReactions::solve_accelerations(const World& world, const Settings& settings) {
  const State& state = world.state();
  StageTimes times;
  ConstraintSystem system(world, settings.factor);
  system.linearize(state);
  system.set_mass(state.poses);
  system.factorize(times);
  std::vector<Wrench> forces(world.body_count());
  std::vector<Twist> accelerations(world.body_count());
  world.forces(state, forces);
  std::vector<double> rates(system.row_count());
  multipliers_.resize(system.row_count());
  acceleration_right_side(system, state, forces, accelerations, rates, multipliers_);
  std::vector<double> rhs = multipliers_, correction(rhs.size());
  system.solve(multipliers_);
  using Tuning = JointReactionsTuning;
  const int passes = system.singular() ? Tuning::kPassesOfDependent : Tuning::kPasses;
  for (int pass = 0; pass < passes; ++pass) {
    system.multiply(multipliers_, correction);
    for (std::size_t r = 0; r < rhs.size(); ++r) correction[r] = rhs[r] - correction[r];
    system.solve(correction);
    for (std::size_t r = 0; r < rhs.size(); ++r) multipliers_[r] += correction[r];
  }
}

/// Springs that have rows, behind those of the joints, give what their laws say.
void JointReactions::add_spring_forces(const World& world, const Stepper& stepper) {
  multipliers_.resize(stepper.system().row_count(), 0.0);
  const AxisForces& axes = stepper.scheme().axes();
  if (axes.empty()) return;
  const Rows& rows = stepper.system().rows();
  std::vector<double> theta(rows.row_count()), rates(rows.row_count()), jacobian(rows.jacobian_size());
  rows.residual(world.state(), theta);
  rows.jacobian(world.state(), jacobian);
  rows.apply(jacobian, world.state().twists, rates);
  axes.spring_forces(theta, rates, multipliers_);
}

Reaction JointReactions::of(JointId joint, const World& source, const Rows& own, const Rows& system,
                            std::span<const double> multipliers, double scale) {
  const Joint& j = source.joint(joint);
  const Rows::JointRows& rows = system.joints()[joint.index];
  if (rows.row_count == 0) return {};
  const Rows::Side& side = own.sides()[own.joints()[joint.index].first_side + 1];
  if (jacobian_version_ != source.state_version()) {
    jacobian_.resize(own.jacobian_size());
    own.jacobian(source.state(), jacobian_);
    jacobian_version_ = source.state_version();
  }
  Eigen::Matrix<double, 6, 1> wrench = Eigen::Matrix<double, 6, 1>::Zero();
  for (int i = 0; i < rows.row_count; ++i)
    wrench += scale * multipliers[rows.first_row + i] * Rows::block_row(side, jacobian_, i);
  Reaction reaction;
  reaction.force = wrench.tail<3>();
  reaction.torque = wrench.head<3>() - (source.pose(j.b()).q * j.reaction_point_B()).cross(reaction.force);
  return reaction;
}

}  // namespace taut
