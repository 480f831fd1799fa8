#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "core/world/diagnostics.h"
#include "tests/solvers/contact_energy.h"
#include "tests/solvers/integrators/moreau_jean.h"

/// Moreau–Jean time stepping of contacts and impacts against closed forms, laws and RATTLE.
namespace taut::moreau_jean_contact_test {
namespace {

using namespace moreau_jean_parts;
using testing::rubbing;

TEST(MoreauJean, BouncesReachHeightsByTheSquareOfTheRestitution) {
  // An impact is felt half a step early to half a step late, so heights are right to g h · speed/g.
  const double e = 0.7, dt = 1e-4, drop = 1;
  World world;
  world.add_shape(kGround, HalfSpace{}, {}, rubbing(0, e));
  const BodyId ball = add_ball(world, "ball", Vec3(0, 0, drop + 0.1), rubbing(0, e));
  Simulator simulator(world, moreau_jean());
  double apex = 0, expected = drop;
  int bounces = 0;
  bool fell = true;
  while (bounces < 5) {
    ASSERT_TRUE(simulator.step(dt).exact());
    const bool falls = world.twist(ball).v.z() < 0;
    apex = std::max(apex, world.pose(ball).p.z() - 0.1);
    if (!falls && fell) apex = 0;
    if (falls && !fell) {
      ++bounces;
      expected *= e * e;
      EXPECT_NEAR(apex, expected, 5 * dt * std::sqrt(2 * kG * drop)) << bounces;
    }
    fell = falls;
  }
}

TEST(MoreauJean, AnImpactReversesTheRateByTheRestitutionInOneStep) {
  // Without gravity w⁺ = −e w⁻ to round-off, however slow, and a contact that is predicted is felt.
  for (const double speed : {1.0, 1e-6}) {
    World world;
    world.set_gravity(Vec3::Zero());
    world.add_shape(kGround, HalfSpace{}, {}, rubbing(0, 0.6));
    const BodyId ball = add_ball(world, "ball", Vec3(0, 0, 0.1 + 0.4 * 0.01 * speed), rubbing(0, 0.6));
    world.set_twist(ball, {Vec3::Zero(), Vec3(0, 0, -speed)});
    Simulator simulator(world, moreau_jean());
    ASSERT_TRUE(simulator.step(0.01).exact());
    EXPECT_NEAR(world.twist(ball).v.z(), 0.6 * speed, 1e-12 * speed);
  }
}

TEST(MoreauJean, ABoxOnASlopeSticksOrSlidesByCoulombsLaw) {
  const double slope = 20 * std::numbers::pi / 180;  // tan 20° = 0.364
  for (const double friction : {0.3, 0.5}) {
    World world;
    world.set_gravity(kG * Vec3(std::sin(slope), 0, -std::cos(slope)));
    world.add_shape(kGround, HalfSpace{}, {}, rubbing(friction));
    const BodyId box = add_box(world, "box", Vec3(1, 1, 0.2), Vec3(0, 0, 0.1), rubbing(friction));
    Simulator simulator(world, moreau_jean());
    run(simulator, 1e-3, 1000);
    // Exact: the force is constant.
    const double acceleration = std::max(0.0, kG * (std::sin(slope) - friction * std::cos(slope)));
    EXPECT_NEAR(world.pose(box).p.x(), 0.5 * acceleration, 1e-9) << friction;
    EXPECT_NEAR(world.pose(box).p.z(), 0.1, 1e-11) << friction;
  }
}

TEST(MoreauJean, AStackAtRestStaysAndBearsItsWeight) {
  World world;
  const Material material = rubbing(0.5, 0.3);
  world.add_shape(kGround, HalfSpace{}, {}, material);
  std::vector<BodyId> boxes;
  for (int i = 0; i < 6; ++i)
    boxes.push_back(
        add_box(world, numbered("box", i), Vec3(1, 1, 0.5), Vec3(0, 0, 0.25 + 0.5 * i), material, 4));
  Simulator simulator(world, moreau_jean());
  run(simulator, 1.0 / 240, 480);
  for (int i = 0; i < 6; ++i)
    EXPECT_LE((world.pose(boxes[i]).p - Vec3(0, 0, 0.25 + 0.5 * i)).norm(), 1e-9) << i;
  Vec3 on_floor = Vec3::Zero();
  for (const ContactReport& contact : simulator.contacts())
    if (contact.contact.A == kGround || contact.contact.B == kGround) on_floor += contact.force;
  EXPECT_NEAR(std::abs(on_floor.z()), 6 * 4 * kG, 1e-6);
}

/// Balls and boxes thrown at each other in a heap without gravity.
void add_throng(World& world, std::uint32_t seed, const Material& material) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto vector = [&] { return Vec3(unit(random), unit(random), unit(random)); };
  for (int i = 0; i < 10; ++i) {
    const Vec3 place(0.35 * (i % 3), 0.35 * (i / 3 % 3), 0.35 * (i / 9));
    const std::string name = numbered("b", i);
    const double mass = 1 + 0.5 * unit(random);
    const BodyId body = i % 2 ? add_ball(world, name, place, material, mass, 0.12)
                              : add_box(world, name, Vec3(0.2, 0.15, 0.25), place, material, mass);
    world.set_twist(body, {3 * vector(), 2 * vector() - 3 * (place - Vec3(0.35, 0.35, 0.2))});
  }
}

TEST(MoreauJean, ImpactsKeepMomentaAndNeverAddEnergy) {
  // Frictionless with one e for all the change of energy is −½ (1 − e)/(1 + e) |ΔV|²_M, with friction and
  // e = 0 no more than −½ |ΔV|²_M; with both, the next test.
  int impacts = 0;
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    World world;
    world.set_gravity(Vec3::Zero());
    add_throng(world, seed, seed % 2 ? rubbing(0, 0.12 * seed) : rubbing(0.4));
    const Vec3 linear = linear_momentum(world, world.state()),
               angular = angular_momentum(world, world.state());
    Simulator simulator(world, moreau_jean());
    double energy = kinetic_energy(world, world.state());
    const double scale = energy;
    for (int i = 0; i < 300; ++i) {
      const StepReport& report = simulator.step(2e-3);
      ASSERT_TRUE(report.exact()) << seed << " " << i << ": " << report.message;
      // Work of the impulses against ½ (V₀ + V₁), which is what they change of the kinetic energy exactly;
      // between impacts the split rotation of a box keeps it to order h².
      const double work = report.ledger.contacts + report.ledger.friction;
      ASSERT_LE(work, 1e-12 * scale) << seed << " " << i;
      ASSERT_LE(report.kinetic_energy, energy + work + 1e-5 * scale) << seed << " " << i;
      if (work < -1e-9 * scale) ++impacts;
      energy = report.kinetic_energy;
    }
    EXPECT_LE((linear_momentum(world, world.state()) - linear).norm(), 1e-10) << seed;
    // Points of a contact are a gap apart, whose moment is lost: O(h).
    EXPECT_LE((angular_momentum(world, world.state()) - angular).norm(), 0.05) << seed;
  }
  EXPECT_GT(impacts, 50);
}

