#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/joints/joints.h"
#include "core/world/diagnostics.h"
#include "solvers/simulator/simulator.h"
#include "tests/solvers/contact_bodies.h"

/// Contacts in a step against closed forms and laws.
namespace taut::contact_test {
namespace {

constexpr double kG = 9.81;

using testing::rubbing;

BodyId add_box(World& world, const std::string& name, const Vec3& size, const Vec3& position,
               const Material& material = {}, double density = 1000) {
  const BodyId body = world.add_body(
      {.name = name, .mass = MassProperties::box(size, Density{density}), .pose = {.p = position}});
  world.add_shape(body, Box{size}, {}, material);
  return body;
}

BodyId add_ball(World& world, const std::string& name, double radius, const Vec3& position,
                const Material& material = {}, double mass = 1) {
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
  }
}

/// Coulomb's law for all contacts of the last step, in which normals turn by as much as this.
void expect_in_cones(const Simulator& simulator, double friction, double turn = 1e-3) {
  double largest = 0;
  for (const ContactReport& contact : simulator.contacts()) largest = std::max(largest, contact.normal_force);
  for (const ContactReport& contact : simulator.contacts()) {
    EXPECT_GE(contact.normal_force, -1e-8 * largest);
    const Vec3 tangent = contact.force - contact.normal_force * contact.contact.normal;
    EXPECT_LE(tangent.norm(), (friction + turn) * contact.normal_force + 1e-6 * largest);
  }
}

TEST(Contact, a_box_at_rest_stays_where_it_is_and_is_carried_by_its_weight) {
  World world;
  world.add_shape(kGround, HalfSpace{});
  const BodyId box = add_box(world, "box", Vec3(1, 1, 1), Vec3(0, 0, 0.5), {}, 10);
  Simulator simulator(world);
  run(simulator, 1e-3, 500);
  EXPECT_LE((world.pose(box).p - Vec3(0, 0, 0.5)).norm(), 1e-12);
  Vec3 force = Vec3::Zero();
  for (const ContactReport& contact : simulator.contacts()) force += contact.force;
  EXPECT_LE((force - Vec3(0, 0, 10 * kG)).norm(), 1e-8);
  EXPECT_EQ(simulator.report().contacts, 4);
  EXPECT_EQ(simulator.report().counts.factorizations, 0);  // the last impulses meet the laws
  EXPECT_EQ(simulator.report().counts.analyses, 0);
  EXPECT_EQ(simulator.report().counts.pivots, 0);
}

TEST(Contact, a_box_on_a_slope_sticks_below_the_friction_angle_and_slides_above_it) {
  const double slope = 20 * std::numbers::pi / 180;
  for (const double friction : {0.3, 0.5}) {  // tan 20° = 0.364
    World world;
    world.set_gravity(kG * Vec3(std::sin(slope), 0, -std::cos(slope)));
    world.add_shape(kGround, HalfSpace{}, {}, rubbing(friction));
    const BodyId box = add_box(world, "box", Vec3(1, 1, 0.2), Vec3(0, 0, 0.1), rubbing(friction));
    Simulator simulator(world);
    run(simulator, 1e-3, 1000);
    const double acceleration = std::max(
        0.0, kG * (std::sin(slope) - friction * std::cos(slope)));  // exact for RATTLE: constant force
    EXPECT_NEAR(world.pose(box).p.x(), 0.5 * acceleration, 1e-9) << friction;
    EXPECT_NEAR(world.pose(box).p.z(), 0.1, 1e-12) << friction;
  }
}

TEST(Contact, static_friction_holds_beyond_dynamic_friction) {
  // Held at 0.4 g of side force below 0.5; pushed free once, it goes on with 0.2.
  Material material;
  material.static_friction = 0.5;
  material.dynamic_friction = 0.2;
  for (const double start : {0.0, 1e-3}) {
    World world;
    world.set_gravity(kG * Vec3(0.4, 0, -1));
    world.add_shape(kGround, HalfSpace{}, {}, material);
    const BodyId box = add_box(world, "box", Vec3(1, 1, 0.2), Vec3(0, 0, 0.1), material);
    world.set_twist(box, {Vec3::Zero(), Vec3(start, 0, 0)});
    Simulator simulator(world);
    run(simulator, 1e-3, 500);
    const double t = 0.5, slid = start > 0 ? start * t + 0.5 * (0.4 - 0.2) * kG * t * t : 0;
    EXPECT_NEAR(world.pose(box).p.x(), slid, 1e-9);
  }
}

TEST(Contact, a_ball_bounces_by_its_restitution) {
  for (const double e : {1.0, 0.8, 0.5}) {
    Material material;
    material.restitution = e;
    World world;
    world.add_shape(kGround, HalfSpace{}, {}, material);
    const BodyId ball = add_ball(world, "ball", 0.1, Vec3(0, 0, 1.1), material);
    Simulator simulator(world);
    const double fall = std::sqrt(2 / kG);
    double apex = 0;
    while (world.time() < fall * (1 + 2 * e) - 0.01) {
      ASSERT_TRUE(simulator.step(1e-3).exact());
      if (world.time() > fall + 0.005) apex = std::max(apex, world.pose(ball).p.z() - 0.1);
    }
    // The apex lies between two samples: off by at most g/2 (dt/2)².
    EXPECT_NEAR(apex, e * e, 2e-6);
  }
}

TEST(Contact, bouncing_comes_to_rest) {
  Material material;
  material.restitution = 0.5;
  World world;
  world.add_shape(kGround, HalfSpace{}, {}, material);
  const BodyId ball = add_ball(world, "ball", 0.1, Vec3(0, 0, 0.6), material);
  Simulator simulator(world);
  run(simulator, 1.0 / 240, 480);  // the last bounce is at t = √(2·0.5/g) (1 + e)/(1 − e) = 0.96 s
  EXPECT_LE(world.twist(ball).v.norm(), 1e-9);
  EXPECT_NEAR(world.pose(ball).p.z(), 0.1, 1e-6);
}

TEST(Contact, a_sliding_ball_ends_rolling_at_five_sevenths_of_its_speed) {
  World world;
  world.add_shape(kGround, HalfSpace{}, {}, rubbing(0.2));
  const BodyId ball = add_ball(world, "ball", 0.1, Vec3(0, 0, 0.1), rubbing(0.2));
  world.set_twist(ball, {Vec3::Zero(), Vec3(5, 0, 0)});
  Simulator simulator(world);
  run(simulator, 1e-3, 1000);
  EXPECT_NEAR(world.twist(ball).v.x(), 25.0 / 7, 1e-9);
  EXPECT_NEAR(world.twist(ball).w.y() * 0.1, 25.0 / 7, 1e-9);
}

TEST(Contact, rolling_and_spinning_friction_stop_a_ball_after_their_closed_forms) {
  Material material = rubbing(0.8);
  material.rolling_friction = 0.002;
  material.spinning_friction = 0.001;
  const double R = 0.1, mass = 1, inertia = 0.4 * mass * R * R;
  World world;
  world.add_shape(kGround, HalfSpace{}, {}, material);
  const BodyId ball = add_ball(world, "ball", R, Vec3(0, 0, R), material, mass);
  world.set_twist(ball, {Vec3(0, 10, 5), Vec3(1, 0, 0)});
  Simulator simulator(world);
  run(simulator, 1e-3, 1000);
  // (m R² + I) α = −δ N for rolling, I α = −arm N for spinning.
  const double slowed = 0.002 * mass * kG / (mass * R * R + inertia) * R;
  EXPECT_NEAR(world.twist(ball).v.x(), 1 - slowed, 1e-7);
  EXPECT_NEAR(world.twist(ball).w.z(), 5 - 0.001 * mass * kG / inertia, 1e-7);
  run(simulator, 1e-3, 8000);
  EXPECT_LE(world.twist(ball).v.norm() + world.twist(ball).w.norm(), 1e-9);
}

TEST(Contact, every_box_of_a_stack_bears_what_is_above_it) {
  constexpr int kCount = 10;
  World world;
  world.add_shape(kGround, HalfSpace{});
  std::vector<BodyId> boxes;
  for (int i = 0; i < kCount; ++i)
    boxes.push_back(add_box(world, "box" + std::to_string(i), Vec3(1, 1, 1), Vec3(0, 0, 0.5 + i), {},
                            i == kCount - 1 ? 1000 : 1));  // top heavy, 1000 : 1
  Simulator simulator(world);
  run(simulator, 1.0 / 240, 300);
  std::vector<double> carried(kCount, 0.0);
  for (const ContactReport& contact : simulator.contacts()) {
    const int upper = std::max(contact.contact.A.index, contact.contact.B.index);
    for (int i = 0; i < kCount; ++i)
      if (boxes[i].index == upper) carried[i] += contact.normal_force;
  }
  for (int i = 0; i < kCount; ++i) {
    EXPECT_NEAR(carried[i], (1000 + kCount - 1 - i) * kG, 1e-7 * 1000 * kG) << i;
    EXPECT_LE((world.pose(boxes[i]).p - Vec3(0, 0, 0.5 + i)).norm(), 1e-9) << i;
  }
  EXPECT_EQ(simulator.report().counts.analyses, 0);
}

TEST(Contact, a_wall_stands) {
  World world;
  world.add_shape(kGround, HalfSpace{});
  std::vector<BodyId> bricks;
  std::vector<Vec3> slots;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) {
      slots.emplace_back(0.4 * column + 0.2 * (row % 2), 0, 0.1 + 0.2 * row);
      bricks.push_back(
          add_box(world, "brick" + std::to_string(bricks.size()), Vec3(0.4, 0.2, 0.2), slots.back()));
    }
  Simulator simulator(world);
  run(simulator, 1.0 / 240, 240);
  expect_in_cones(simulator, 0.5);
  for (std::size_t i = 0; i < bricks.size(); ++i)
    EXPECT_LE((world.pose(bricks[i]).p - slots[i]).norm(), 1e-6) << i;
}

