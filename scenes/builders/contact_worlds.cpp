#include "scenes/builders/contact_worlds.h"

#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include "core/joints/joints.h"
#include "core/math/so3.h"
#include "core/state/force.h"

namespace taut::contact_worlds {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// Six planes with free space inside ±half.
void add_six_walls(World& world, double half, const Material& m) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const Vec3 inward = -side * Vec3::Unit(axis);
      world.add_shape(kGround, HalfSpace{},
                      {.q = rotation_between(Vec3::UnitZ(), inward), .p = side * half * Vec3::Unit(axis)}, m);
    }
}

World floor_of(const Material& material) {
  World world;
  world.add_shape(kGround, HalfSpace{}, {}, material);
  return world;
}

World without_weight() {
  World world;
  world.set_gravity(Vec3::Zero());
  return world;
}

}  // namespace

Material rubbing(double friction, double restitution) {
  Material material;
  material.static_friction = material.dynamic_friction = friction;
  material.restitution = restitution;
  return material;
}

BodyId add_solid(World& world, const Shape& shape, MassProperties mass, const Pose& pose, const Twist& twist,
                 const Material& material) {
  const BodyId body = world.add_body({.name = std::string("b").append(std::to_string(world.body_count())),
                                      .mass = std::move(mass),
                                      .pose = pose,
                                      .twist = twist});
  world.add_shape(body, shape, {}, material);
  return body;
}

BodyId add_ball(World& world, double radius, const Vec3& p, const Twist& twist, const Material& material) {
  return add_solid(world, Sphere{radius}, MassProperties::sphere(radius, 1), {.p = p}, twist, material);
}

BodyId add_box(World& world, const Vec3& size, const Pose& pose, const Twist& twist,
               const Material& material) {
  return add_solid(world, Box{size}, MassProperties::box(size, 1), pose, twist, material);
}

Quat random_turn(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const double w = normal(random), x = normal(random), y = normal(random), z = normal(random);
  return Quat(w, x, y, z).normalized();
}

Vec3 random_vector(std::mt19937& random, double most) {
  std::uniform_real_distribution<double> uniform(-most, most);
  const double x = uniform(random), y = uniform(random), z = uniform(random);
  return {x, y, z};
}

World tumbling_box() {
  World world = floor_of(rubbing(0, 1));
  add_box(world, {0.3, 0.2, 0.1}, {.q = Quat(0.9, 0.3, -0.2, 0.25).normalized(), .p = {0, 0, 1}},
          {.w = {2, 1, -3}, .v = {0.3, 0, 0}}, rubbing(0, 1));
  return world;
}

World gas(bool boxes) {
  std::mt19937 random(7);
  World world = without_weight();
  add_six_walls(world, 0.5, rubbing(0, 1));
  for (int i = 0; i < 27; ++i) {
    const int column = i % 3, row = i / 3 % 3, layer = i / 9;
    const Vec3 p = 0.3 * Vec3(column - 1, row - 1, layer - 1);
    const Quat q = random_turn(random);
    const Vec3 w = random_vector(random, 5), v = random_vector(random, 1.5);
    if (boxes)
      add_box(world, {0.12, 0.09, 0.07}, {.q = q, .p = p}, {.w = w, .v = v}, rubbing(0, 1));
    else
      add_ball(world, 0.07, p, {.w = w, .v = v}, rubbing(0, 1));
  }
  return world;
}

World two_balls() {
  World world = without_weight();
  add_ball(world, 0.1, {-0.5, 0.19, 0}, {.w = Vec3::Zero(), .v = {3, 0, 0}}, rubbing(0, 1));
  add_ball(world, 0.1, Vec3::Zero(), {.w = Vec3::Zero(), .v = Vec3::Zero()}, rubbing(0, 1));
  return world;
}

World ball_break() {
  World world = without_weight();
  const double r = 0.0286;
  for (int row = 0; row < 5; ++row)
    for (int k = 0; k <= row; ++k)
      add_ball(world, r, {row * r * std::sqrt(3.0), (2 * k - row) * r, 0}, {Vec3::Zero(), Vec3::Zero()},
               rubbing(0, 1));
  add_ball(world, r, {-0.5, 0.003, 0}, {.w = Vec3::Zero(), .v = {5, 0, 0}}, rubbing(0, 1));
  return world;
}

