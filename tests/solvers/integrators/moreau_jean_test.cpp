#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/joints/joints.h"
#include "core/world/diagnostics.h"
#include "solvers/simulator/simulator.h"

/// Moreau–Jean time stepping against closed forms, laws and RATTLE.
namespace taut::moreau_jean_test {
namespace {

constexpr double kG = 9.81;

Settings moreau_jean(double theta = 0.5, DriftCure cure = DriftCure::kAuto) {
  Settings settings;
  settings.integrator = Integrator::kMoreauJean;
  settings.theta = theta;
  settings.drift_cure = cure;
  return settings;
}

Material made(double friction, double restitution = 0) {
  Material material;
  material.static_friction = material.dynamic_friction = friction;
  material.restitution = restitution;
  return material;
}

std::string numbered(const char* what, int i) {
  std::string name = what;
  name += std::to_string(i);
  return name;
}

BodyId add_box(World& world, const std::string& name, const Vec3& size, const Vec3& position,
               const Material& material, double mass = 1) {
  const BodyId body =
      world.add_body({.name = name, .mass = MassProperties::box(size, mass), .pose = {.p = position}});
  world.add_shape(body, Box{size}, {}, material);
  return body;
}

BodyId add_ball(World& world, const std::string& name, const Vec3& position, const Material& material,
                double mass = 1, double radius = 0.1) {
  const BodyId body =
      world.add_body({.name = name, .mass = MassProperties::sphere(radius, mass), .pose = {.p = position}});
  world.add_shape(body, Sphere{radius}, {}, material);
  return body;
}

void run(Simulator& simulator, double dt, int steps) {
  for (int i = 0; i < steps; ++i) {
    const StepReport& report = simulator.step(dt);
    ASSERT_TRUE(report.exact()) << "step " << i << ": " << report.message;
    ASSERT_LE(report.natural_residual, 1e-8) << "step " << i;
    ASSERT_LE(report.velocity_residual, 1e-9) << "step " << i;
  }
}

/// A chain of rods of 0.2 m on ball joints; the first hangs from the world at `top`, or is free.
std::vector<BodyId> add_chain(World& world, int links, const Vec3& top, bool hangs,
                              const Material* material) {
  std::vector<BodyId> rods;
  for (int i = 0; i < links; ++i) {
    const Vec3 centre = top + Vec3(0.2 * i + 0.1, 0, 0);
    rods.push_back(world.add_body({.name = numbered("rod", i),
                                   .mass = MassProperties::box(Vec3(0.2, 0.04, 0.04), 0.3),
                                   .pose = {.p = centre}}));
    if (material) world.add_shape(rods.back(), Box{Vec3(0.2, 0.04, 0.04)}, {}, *material);
    if (i > 0 || hangs)
      world.add(numbered("joint", i),
                Ball::at(world, i > 0 ? rods[i - 1] : kGround, rods[i], top + Vec3(0.2 * i, 0, 0)));
  }
  return rods;
}

TEST(MoreauJean, FreeFlightIsExactAtTheMiddleAndOffByOneOrderElsewhere) {
  // q₁ = q₀ + h ((1 − θ) V₀ + θ V₁) under constant force: (θ − ½) g h t behind the parabola.
  for (const double theta : {0.5, 0.75, 1.0}) {
    World world;
    const BodyId body = world.add_body({.name = "body", .mass = MassProperties::box(Vec3(1, 2, 3), 2)});
    world.set_twist(body, {Vec3(1, 2, 0.5), Vec3(3, 0, 4)});
    const Vec3 turns = angular_momentum(world, world.state());
    Simulator simulator(world, moreau_jean(theta));
    run(simulator, 0.01, 100);
    const double height = 4 - 0.5 * kG - (theta - 0.5) * kG * 0.01;
    EXPECT_NEAR(world.pose(body).p.x(), 3, 1e-12);
    EXPECT_NEAR(world.pose(body).p.z(), height, 1e-11) << theta;
    const Vec3 about_centre =
        angular_momentum(world, world.state()) - world.pose(body).p.cross(2 * world.twist(body).v);
    EXPECT_LE((about_centre - turns).norm(), 1e-11);  // of the free body about its centre: kept exactly
  }
}

double small_swing_error(double theta, double dt) {
  // A ball of 1 m on a hinge: I = 1 + 0.004 about it; 0.2 rad, whose period is longer by θ²/16 + 11 θ⁴/3072.
  World world;
  const double amplitude = 0.2;
  const Vec3 start(std::sin(amplitude), 0, -std::cos(amplitude));
  const BodyId bob =
      world.add_body({.name = "bob", .mass = MassProperties::sphere(0.1, 1), .pose = {.p = start}});
  world.add("axle", Hinge::at(world, kGround, bob, Vec3::Zero(), Vec3::UnitY()));
  Settings settings = moreau_jean(theta);
  settings.tension = TensionPolicy::kIgnore;
  Simulator simulator(world, settings);
  const double longer = 1 + amplitude * amplitude / 16 + 11 * std::pow(amplitude, 4) / 3072;
  const double period = 2 * std::numbers::pi * std::sqrt(1.004 / kG) * longer;
  const int steps = static_cast<int>(std::lround(period / dt));
  for (int i = 0; i < steps; ++i) EXPECT_TRUE(simulator.step(period / steps).exact());
  return (world.pose(bob).p - start).norm();  // back after a period
}

TEST(MoreauJean, APendulumConvergesWithOrderOneAtLeast) {
  for (const double theta : {0.5, 1.0}) {
    const double coarse = small_swing_error(theta, 4e-3), fine = small_swing_error(theta, 2e-3),
                 finest = small_swing_error(theta, 1e-3);
    EXPECT_GT(std::log2(coarse / fine), 0.8) << theta << ": " << coarse << " " << fine;
    EXPECT_GT(std::log2(fine / finest), 0.8) << theta << ": " << fine << " " << finest;
    EXPECT_LT(finest, 5e-3) << theta;
  }
}

TEST(MoreauJean, BouncesReachHeightsByTheSquareOfTheRestitution) {
  // An impact is felt half a step early to half a step late, so heights are right to g h · speed/g.
  const double e = 0.7, dt = 1e-4, drop = 1;
  World world;
  world.add_shape(kGround, HalfSpace{}, {}, made(0, e));
  const BodyId ball = add_ball(world, "ball", Vec3(0, 0, drop + 0.1), made(0, e));
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
    world.add_shape(kGround, HalfSpace{}, {}, made(0, 0.6));
    const BodyId ball = add_ball(world, "ball", Vec3(0, 0, 0.1 + 0.4 * 0.01 * speed), made(0, 0.6));
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
    world.add_shape(kGround, HalfSpace{}, {}, made(friction));
    const BodyId box = add_box(world, "box", Vec3(1, 1, 0.2), Vec3(0, 0, 0.1), made(friction));
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
  const Material material = made(0.5, 0.3);
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
  // e = 0 no more than −½ |ΔV|²_M; with both, Newton's law may add some (Kane's paradox).
  int impacts = 0;
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    World world;
    world.set_gravity(Vec3::Zero());
    add_throng(world, seed, seed % 2 ? made(0, 0.12 * seed) : made(0.4));
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

TEST(MoreauJean, PenetratesByNoMoreThanAStepsWay) {
  // Caught in the first step whose middle would lie below the floor: less than h · speed deep, and left
  // there.
  for (const double dt : {1e-2, 1e-3, 1e-4}) {
    World world;
    world.add_shape(kGround, HalfSpace{}, {}, made(0.5));
    const BodyId ball = add_ball(world, "ball", Vec3(0, 0, 1.1), made(0.5));
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
  world.add_shape(kGround, HalfSpace{}, {}, made(0.4));
  const BodyId box = add_box(world, "box", Vec3(0.4, 0.4, 0.2), Vec3(0, 0, 0.1), made(0.4));
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
  const Material material = made(0.5);
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

TEST(MoreauJean, JointsDriftWithoutACureAndAreClosedWithThePush) {
  double gaps[2];
  for (const DriftCure cure : {DriftCure::kNone, DriftCure::kPositionPush}) {
    World world;
    add_chain(world, 6, Vec3::Zero(), true, nullptr);
    Simulator simulator(world, moreau_jean(0.5, cure));
    double& gap = gaps[cure == DriftCure::kNone ? 0 : 1] = 0;
    for (int i = 0; i < 400; ++i) {
      const StepReport& report = simulator.step(2e-3);
      ASSERT_TRUE(report.exact()) << report.message;
      gap = std::max(gap, report.gap.metres);
    }
  }
  EXPECT_GT(gaps[0], 1e-6);
  EXPECT_LE(gaps[1], 1e-9);
}

/// A ball on a slider with a spring, from 0.1 m: energy after and before 10 s.
double spring_energy(double theta) {
  World world;
  world.set_gravity(Vec3::Zero());
  const BodyId ball = world.add_body({.name = "ball", .mass = MassProperties::sphere(0.1, 1)});
  const JointId joint = world.add("slide", Slider::at(world, kGround, ball, Vec3::Zero(), Vec3::UnitX()));
  const AxisId axis = world.axis(joint, "displacement");
  world.set_spring(axis, AxisSpring{.stiffness = 100, .rest = 0.1});
  Simulator simulator(world, moreau_jean(theta));
  for (int i = 0; i < 1000; ++i) EXPECT_TRUE(simulator.step(0.01).exact());
  return total_energy(world, world.state()) / (0.5 * 100 * 0.01);
}

TEST(MoreauJean, KeepsTheEnergyOfASpringWithThetaOneHalfAndTakesItWithMore) {
  EXPECT_NEAR(spring_energy(0.5), 1, 1e-9);
  EXPECT_LT(spring_energy(0.75), 0.1);
  // Implicit Euler: each step multiplies the energy by 1/(1 + (ωh)²).
  EXPECT_NEAR(spring_energy(1), std::pow(1.01, -1000), 1e-6);
}

struct Sliders {
  std::vector<BodyId> blocks;
  std::vector<AxisId> axes;
};

/// Blocks of 2 kg beside each other that slide along x.
Sliders three_sliders(World& world) {
  Sliders sliders;
  for (int i = 0; i < 3; ++i) {
    const Vec3 p(0, i, 0);
    sliders.blocks.push_back(world.add_body({.name = numbered("block", i),
                                             .mass = MassProperties::box(Vec3(0.1, 0.1, 0.1), 2),
                                             .pose = {.p = p}}));
    const JointId joint =
        world.add(numbered("slide", i), Slider::at(world, kGround, sliders.blocks[i], p, Vec3::UnitX()));
    sliders.axes.push_back(world.axis(joint, "displacement"));
  }
  return sliders;
}

TEST(MoreauJean, AxesHaveFrictionLimitsAndMotors) {
  World world;
  world.set_gravity(Vec3::Zero());
  const auto [blocks, axes] = three_sliders(world);
  world.set_friction(axes[0], AxisFriction{.static_friction = 3, .dynamic_friction = 3});
  world.set_twist(blocks[0], {Vec3::Zero(), Vec3(1.5, 0, 0)});
  world.set_limits(axes[1], AxisLimits{.lower = -1, .upper = 0.5, .restitution = 0.4});
  world.set_twist(blocks[1], {Vec3::Zero(), Vec3(2, 0, 0)});
  world.set_motor(axes[2], AxisMotor{.mode = AxisMotor::Mode::kVelocity, .target = 0.6, .max_force = 4});
  Simulator simulator(world, moreau_jean());
  run(simulator, 1e-3, 400);
  EXPECT_NEAR(world.twist(blocks[0]).v.x(), 1.5 - 3.0 / 2 * 0.4, 1e-10);
  EXPECT_NEAR(world.pose(blocks[0]).p.x(), 1.5 * 0.4 - 0.5 * 1.5 * 0.16, 1e-10);
  EXPECT_NEAR(world.twist(blocks[1]).v.x(), -0.4 * 2, 1e-10);
  EXPECT_NEAR(world.twist(blocks[2]).v.x(), 0.6, 1e-10);  // 2 m/s² reach it after 0.3 s
  EXPECT_NEAR(world.pose(blocks[2]).p.x(), 0.5 * 0.6 * 0.3 + 0.6 * 0.1, 1e-9);
  run(simulator, 1e-3, 1000);
  EXPECT_LE(world.twist(blocks[0]).v.norm(), 1e-10);
  EXPECT_NEAR(world.pose(blocks[0]).p.x(), 1.5 * 1.5 / (2 * 1.5), 2e-3);
}

TEST(MoreauJean, DampersMotorsDriversAndSoftJointsFollowTheirClosedForms) {
  World world;
  const auto [blocks, axes] = three_sliders(world);
  world.set_spring(axes[0], AxisSpring{.stiffness = 0, .damping = 5});
  world.set_twist(blocks[0], {Vec3::Zero(), Vec3(1, 0, 0)});
  world.set_motor(axes[1], AxisMotor{.mode = AxisMotor::Mode::kPosition, .target = 0.3, .max_speed = 0.5});
  const Motion motion = harmonic_motion(0, 0.2, 3);
  world.add("drive", Driver(world, axes[2], motion));
  const BodyId bob = world.add_body({.name = "bob", .mass = MassProperties::sphere(0.1, 1)});
  const JointId soft = world.add("soft", Ball::at(world, kGround, bob, Vec3::Zero()));
  world.set_compliance(soft, JointCompliance{.translation = 1e-3, .translation_damping = 30});
  const double theta = 0.75, dt = 0.01;
  Simulator simulator(world, moreau_jean(theta));
  double rate = 1;
  for (int i = 0; i < 200; ++i) {
    const StepReport& report = simulator.step(dt);
    ASSERT_TRUE(report.exact()) << report.message;
    ASSERT_LE(report.gap.metres, 1e-9);
    rate *= (1 - (1 - theta) * dt * 5 / 2) / (1 + theta * dt * 5 / 2);
    ASSERT_NEAR(world.twist(blocks[0]).v.x(), rate, 1e-11);
    ASSERT_NEAR(world.pose(blocks[2]).p.x(), motion(world.time()).value, 1e-9);
  }
  EXPECT_NEAR(world.pose(blocks[1]).p.x(), 0.3, 1e-9);
  EXPECT_NEAR(world.pose(bob).p.z(), -1e-3 * kG, 1e-9);
}

/// In space, with three different moments, the push in action and θ beside the middle.
TEST(MoreauJean, TheLedgerClosesInSpace) {
  for (const double theta : {0.5, 0.8}) {
    World world;
    const MassProperties plate = MassProperties::box(Vec3(0.6, 0.3, 0.1), 2.0);
    const BodyId free = world.add_body({.name = "free", .mass = plate});
    world.set_twist(free, {Vec3(3, -2, 4), Vec3(1, 0, 0)});
    BodyId last = kGround;
    for (int i = 0; i < 3; ++i) {
      const BodyId next = world.add_body({.mass = plate, .pose = {.p = Vec3(2 + 0.6 * i, 0.1 * i, 0)}});
      world.add("pivot " + std::to_string(i), Ball::at(world, last, next, Vec3(1.7 + 0.6 * i, 0.05, 0.02)));
      last = next;
    }
    Simulator simulator(world, moreau_jean(theta));
    for (int i = 0; i < 200; ++i) {
      const StepReport& report = simulator.step(4e-3);
      ASSERT_TRUE(report.exact()) << report.message;
      ASSERT_NEAR(report.energy() - report.ledger.start, report.ledger.total(), 1e-11) << i;
    }
  }
}

TEST(MoreauJean, TheLedgerClosesAndImpactsAreBookedAsLosses) {
  World world;
  world.add_shape(kGround, HalfSpace{}, {}, made(0.5, 0.5));
  const Material material = made(0.5, 0.5);
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
    const Material material = made(0.4, 0.3);
    world.add_shape(kGround, HalfSpace{}, {}, material);
    add_throng(world, 7, material);
    Simulator simulator(world, moreau_jean());
    for (int i = 0; i < 150; ++i) ASSERT_TRUE(simulator.step(2e-3).exact());
    for (int b = 1; b < world.body_count(); ++b) ends.push_back(world.pose(BodyId{b}).p);
  }
  for (std::size_t i = 0; i < ends.size() / 2; ++i) EXPECT_EQ(ends[i], ends[i + ends.size() / 2]);
}

TEST(MoreauJean, WhatItCannotDoIsRefused) {
  World world;
  world.add_body({.name = "body", .mass = MassProperties::sphere(0.1, 1)});
  for (const double theta : {0.4, 1.1, std::nan("")})
    EXPECT_THROW(Simulator(world, moreau_jean(theta)), std::invalid_argument) << theta;
  EXPECT_THROW(Simulator(world, moreau_jean(0.5, DriftCure::kBaumgarte)), std::invalid_argument);
  Settings iterative = moreau_jean();
  iterative.solver = Solver::kGaussSeidel;
  EXPECT_THROW(Simulator(world, iterative), std::invalid_argument);
  Settings implicit = moreau_jean();
  implicit.tension = TensionPolicy::kImplicit;
  EXPECT_THROW(Simulator(world, implicit), std::invalid_argument);
}

TEST(MoreauJean, CompliantContactsAndBreakingJointsAreRefusedByName) {
  Material soft = made(0.5);
  soft.compliance = 1e-5;
  const auto message = [](World& world) -> std::string {
    Simulator simulator(world, moreau_jean());
    try {
      for (int i = 0; i < 200; ++i) (void)simulator.step(2e-3);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  World own;
  own.add_shape(kGround, HalfSpace{}, {}, made(0.5));
  add_ball(own, "ball", Vec3(0, 0, 0.2), soft);
  EXPECT_NE(message(own).find("compliance"), std::string::npos);
  EXPECT_EQ(own.time(), 0);

  World pair;  // found when they come together; the world is left where it was
  const ShapeId floor = pair.add_shape(kGround, HalfSpace{}, {}, made(0.5));
  const BodyId ball = add_ball(pair, "ball", Vec3(0, 0, 0.2), made(0.5));
  pair.set_contact_material(floor, ShapeId{1}, soft);
  EXPECT_NE(message(pair).find("compliant"), std::string::npos);
  EXPECT_GT(pair.time(), 0.1);
  EXPECT_GT(pair.pose(ball).p.z(), 0.09);

  World weak;
  const std::vector<BodyId> rods = add_chain(weak, 2, Vec3::Zero(), true, nullptr);
  weak.set_break(JointId{0}, BreakLimits{.force = 10});
  EXPECT_NE(message(weak).find("break"), std::string::npos);
}

}  // namespace
}  // namespace taut::moreau_jean_test