TEST(Contact, a_thrown_box_loses_energy_until_it_rests) {
  World world;
  world.add_shape(kGround, HalfSpace{}, {}, rubbing(0.5));
  const BodyId box = add_box(world, "box", Vec3(0.4, 0.3, 0.2), Vec3(0, 0, 1), rubbing(0.5));
  world.set_twist(box, {Vec3(3, 2, 1), Vec3(2, 1, 0)});
  Simulator simulator(world);
  double energy = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 480; ++i) {
    const StepReport& report = simulator.step(1.0 / 240);
    ASSERT_TRUE(report.exact()) << i << ": " << report.message;
    // Free flight is integrated to second order.
    EXPECT_LE(report.energy(), energy + 1e-6 * std::abs(report.energy())) << i;
    energy = report.energy();
  }
  EXPECT_LE(world.twist(box).v.norm() + world.twist(box).w.norm(), 1e-9);
  EXPECT_LE(simulator.report().penetration, 1e-8);
}

TEST(Contact, momenta_are_kept_and_energy_does_not_grow_in_random_collisions) {
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto vector = [&](double size) {
    return Vec3(size * Vec3(uniform(generator), uniform(generator), uniform(generator)));
  };
  for (int trial = 0; trial < 20; ++trial) {
    Material material = rubbing(0.4);
    material.restitution = 0.5 + 0.5 * uniform(generator);
    World world;
    world.set_gravity(Vec3::Zero());
    const BodyId a = add_box(world, "a", Vec3(0.4, 0.3, 0.2), Vec3(-0.6, 0, 0) + vector(0.05), material);
    const BodyId b = add_ball(world, "b", 0.2, Vec3(0.6, 0, 0) + vector(0.05), material, 20);
    world.set_twist(a, {vector(2), Vec3(2, 0, 0)});
    world.set_twist(b, {vector(2), Vec3(-2, 0, 0)});
    const Vec3 momentum = linear_momentum(world, world.state());
    const Vec3 angular = angular_momentum(world, world.state());
    const double energy = kinetic_energy(world, world.state());
    Simulator simulator(world);
    run(simulator, 1.0 / 240, 120);
    const double size = momentum.norm() + 100;
    EXPECT_LE((linear_momentum(world, world.state()) - momentum).norm(), 1e-10 * size) << trial;
    EXPECT_LE((angular_momentum(world, world.state()) - angular).norm(), 1e-8 * size) << trial;
    EXPECT_LE(kinetic_energy(world, world.state()), energy * (1 + 1e-5)) << trial;
    EXPECT_LT(world.pose(a).p.x(), world.pose(b).p.x()) << "they passed through each other";
  }
}

