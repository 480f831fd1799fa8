#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/constraints/rows.h"
#include "core/joints/joints.h"
#include "scenes/files/scene_file.h"
#include "solvers/integrators/rattle.h"
#include "solvers/simulator/simulator.h"
#include "tests/solvers/complementarity/law_problems.h"
#include "tests/source_dir.h"

// The natural residual that a step reports is that of the laws as they stand, and small enough for a success.
namespace taut::natural_residual_test {
namespace {

using namespace law_problems;

/// Limits that are often touched at the start, motors and friction that often hold, springs.
void add_laws(World& world, AxisId axis, std::mt19937& random) {
  const auto chance = [&](double p) { return uniform(random, 0, 1) < p; };
  if (chance(0.5)) {
    const double at = world.axis_value(axis);
    world.set_limits(axis, AxisLimits{.lower = at - (chance(0.3) ? 0 : uniform(random, 0, 0.3)),
                                      .upper = at + uniform(random, 0.01, 0.3),
                                      .restitution = chance(0.5) ? 0.0 : 0.6});
  }
  if (chance(0.4)) {
    const double sliding = uniform(random, 0, 30);
    world.set_friction(axis, AxisFriction{sliding * uniform(random, 1, 1.3), sliding, uniform(random, 0, 1)});
  }
  if (chance(0.4)) {
    AxisMotor motor{.target = uniform(random, -3, 3), .max_force = uniform(random, 0.1, 50)};
    if (chance(0.4)) motor.mode = AxisMotor::Mode::kPosition;
    world.set_motor(axis, motor);
  }
  if (chance(0.3))
    world.set_spring(axis,
                     AxisSpring{.stiffness = uniform(random, 1, 1e4), .damping = uniform(random, 0, 2)});
}

/// A tree of hinges, sliders and universal joints, and `loops` more joints: hinges a second time, with laws
/// of their own, or ball joints that close a loop.
World random_mechanism(int bodies, int loops, std::mt19937& random) {
  World world;
  std::vector<JointId> joints;
  struct Hinged {
    BodyId a, b;
    Vec3 p, axis;
  };
  std::vector<Hinged> hinges;
  for (int i = 0; i < bodies; ++i) {
    const double z = uniform(random, 0.2, 1), y = uniform(random, 0.2, 1), x = uniform(random, 0.2, 1);
    const Vec3 size(x, y, z);
    const BodyId b = world.add_body({.mass = MassProperties::box(size, std::pow(10, uniform(random, -1, 1))),
                                     .pose = {.p = 2 * random_vector(random)}});
    const int below = integer(random, 0, i);  // 0: the ground
    const BodyId a = below == 0 ? kGround : BodyId{b.index - below};
    const Vec3 p = world.pose(b).p + 0.5 * random_vector(random);
    const Vec3 u = random_vector(random).normalized(), v = u.unitOrthogonal();
    switch (integer(random, 0, 3)) {
      case 0:
        joints.push_back(world.add("", Slider::at(world, a, b, p, u)));
        break;
      case 1:
        joints.push_back(world.add("", Universal::at(world, a, b, p, u, v)));
        break;
      default:
        joints.push_back(world.add("", Hinge::at(world, a, b, p, u)));
        hinges.push_back({a, b, p, u});
    }
  }
  for (int i = 0; i < loops; ++i) {
    if (!hinges.empty() && integer(random, 0, 1) == 0) {
      const Hinged& h = hinges[integer(random, 0, static_cast<int>(hinges.size()) - 1)];
      joints.push_back(world.add("", Hinge::at(world, h.a, h.b, h.p + 0.4 * h.axis, h.axis)));
    } else {
      const BodyId b{integer(random, 1, bodies)};
      world.add("", Ball::at(world, kGround, b, world.pose(b).p + 0.3 * random_vector(random)));
    }
  }
  for (const JointId joint : joints)
    for (int k = 0; k < std::min(2, world.axis_count(joint)); ++k) add_laws(world, {joint, k}, random);
  return world;
}

/// The stages of one step, and the natural map of all that it was solved for, dense.
class Stages : public Rattle {
 public:
  Stages(World& world, ConstraintSystem& system, const Settings& settings)
      : Rattle(world, system, settings), mechanism_(world) {
    StepReport report;
    start(world.state(), Velocities::kGiven, report);
  }
  double reported() const { return stages_.accuracy().natural(); }

  /// The residual of the position stage, which is left as it is.
  double of_positions(double h) {
    StepReport report;
    predict_multipliers(h, values_.lambda);
    begin_bounds(h);
    EXPECT_TRUE(close_bounded_positions(h, values_.lambda, phase_.trial_poses, report));
    mechanism_.set_state(phase_.state);
    const Rows rows(mechanism_);
    std::vector<double> before(rows.row_count()), after(rows.row_count());
    rows.residual({phase_.state.poses, 0, phase_.state.axes}, before);
    rows.residual({phase_.trial_poses, h, phase_.state.axes}, after);
    VectorXd w(rows.row_count());
    for (int r = 0; r < rows.row_count(); ++r) w[r] = (after[r] - (rows.is_equality(r) ? 0 : before[r])) / h;
    return natural_map(rows, w, values_.lambda);
  }
  /// Of the velocity stage after advance().
  double of_velocities() {
    mechanism_.set_state(phase_.state);
    const Rows rows(mechanism_);
    std::vector<double> jacobian(rows.jacobian_size());
    rows.jacobian(phase_.state.poses, jacobian);
    VectorXd w(rows.row_count());
    rows.apply(jacobian, phase_.state.twists, {w.data(), static_cast<std::size_t>(w.size())});
    return natural_map(rows, w, values_.mu);
  }

