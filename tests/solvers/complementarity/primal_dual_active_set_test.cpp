#include "solvers/complementarity/primal_dual_active_set.h"

#include <gtest/gtest.h>

#include "scenes/builders/scene.h"
#include "solvers/complementarity/interior_point.h"
#include "solvers/simulator/simulator.h"
#include "tests/solvers/complementarity/law_problems.h"

namespace taut::primal_dual_active_set_test {
namespace {

using namespace law_problems;

std::span<double> span_of(VectorXd& v) { return {v.data(), static_cast<std::size_t>(v.size())}; }

/// Boxes in ten times as many rows as freedoms, from what interior points make of them with other rates: each
/// row by itself, with dense arithmetic.
TEST(PrimalDualActiveSet, FollowsRatesThatChangeALittle) {
  std::mt19937 random(5);
  int solved = 0;
  for (int problem = 0; problem < 20; ++problem) {
    const World world = random_world(3, 30, 0, random);
    ConstraintSystem system = system_of(world);
    const int n = system.row_count();
    const MatrixXd S = dense_system(world);
    VectorXd impulse(n), change(n), lambda = VectorXd::Zero(n), w(n);
    for (int r = 0; r < n; ++r)
      impulse[r] = uniform(random, -1, 1) / n, change[r] = uniform(random, -1, 1) / n;
    VectorXd b = S * impulse;
    std::vector<RowLaw> laws;
    for (int r = 0; r < n; ++r) laws.push_back(RowLaw::box(-0.1, 0.1));
    StageTimes times;
    InteriorPoint interior(system);
    ASSERT_TRUE(interior.solve(laws, span_of(b), span_of(lambda), span_of(w), {}, times).converged);
    b += 1e-6 * S * change;
    PrimalDualActiveSet newton(system);
    const PrimalDualOutcome outcome = newton.solve(laws, span_of(b), span_of(lambda), span_of(w), {}, times);
    if (!outcome.converged) continue;
    ++solved;
    const VectorXd rates = S * lambda + b;
    for (int r = 0; r < n; ++r)
      EXPECT_LT(violation(laws[r], lambda[r], rates[r], 1e-8), 1e-8) << problem << " " << r;
  }
  EXPECT_GE(solved, 18);
}

/// A net whose joints all stick is done without a factor and without sub-steps, whatever its tension, and
/// does not creep; when friction is taken away it falls.
TEST(PrimalDualActiveSet, LetsARubbingNetRest) {
  Scene scene = build_scene("net-friction", {{"n", 8}, {"friction", 10}});
  Simulator simulator(scene.world, scene.settings);
  for (int step = 0; step < 5; ++step) ASSERT_TRUE(simulator.step(scene.dt).exact());
  const std::vector<Pose> poses = scene.world.state().poses;
  for (int step = 0; step < 200; ++step) {
    const StepReport& report = simulator.step(scene.dt);
    ASSERT_TRUE(report.exact()) << report.message;
    EXPECT_EQ(report.counts.factorizations, 0) << step;
    EXPECT_LE(report.gap.metres, 1e-10) << step;
    EXPECT_LE(report.complementarity_residual, 1e-9) << step;
    EXPECT_NEAR(report.energy() - report.ledger.start, report.ledger.total(), 1e-12) << step;
  }
  // The tolerance of positions, which no joint goes beyond however long it rests.
  for (int b = 0; b < scene.world.body_count(); ++b)
    EXPECT_LE((scene.world.pose(BodyId{b}).p - poses[b].p).norm(), 1e-10) << b;

  for (int j = 0; j < scene.world.joint_count(); ++j)
    for (const char* turn : {"turn_x", "turn_y", "turn_z"})
      scene.world.set_friction(scene.world.axis(JointId{j}, turn), AxisFriction{1e-3, 1e-3, 0});
  for (int step = 0; step < 10; ++step) {
    const StepReport& report = simulator.step(scene.dt);
    ASSERT_TRUE(report.exact()) << report.message;
    EXPECT_LE(report.gap.metres, 1e-9) << step;
    EXPECT_LE(report.complementarity_residual, 1e-9) << step;
    EXPECT_NEAR(report.energy() - report.ledger.start, report.ledger.total(), 1e-12) << step;
  }
  EXPECT_GT(simulator.report().kinetic_energy, 1e-3);
}

}  // namespace
}  // namespace taut::primal_dual_active_set_test