TEST(MoreauJean, AChainThatBouncesWithFrictionGainsNoEnergy) {
  // By Newton's law with friction alone 8e-3 of it in one step (Kane's paradox).
  World world;
  const Material material = rubbing(0.6, 0.9);
  world.add_shape(kGround, HalfSpace{}, {}, material);
  BodyId last = kGround;
  for (int i = 0; i < 5; ++i) {
    const BodyId link = world.add_body({.name = numbered("link", i),
                                        .mass = MassProperties::box({0.2, 0.04, 0.04}, 1),
                                        .pose = {.p = {0.2 * i, 0.01 * i, 0.3 + 0.03 * i}}});
    world.add_shape(link, Capsule{0.02, 0.15},
                    {.q = Quat(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitY()))}, material);
    world.set_twist(link, {Vec3::Zero(), Vec3(3, 0, 0)});
    if (i > 0)
      world.add(numbered("pin", i),
                Ball::at(world, last, link, Vec3(0.2 * i - 0.1, 0.01 * i - 0.005, 0.285 + 0.03 * i)));
    last = link;
  }
  Simulator simulator(world, moreau_jean());
  testing::expect_contacts_give_nothing(simulator, 2e-3, 500, 1e-6);
}

TEST(MoreauJean, PenetratesByNoMoreThanAStepsWay) {
  // Caught in the first step whose middle would lie below the floor: less than h · speed deep, and left
  // there.
  for (const double dt : {1e-2, 1e-3, 1e-4}) {
    World world;
    world.add_shape(kGround, HalfSpace{}, {}, rubbing(0.5));
    const BodyId ball = add_ball(world, "ball", Vec3(0, 0, 1.1), rubbing(0.5));
    Simulator simulator(world, moreau_jean());
    run(simulator, dt, static_cast<int>(std::lround(0.6 / dt)));
    EXPECT_LE(world.pose(ball).p.z(), 0.1 + 1e-9);
    EXPECT_GE(world.pose(ball).p.z(), 0.1 - dt * std::sqrt(2 * kG));
    EXPECT_LE(world.twist(ball).v.norm(), 1e-10);
  }
}