 private:
  double natural_map(const Rows& rows, const VectorXd& w, const std::vector<double>& impulses) const {
    const MatrixXd S = dense_system(mechanism_);
    const VectorXd lambda = Eigen::Map<const VectorXd>(impulses.data(), w.size()), b = w - S * lambda;
    double scale = 0, error = 0;
    for (int r = 0; r < w.size(); ++r) {
      const double root = std::sqrt(S(r, r));
      scale = std::max({scale, root * std::abs(lambda[r]), std::abs(b[r]) / root});
      if (rows.is_equality(r)) continue;
      const RowLaw::Point answer = stages_.laws()[r].resolve(S(r, r), w[r] - S(r, r) * lambda[r]);
      if (RowLaw::is_vertical(answer.segment)) scale = std::max(scale, std::abs(answer.w) / root);
      error = std::max(error, root * std::abs(lambda[r] - answer.lambda));
    }
    return error / scale;
  }
  World mechanism_;
};

TEST(NaturalResidual, IsThatOfTheDenseProblemOfBothStages) {
  std::mt19937 random(3);
  const double h = 5e-3;
  int measured = 0;
  for (int mechanism = 0; mechanism < 100; ++mechanism) {
    const int loops = integer(random, 0, 1), bodies = integer(random, 1, 6);
    World world = random_mechanism(bodies, loops, random);
    for (int b = 1; b <= world.body_count() - 1; ++b)
      world.set_twist(BodyId{b}, {random_vector(random), random_vector(random)});
    if (Rows(world).axis_rows().empty()) continue;
    ConstraintSystem first(world, FactorChoice::kAuto), second(world, FactorChoice::kAuto);
    Settings settings;
    settings.tension = TensionPolicy::kIgnore;
    Stages positions(world, first, settings), whole(world, second, settings);
    StepReport report;
    if (whole.advance(h, report) != Rattle::Outcome::kDone) continue;  // an impact
    ++measured;
    const double expected = std::max(positions.of_positions(h), whole.of_velocities());
    EXPECT_LE(expected, 1.01e-9) << mechanism;
    EXPECT_EQ(report.natural_residual, whole.reported());
    // b of the report is that before the last iteration of Newton, and round-off is 1e-13 or so.
    EXPECT_NEAR(whole.reported(), expected, 0.01 * expected + 1e-12) << mechanism;
  }
  EXPECT_GT(measured, 60);
}

TEST(NaturalResidual, IsAtMost1e9InEveryStepOfRandomMechanisms) {
  std::mt19937 random(5);
  for (int mechanism = 0; mechanism < 150; ++mechanism) {
    const int loops = integer(random, 0, 3), bodies = integer(random, 1, 8);
    World world = random_mechanism(bodies, loops, random);
    Simulator simulator(world);
    for (int i = 0; i < 60; ++i) {
      const StepReport& report = simulator.step(5e-3);
      ASSERT_TRUE(report.exact()) << mechanism << " step " << i << ": " << report.message;
      ASSERT_LE(report.natural_residual, 1e-9) << mechanism << " step " << i;
    }
  }
}

/// Shapes that touch nothing change no tolerance.
TEST(RobustResidual, IsAtMost1e9WhereShapesDoNotTouch) {
  std::mt19937 random(5);
  for (int mechanism = 0; mechanism < 150; ++mechanism) {
    const int loops = integer(random, 0, 3), bodies = integer(random, 1, 8);
    World world = random_mechanism(bodies, loops, random);
    world.add_shape(BodyId{1}, Sphere{0.01});
    world.add_shape(kGround, Sphere{0.01}, {.p = {0, 0, 1000}});
    Simulator simulator(world);
    for (int i = 0; i < 60; ++i) {
      const StepReport& report = simulator.step(5e-3);
      ASSERT_TRUE(report.exact()) << mechanism << " step " << i << ": " << report.message;
      ASSERT_EQ(report.contacts, 0);
      ASSERT_LE(report.natural_residual, 1e-9) << mechanism << " step " << i;
    }
  }
}

/// A step that takes all speed from bodies leaves that of round-off, which is no measure of what is left.
TEST(RobustResidual, OfBodiesThatCameToRestIsThatOfTheSpeedsOfBefore) {
  Scene scene = load_scene_file(testing::source_dir() + "/tests/adversary/rest_after_impact.json");
  Simulator simulator(scene.world, scene.settings);
  for (int i = 0; i < 10; ++i) {
    const StepReport& report = simulator.step(scene.dt);
    ASSERT_TRUE(report.exact()) << report.message;
    EXPECT_LE(report.natural_residual, 1e-8) << "step " << i;
  }
  EXPECT_LT(simulator.report().kinetic_energy, 1e-20);
}

}  // namespace
}  // namespace taut::natural_residual_test