TEST(Contact, joints_stay_closed_while_a_chain_falls_on_the_floor) {
  World world;
  world.add_shape(kGround, HalfSpace{}, {}, rubbing(0.4));
  BodyId last{};
  for (int i = 0; i < 6; ++i) {
    const BodyId link =
        world.add_body({.name = "link" + std::to_string(i),
                        .mass = MassProperties::capsule(0.05, 0.4, Density{1000}),
                        .pose = {.q = Quat(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitY())),
                                 .p = Vec3(0.5 * i, 0, 0.5)}});
    world.add_shape(link, Capsule{0.05, 0.4}, {}, rubbing(0.4));
    if (i > 0)
      world.add("joint" + std::to_string(i), Ball::at(world, last, link, Vec3(0.5 * i - 0.25, 0, 0.5)));
    last = link;
  }
  world.set_twist(last, {Vec3(0, 0, 4), Vec3::Zero()});
  Simulator simulator(world);
  for (int i = 0; i < 360; ++i) {
    const StepReport& report = simulator.step(1.0 / 240);
    ASSERT_TRUE(report.exact()) << i << ": " << report.message;
    EXPECT_LE(report.gap.metres, 1e-9) << i;
  }
}

TEST(Contact, mixed_shapes_fall_in_a_heap_within_the_laws) {
  World world;
  const Material material = rubbing(0.5);
  world.add_shape(kGround, HalfSpace{}, {}, material);
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 8; ++i) {
    const Vec3 slot(0.6 * (i % 2) + 0.03 * uniform(generator), 0.6 * (i / 2 % 2) + 0.03 * uniform(generator),
                    0.4 + 0.6 * i);
    const double density = 1000;
    const int kind = i % 4;
    const MassProperties mass = kind == 0   ? MassProperties::sphere(0.2, Density{density})
                                : kind == 1 ? MassProperties::box(Vec3(0.4, 0.3, 0.2), Density{density})
                                : kind == 2 ? MassProperties::capsule(0.1, 0.3, Density{density})
                                            : MassProperties::cylinder(0.15, 0.3, Density{density});
    const Shape shape = kind == 0   ? Shape(Sphere{0.2})
                        : kind == 1 ? Shape(Box{Vec3(0.4, 0.3, 0.2)})
                        : kind == 2 ? Shape(Capsule{0.1, 0.3})
                                    : Shape(Cylinder{0.15, 0.3});
    const Quat turn =
        Quat(uniform(generator), uniform(generator), uniform(generator), uniform(generator)).normalized();
    const BodyId body =
        world.add_body({.name = "body" + std::to_string(i), .mass = mass, .pose = {.q = turn, .p = slot}});
    world.add_shape(body, shape, {}, material);
  }
  Simulator simulator(world);
  for (int i = 0; i < 480; ++i) {
    const StepReport& report = simulator.step(1.0 / 240);
    ASSERT_TRUE(report.exact()) << i << ": " << report.message;
    ASSERT_LE(report.natural_residual, 1e-8) << i;
    double fastest = 0;
    for (const Twist& V : world.state().twists) fastest = std::max(fastest, V.w.norm());
    if (i % 20 == 0) expect_in_cones(simulator, 0.5, 1e-3 + 2 * fastest / 240);
  }
  EXPECT_LE(simulator.report().penetration, 1e-5);
}