/// Where a box comes to after 1 s that is thrown at 3 m/s over a floor with friction, and stops.
double slide(const Settings& settings, double dt) {
  World world;
  world.add_shape(kGround, HalfSpace{}, {}, rubbing(0.4));
  const BodyId box = add_box(world, "box", Vec3(0.4, 0.4, 0.2), Vec3(0, 0, 0.1), rubbing(0.4));
  world.set_twist(box, {Vec3(0, 0, 2), Vec3(3, 0, 0)});
  Simulator simulator(world, settings);
  run(simulator, dt, static_cast<int>(std::lround(1 / dt)));
  return world.pose(box).p.x();
}

TEST(MoreauJean, ASlidingAndSpinningBoxComesNearToRattleAsTheStepShrinks) {
  const double reference = slide({}, 2.5e-4);
  const double coarse = std::abs(slide(moreau_jean(), 8e-3) - reference),
               fine = std::abs(slide(moreau_jean(), 1e-3) - reference);
  EXPECT_LT(fine, 0.3 * coarse) << coarse << " " << fine;  // order 1 would be 1/8
  EXPECT_LT(fine, 1e-3);
}

/// Heights of a chain that falls flat on the floor, one end first.
std::vector<double> fall(const Settings& settings, double dt, double& gap) {
  World world;
  const Material material = rubbing(0.5);
  world.add_shape(kGround, HalfSpace{}, {}, material);
  const std::vector<BodyId> rods = add_chain(world, 5, Vec3(0, 0, 0.4), false, &material);
  world.set_twist(rods[0], {Vec3::Zero(), Vec3(0, 0, -0.5)});
  Simulator simulator(world, settings);
  for (int i = 0; i < std::lround(0.6 / dt); ++i) {
    const StepReport& report = simulator.step(dt);
    EXPECT_TRUE(report.exact()) << i << ": " << report.message;
    gap = std::max({gap, report.gap.metres, report.gap.radians});
    if (!report.exact()) break;
  }
  std::vector<double> heights;
  for (const BodyId rod : rods) heights.push_back(world.pose(rod).p.z());
  return heights;
}

TEST(MoreauJean, AChainFallsOnTheFloorAsWithRattleAndItsJointsStayClosed) {
  double gap = 0, other = 0;
  const std::vector<double> reference = fall({}, 1e-3, other);
  for (const double dt : {4e-3, 5e-4}) {
    const std::vector<double> heights = fall(moreau_jean(), dt, gap);
    // At rest in the end; it sank into the floor by less than a step's way at the 3 m/s of its fall.
    for (std::size_t i = 0; i < heights.size(); ++i) EXPECT_NEAR(heights[i], reference[i], 3 * dt) << i;
  }
  EXPECT_LE(gap, 1e-9);
}

TEST(MoreauJean, TheLedgerClosesAndImpactsAreBookedAsLosses) {
  World world;
  world.add_shape(kGround, HalfSpace{}, {}, rubbing(0.5, 0.5));
  const Material material = rubbing(0.5, 0.5);
  add_chain(world, 4, Vec3(0, 0, 0.5), false, &material);
  Simulator simulator(world, moreau_jean());
  double losses = 0;
  for (int i = 0; i < 200; ++i) {
    const StepReport& report = simulator.step(2e-3);
    ASSERT_TRUE(report.exact()) << report.message;
    EXPECT_NEAR(report.energy() - report.ledger.start, report.ledger.total(), 1e-12 * 10);
    losses += report.ledger.contacts + report.ledger.friction;
  }
  EXPECT_LT(losses, -1);  // of 1.2 kg · 9.81 m/s² · 0.5 m
}

TEST(MoreauJean, TwoRunsHaveTheSameBits) {
  std::vector<Vec3> ends;
  for (int run = 0; run < 2; ++run) {
    World world;
    const Material material = rubbing(0.4, 0.3);
    world.add_shape(kGround, HalfSpace{}, {}, material);
    add_throng(world, 7, material);
    Simulator simulator(world, moreau_jean());
    for (int i = 0; i < 150; ++i) ASSERT_TRUE(simulator.step(2e-3).exact());
    for (int b = 1; b < world.body_count(); ++b) ends.push_back(world.pose(BodyId{b}).p);
  }
  for (std::size_t i = 0; i < ends.size() / 2; ++i) EXPECT_EQ(ends[i], ends[i + ends.size() / 2]);
}

}  // namespace
}  // namespace taut::moreau_jean_contact_test