World cradle(double gap) {
  World world = without_weight();
  const double r = 0.1;
  for (int i = 0; i < 5; ++i)
    add_ball(world, r, {i * (2 * r + gap) - (i == 0 ? 0.1 : 0), 0, 0},
             {.w = Vec3::Zero(), .v = {i == 0 ? 2.0 : 0.0, 0, 0}}, rubbing(0, 1));
  return world;
}

World oblique_ball(const Oblique& ball, double restitution, double friction) {
  World world = floor_of(rubbing(friction, restitution));
  world.set_gravity(Vec3::Zero());
  add_ball(world, ball.radius, {0, 0, ball.radius + ball.height},
           {.w = {0, ball.spin, 0}, .v = {ball.speed_x, 0, ball.speed_z}}, rubbing(friction, restitution));
  return world;
}

World thrown_box(std::mt19937& random, bool slender, double restitution, double friction) {
  World world = floor_of(rubbing(friction, restitution));
  const Vec3 size = slender ? Vec3(0.8, 0.02, 0.02) : Vec3(0.3, 0.2, 0.1);
  const Quat q = random_turn(random);
  const Vec3 w = random_vector(random, 6), v = random_vector(random, 3);
  add_box(world, size, {.q = q, .p = {0, 0, 0.6}}, {.w = w, .v = v - Vec3(0, 0, 2)},
          rubbing(friction, restitution));
  return world;
}

World ball_on_dome(double angle, double rate) {
  World world;
  world.add_shape(kGround, Sphere{1}, {}, rubbing(0));
  const double s = std::sin(angle), c = std::cos(angle);
  add_ball(world, 0.1, kDomeReach * Vec3(s, 0, c),
           {.w = Vec3::Zero(), .v = kDomeReach * rate * Vec3(c, 0, -s)}, rubbing(0));
  return world;
}

World ball_in_bowl(int planes, double turn) {
  World world = without_weight();
  const double bowl = 1.1, r = 0.1;
  for (int i = 0; i < planes; ++i) {
    const Quat q(Eigen::AngleAxisd(-i * turn, Vec3::UnitY()));
    world.add_shape(kGround, HalfSpace{}, {.q = q, .p = q * Vec3(0, 0, -bowl)}, rubbing(0));
  }
  add_ball(world, r, {0, 0, r - bowl}, {.w = Vec3::Zero(), .v = {1, 0, 0}}, rubbing(0));
  return world;
}

World rolling_disc() {
  World world = floor_of(rubbing(3));
  const double lean = 70 * kDegree, r = kDiscRadius, half = kDiscHalf;
  const Quat q(Eigen::AngleAxisd(-lean, Vec3::UnitX()));
  const double z = r * std::sin(lean) + half * std::cos(lean);
  const Vec3 w(0, 8.5, 4.3), arm(0, half * std::sin(lean) - r * std::cos(lean), z);
  add_solid(world, Cylinder{r, 2 * half}, MassProperties::cylinder(r, 2 * half, 1.5),
            {.q = q, .p = {0, 0, z}}, {.w = w, .v = w.cross(arm)}, rubbing(3));
  return world;
}

World roly_poly() {
  World world = floor_of(rubbing(2));
  const Quat q(Eigen::AngleAxisd(0.5, Vec3::UnitX()));
  const Vec3 centre = q * Vec3(0, 0, kRolyRise), contact = centre - Vec3(0, 0, kRolyRadius), w(0, 0, 1);
  const BodyId roly = world.add_body({.name = "roly-poly",
                                      .mass = MassProperties(1, Vec3(3e-3, 3e-3, 2.5e-3)),
                                      .pose = {.q = q, .p = {0, 0, -contact.z()}},
                                      .twist = {.w = w, .v = -w.cross(contact)}});
  world.add_shape(roly, Sphere{kRolyRadius}, {.p = {0, 0, kRolyRise}}, rubbing(2));
  return world;
}