TEST(Contact, bodies_pass_through_each_other_if_contacts_are_off) {
  World world;
  world.add_shape(kGround, HalfSpace{});
  const BodyId ball = add_ball(world, "ball", 0.1, Vec3(0, 0, 0.1));
  Settings settings;
  settings.contacts = false;
  Simulator simulator(world, settings);
  run(simulator, 1e-2, 100);
  EXPECT_NEAR(world.pose(ball).p.z(), 0.1 - 0.5 * kG, 1e-9);
}

TEST(Contact, integrators_and_materials_that_cannot_do_it_are_refused) {
  World world;
  world.add_shape(kGround, HalfSpace{});
  add_ball(world, "ball", 0.1, Vec3(0, 0, 0.1));
  Settings settings;
  settings.integrator = Integrator::kRattle4;
  Simulator simulator(world, settings);
  EXPECT_THROW((void)simulator.step(1e-3), std::invalid_argument);
}

/// Its contacts give nothing any more, though at rest the last impulses would balance.
// Rigid or as stiff as stone: no faster than 1 m/s, and without a speed that they would keep.
TEST(Contact, bodies_that_start_in_each_other_part_slowly) {
  constexpr double kStep = 1.0 / 240, kRadius = 0.1;
  for (const double compliance : {0.0, 1e-9}) {
    World world;
    world.set_gravity(Vec3::Zero());
    Material material;
    material.compliance = compliance;
    for (int i = 0; i < 20; ++i) add_ball(world, "", kRadius, Vec3(0, 0, 0), material);
    add_box(world, "", Vec3(1, 1, 1), Vec3(50, 0, 0), material);
    add_box(world, "", Vec3(1, 1, 1), Vec3(50.2, 0.1, 0.3), material);
    Simulator simulator(world);
    double penetration = 0;
    for (int i = 0; i < 240; ++i) {
      const State before = world.state();
      run(simulator, kStep, 1);
      penetration = std::max(penetration, simulator.report().penetration);
      for (int b = 1; b < world.body_count(); ++b)
        // Of 1 m/s between the kicks what normals that turn leave, step by step.
        ASSERT_LE(world.twist(BodyId{b}).v.norm(), 0.5) << compliance << " step " << i;
      const auto gap = [&](const State& state) {
        return (state.poses[world.body_count() - 1].p - state.poses[world.body_count() - 2].p).norm();
      };
      ASSERT_LE(gap(world.state()) - gap(before), kStep * 1.001);
    }
    EXPECT_GT(penetration, 0.19);
    EXPECT_LT(simulator.report().penetration, 1e-9);
  }
}

TEST(Contact, bodies_that_may_no_longer_collide_fall) {
  World world;
  const BodyId table = world.add_body({.pose = {Quat::Identity(), {0, 0, -0.5}}, .fixed = true});
  const BodyId box =
      world.add_body({.mass = MassProperties::box({1, 1, 1}, 3), .pose = {Quat::Identity(), {0, 0, 0.5}}});
  world.add_shape(table, Box{{10, 10, 1}});
  world.add_shape(box, Box{{1, 1, 1}});
  Simulator simulator(world);
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(simulator.step(0.005).exact());
  EXPECT_NEAR(world.pose(box).p.z(), 0.5, 1e-9);
  world.set_collision(box, table, false);
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(simulator.step(0.005).exact());
  // The change counts from the end of the first step on: half of its fall is missing.
  EXPECT_NEAR(world.twist(box).v.z(), -9.81 * 0.0475, 1e-9);
}

}  // namespace
}  // namespace taut::contact_test
