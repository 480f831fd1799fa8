#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/joints/joints.h"
#include "solvers/simulator/simulator.h"

/// Compliant contacts in a step against closed forms.
namespace taut::contact_compliance_test {
namespace {

constexpr double kG = 9.81;

Material soft(double compliance, double restitution = 0, double friction = 0.5) {
  Material material;
  material.compliance = compliance;
  material.restitution = restitution;
  material.static_friction = material.dynamic_friction = friction;
  return material;
}

BodyId add_ball(World& world, const std::string& name, double radius, double height, double mass,
                const Material& material) {
  const BodyId body = world.add_body(
      {.name = name, .mass = MassProperties::sphere(radius, mass), .pose = {.p = Vec3(0, 0, height)}});
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

TEST(ContactCompliance, bodies_at_rest_sink_by_compliance_times_force_whatever_their_masses) {
  const double C1 = 1e-9, C2 = 3e-9, light = 1, heavy = 1000, radius = 0.5;
  World world;
  world.add_shape(kGround, HalfSpace{}, {}, soft(C1));
  const BodyId lower = add_ball(world, "lower", radius, radius, light, soft(C2));
  const BodyId upper = add_ball(world, "upper", radius, 3 * radius, heavy, soft(C1));
  Simulator simulator(world);
  run(simulator, 1e-3, 2500);
  // Springs of both materials in series; the weight of all above.  Dampers are critical for the pair of
  // bodies that touch, little for the heavy one on all: it needs its time.
  const double first = (C1 + C2) * (light + heavy) * kG, second = (C2 + C1) * heavy * kG;
  EXPECT_NEAR(radius - world.pose(lower).p.z(), first, 1e-11);
  EXPECT_NEAR(3 * radius - world.pose(upper).p.z(), first + second, 1e-11);
  EXPECT_LE(world.twist(upper).v.norm(), 1e-9);
}

// A step of 1/240 s does not see the spring, ω h = 13: the gap says nothing of a velocity that turns round in
// each step, and what is left of it would wake its neighbours.
TEST(ContactCompliance, an_unresolved_contact_comes_to_rest) {
  const double C = 1e-7;
  World world;
  world.add_shape(kGround, HalfSpace{}, {}, soft(C));
  const BodyId ball = add_ball(world, "ball", 0.5, 0.5 - C * kG, 1, soft(0));
  world.set_twist(ball, {Vec3::Zero(), Vec3(0, 0, 1e-3)});
  Simulator simulator(world);
  run(simulator, 1.0 / 240, 12);
  EXPECT_LE(world.twist(ball).v.norm(), 1e-9);
  EXPECT_NEAR(0.5 - world.pose(ball).p.z(), C * kG, 1e-11);
}

TEST(ContactCompliance, a_box_shares_its_weight_among_its_corners) {
  World world;
  world.add_shape(kGround, HalfSpace{}, {}, soft(2e-5));
  const BodyId box = world.add_body(
      {.name = "box", .mass = MassProperties::box(Vec3(1, 1, 1), 8), .pose = {.p = Vec3(0, 0, 0.5)}});
  world.add_shape(box, Box{Vec3(1, 1, 1)}, {}, soft(0));
  Simulator simulator(world);
  run(simulator, 1e-3, 600);
  EXPECT_NEAR(0.5 - world.pose(box).p.z(), 2e-5 * 8 * kG / 4, 1e-11);
  for (const ContactReport& contact : simulator.contacts()) EXPECT_NEAR(contact.normal_force, 2 * kG, 1e-5);
}

// With e = 1 the midpoint rule: period (π h)/atan(ω h/2) of the discrete equations, which is 2π√(m C) but for
// (ω h)²/12, and no loss.
TEST(ContactCompliance, an_elastic_contact_oscillates_with_the_period_of_its_spring) {
  const double C = 1e-4, mass = 4, h = 1e-3, omega = 1 / std::sqrt(mass * C), sunk = C * mass * kG;
  World world;
  world.add_shape(kGround, HalfSpace{}, {}, soft(C, 1));
  const BodyId ball = add_ball(world, "ball", 0.1, 0.1 - 0.5 * sunk, mass, soft(0, 1));
  Simulator simulator(world);
  double last = 0.5 * sunk, first_time = 0, time = 0, highest = 0;
  int crossings = 0;
  for (int i = 1; crossings < 41; ++i) {
    ASSERT_TRUE(simulator.step(h).exact());
    const double z = world.pose(ball).p.z() - (0.1 - sunk);
    highest = i > 1000 ? std::max(highest, z) : 0;
    if (z * last < 0) {
      time = h * (i - z / (z - last));
      if (crossings++ == 0) first_time = time;
    }
    last = z;
  }
  const double period = (time - first_time) / 20;
  // Crossings are found by straight lines: (ω h)³/2 of an amplitude, over 20 periods.
  EXPECT_NEAR(period, std::numbers::pi * h / std::atan(0.5 * omega * h), 2e-7);
  EXPECT_NEAR(period, 2 * std::numbers::pi * std::sqrt(mass * C), (omega * h) * (omega * h) / 10 * period);
  EXPECT_NEAR(highest, 0.5 * sunk, 2e-3 * sunk);  // sampled: (ω h)²/8 below the top
}

// Free of weight: what comes back, for contacts that the step resolves and for such as are over in it.
TEST(ContactCompliance, impacts_give_back_their_restitution) {
  struct Case {
    double compliance, restitution, expected, tolerance;
  };
  // Resolved (ω h = 0.01): errors of order ω h.  Critical damping is the most: e⁻².  Not resolved
  // (ω h = 1000): Newton's law but for 1/(ω h).
  for (const Case& c :
       {Case{1e-2, 1, 1, 1e-2}, Case{1e-2, 0.5, 0.5, 1e-2}, Case{1e-2, 0.2, 0.2, 1e-2},
        Case{1e-2, 0, std::exp(-2), 1e-2}, Case{1e-12, 0.5, 0.5, 2e-3}, Case{1e-12, 0, 0, 2e-3}}) {
    World world;
    world.set_gravity(Vec3::Zero());
    world.add_shape(kGround, HalfSpace{}, {}, soft(c.compliance, c.restitution));
    const BodyId ball = add_ball(world, "ball", 0.1, 0.1015, 1, soft(0, c.restitution));
    world.set_twist(ball, {Vec3::Zero(), Vec3(0, 0, -1)});
    Simulator simulator(world);
    double energy = 0.5;
    for (int i = 0; i < 600; ++i) {
      run(simulator, 1e-3, 1);
      const double gap = world.pose(ball).p.z() - 0.1, v = world.twist(ball).v.z();
      const double now = 0.5 * v * v + (gap < 0 ? 0.5 * gap * gap / c.compliance : 0);
      // 1e-9 of the momentum is what an impulse may be off.
      EXPECT_LE(now, energy + 1e-8) << c.compliance << " " << c.restitution << " step " << i;
      energy = now;
    }
    EXPECT_NEAR(world.twist(ball).v.z(), c.expected, c.tolerance) << c.compliance << " " << c.restitution;
  }
}

TEST(ContactCompliance, friction_stretches_its_spring_and_holds_without_creep) {
  const double C = 1e-5, mass = 2, slope = 20 * std::numbers::pi / 180;
  World world;
  world.set_gravity(kG * Vec3(std::sin(slope), 0, -std::cos(slope)));
  world.add_shape(kGround, HalfSpace{}, {}, soft(C));
  const Vec3 size(0.4, 0.4, 0.1);
  const BodyId box = world.add_body(
      {.name = "box", .mass = MassProperties::box(size, mass), .pose = {.p = Vec3(0, 0, 0.05)}});
  world.add_shape(box, Box{size}, {}, soft(0));
  Simulator simulator(world);
  run(simulator, 1e-3, 1000);
  const Vec3 before = world.pose(box).p;
  // Four springs side by side; the box tilts by what its forces below the centre turn it, to second order.
  EXPECT_NEAR(before.z(), 0.05 - C * mass * kG * std::cos(slope) / 4, 1e-8);
  run(simulator, 1e-3, 1000);
  EXPECT_LE((world.pose(box).p - before).norm(), 1e-10);
  Vec3 force = Vec3::Zero();
  for (const ContactReport& contact : simulator.contacts()) force += contact.force;
  EXPECT_LE((force + mass * world.gravity()).norm(), 1e-6);
}

// On a slope friction is all in the springs across the normals: at the same state without them the box starts
// to slide.  A second body that is welded to it makes them those of merged bodies.
TEST(ContactCompliance, what_is_put_back_with_its_stretches_goes_on_standing) {
  const double C = 1e-5, mass = 2, slope = 20 * std::numbers::pi / 180;
  const Vec3 size(0.4, 0.4, 0.1);
  World world;
  world.set_gravity(kG * Vec3(std::sin(slope), 0, -std::cos(slope)));
  world.add_shape(kGround, HalfSpace{}, {}, soft(C));
  const auto add_plate = [&](const std::string& name, double x) {
    const BodyId plate = world.add_body(
        {.name = name, .mass = MassProperties::box(size, mass), .pose = {.p = Vec3(x, 0, 0.05)}});
    world.add_shape(plate, Box{size}, {}, soft(0));
    return plate;
  };
  const BodyId box = add_plate("box", 0), first = add_plate("first", 2), second = add_plate("second", 2.4);
  world.add("weld", Fixed::at(world, first, second, Vec3(2.2, 0, 0.05)));
  const std::vector<BodyId> bodies{box, first, second};
  Simulator simulator(world);
  EXPECT_TRUE(simulator.contact_stretches().empty());
  run(simulator, 1e-3, 1500);
  const std::vector<ContactStretch> stretches = simulator.contact_stretches();
  Vec3 friction = Vec3::Zero();
  for (const ContactStretch& s : stretches) {
    EXPECT_TRUE(s.holds);
    friction -= s.stretch / C;
  }
  EXPECT_NEAR(friction.x(), -3 * mass * kG * std::sin(slope), 1e-6);
  EXPECT_NEAR(friction.y(), 0, 1e-6);

  const auto fastest_after = [&](Simulator& again, int steps) {
    double fastest = 0;
    for (int i = 0; i < steps; ++i) {
      run(again, 1e-3, 1);
      for (BodyId body : bodies) fastest = std::max(fastest, again.world().twist(body).v.norm());
    }
    return fastest;
  };
  const State state = world.state();
  World with = world, without = world;
  Simulator knows(with), forgets(without);
  knows.set_contact_stretches(stretches);
  EXPECT_EQ(knows.contact_stretches().size(), stretches.size());  // also before it has started
  EXPECT_LT(fastest_after(knows, 20), 1e-9);
  EXPECT_GT(fastest_after(forgets, 20), 1e-3);

  // Rigid ones have no spring that could pull.
  World rigid = world;
  for (int i = 0; i < rigid.shape_count(); ++i) rigid.set_material(ShapeId{i}, soft(0));
  World pulled = rigid;
  Simulator rests(rigid), pulls(pulled);
  pulls.set_contact_stretches(stretches);
  EXPECT_EQ(fastest_after(pulls, 3), fastest_after(rests, 3));

  // The same simulator, elsewhere meanwhile.
  world.set_twist(box, {Vec3::Zero(), Vec3(0, 1, 0)});
  world.set_twist(second, {Vec3::Zero(), Vec3(0, 1, 0)});
  run(simulator, 1e-3, 100);
  world.set_state(state);
  simulator.set_contact_stretches(stretches);
  EXPECT_LT(fastest_after(simulator, 20), 1e-9);

  EXPECT_THROW(simulator.set_contact_stretches({{ShapeId{0}, ShapeId{9}}}), std::invalid_argument);
  EXPECT_THROW(simulator.set_contact_stretches({{ShapeId{0}, ShapeId{1}, Vec3(0, NAN, 0)}}),
               std::invalid_argument);
}

TEST(ContactCompliance, what_slides_is_slowed_by_friction) {
  const double mu = 0.3, v0 = 2, mass = 2;
  World world;
  world.add_shape(kGround, HalfSpace{}, {}, soft(1e-6, 0, mu));
  const Vec3 size(0.4, 0.4, 0.1);
  const BodyId box = world.add_body({.name = "box",
                                     .mass = MassProperties::box(size, mass),
                                     .pose = {.p = Vec3(0, 0, 0.05 - 1e-6 * mass * kG / 4)}});
  world.add_shape(box, Box{size}, {}, soft(0, 0, mu));
  world.set_twist(box, {Vec3::Zero(), Vec3(v0, 0, 0)});
  Simulator simulator(world);
  run(simulator, 1e-3, 300);
  EXPECT_NEAR(world.twist(box).v.x(), v0 - mu * kG * 0.3, 2e-3);  // a ripple as it begins to pitch
  run(simulator, 1e-3, 700);                                      // it stops after 0.68 s
  EXPECT_NEAR(world.pose(box).p.x(), v0 * v0 / (2 * mu * kG), 2e-3);
  EXPECT_LE(world.twist(box).v.norm(), 1e-6);
}

TEST(ContactCompliance, iterative_solvers_sink_as_far) {
  for (const Solver solver : {Solver::kGaussSeidel, Solver::kPairwise}) {
    World world;
    world.add_shape(kGround, HalfSpace{}, {}, soft(1e-5));
    const BodyId ball = add_ball(world, "ball", 0.1, 0.1, 3, soft(0));
    Settings settings;
    settings.solver = solver;
    Simulator simulator(world, settings);
    for (int i = 0; i < 600; ++i) ASSERT_TRUE(simulator.step(1e-3).exact());
    EXPECT_NEAR(0.1 - world.pose(ball).p.z(), 1e-5 * 3 * kG, 1e-9);
  }
}

// Static friction of a hinge lets go also where contacts are compliant.
TEST(ContactCompliance, friction_of_joints_breaks_away_beside_it) {
  World world;
  world.add_shape(kGround, HalfSpace{}, {}, soft(1e-6));
  add_ball(world, "ball", 0.1, 0.1, 1, soft(0));
  const BodyId bob =
      world.add_body({.name = "bob", .mass = MassProperties::sphere(0.05, 1), .pose = {.p = Vec3(1, 0, 2)}});
  const JointId hinge = world.add("hinge", Hinge::at(world, kGround, bob, Vec3(0, 0, 2), Vec3::UnitY()));
  AxisFriction friction;
  friction.static_friction = 5;  // below the 9.81 N·m of its weight
  friction.dynamic_friction = 1;
  world.set_friction(world.axis(hinge, "angle"), friction);
  Simulator simulator(world);
  run(simulator, 1e-3, 100);
  // ω = (m g l − τ) t / I with I = m l² + 2/5 m r², while the arm has hardly turned.
  EXPECT_NEAR(world.twist(bob).w.norm(), (kG - 1) * 0.1 / 1.001, 2e-3);
}

}  // namespace
}  // namespace taut::contact_compliance_test