World rattleback() {
  World world = floor_of(rubbing(1));
  const Quat q(Eigen::AngleAxisd(0.5 * kDegree, Vec3::UnitX()));
  const Vec3 n = q.conjugate() * Vec3::UnitZ(), square = rattleback_radii().cwiseAbs2();
  const Vec3 centre(0, 0, kRattlebackRise);
  const Vec3 contact = centre - square.cwiseProduct(n) / std::sqrt(square.cwiseProduct(n).dot(n));
  const Vec3 w(0, 0, -5);
  Mat3 inertia = Vec3(2e-4, 1.6e-3, 1.7e-3).asDiagonal();
  inertia(0, 1) = inertia(1, 0) = -2e-5;
  const BodyId celt = world.add_body({.name = "celt",
                                      .mass = MassProperties(1.0, inertia),
                                      .pose = {.q = q, .p = {0, 0, -n.dot(contact)}},
                                      .twist = {.w = w, .v = -w.cross(q * contact)}});
  world.add_shape(celt, Ellipsoid{rattleback_radii()}, {.p = centre}, rubbing(1));
  return world;
}

World euler_disc(double lean, double rolling_length) {
  Material material = rubbing(1);
  material.rolling_friction = rolling_length;
  World world = floor_of(material);
  const double r = kEulerRadius, half = kEulerHalf, g = world.gravity().norm();
  const Quat q(Eigen::AngleAxisd(lean, Vec3::UnitY()));
  const Vec3 contact = q * Vec3(r, 0, -half);  // the axis leans towards x, and the lowest point is there
  // A thin disc whose centre rests turns about the diameter to the contact, and this runs round at
  // Ω = 2 √(g/(r sin α)).
  const Vec3 w = -2 * std::sqrt(g / (r * std::sin(lean))) * std::sin(lean) * (q * Vec3::UnitX());
  add_solid(world, Cylinder{r, 2 * half}, MassProperties::cylinder(r, 2 * half, 0.5),
            {.q = q, .p = {0, 0, -contact.z()}}, {.w = w, .v = -w.cross(contact)}, material);
  return world;
}

World sliding_rod(const Rod& rod, double restitution, double friction) {
  const Material material = rubbing(friction, restitution);
  World world = floor_of(material);
  const double cap = 0.005, length = 0.99;
  const double z = 0.5 * length * std::sin(rod.angle) + cap + rod.height;
  const BodyId body = world.add_body({.name = "rod",
                                      .mass = MassProperties::box({1, 0.01, 0.01}, 1),
                                      .pose = {.q = exp_so3(Vec3(0, -rod.angle, 0)), .p = {0, 0, z}},
                                      .twist = {.w = {0, rod.spin, 0}, .v = {rod.speed_x, 0, rod.speed_z}}});
  world.add_shape(body, Capsule{cap, length}, {.q = exp_so3(Vec3(0, 0.5 * std::numbers::pi, 0))}, material);
  return world;
}

Belt box_on_belt() {
  Belt out;
  const double mass = 2, speed = 0.2, stiffness = 400;
  const Material material{.static_friction = 0.5, .dynamic_friction = 0.3};
  const Twist twist{.w = Vec3::Zero(), .v = {speed, 0, 0}};
  const Vec3 size(8, 1, 0.2), small(0.2, 0.2, 0.1);
  out.belt =
      add_solid(out.world, Box{size}, MassProperties::box(size, 20), {.p = {0, 0, -0.1}}, twist, material);
  out.box = add_solid(out.world, Box{small}, MassProperties::box(small, mass), {.p = {0, 0, 0.05}}, twist,
                      material);
  const JointId slide =
      out.world.add("slide", Slider::at(out.world, kGround, out.belt, Vec3(0, 0, -0.1), Vec3::UnitX()));
  out.world.add("drive", Driver(out.world, out.world.axis(slide, "displacement"), linear_motion(0, speed)));
  out.world.add_force(SpringDamper(kGround, out.box, Vec3(-50, 0, 0.05), Vec3::Zero(), stiffness, 50, 0));
  out.limit = material.static_friction * mass * out.world.gravity().norm();
  out.rate = stiffness * speed;
  return out;
}

World dominoes(int n) {
  World world = floor_of(rubbing(0.3));
  const Vec3 size(0.012, 0.04, 0.08);
  for (int i = 0; i < n; ++i) {
    // The first turns about its lower edge.
    const Vec3 w(0, i == 0 ? 3 : 0, 0), edge(0.5 * size.x(), 0, -0.5 * size.z());
    add_solid(world, Box{size}, MassProperties::box(size, Density{1000}),
              {.p = {i * kDominoPitch, 0, 0.5 * size.z()}}, {.w = w, .v = -w.cross(edge)}, rubbing(0.3));
  }
  return world;
}

}  // namespace taut::contact_worlds
