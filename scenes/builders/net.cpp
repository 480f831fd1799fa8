#include "scenes/builders/net.h"

#include <cmath>
#include <numbers>

#include "core/joints/ball.h"
#include "scenes/builders/drawing.h"
#include "scenes/builders/scene_parts.h"

namespace taut {
namespace {

using namespace scene_parts;

constexpr double kNetArc = 0.4;  ///< θ: half the angle of the arc [rad]
constexpr double kHalfRod = NetRods::kHalf;

/// The start surface.  A flat net pinned at the full distance of its corners would be a singular start, so
/// the nodes lie on a translation surface of arcs, which keeps every rod at exactly 0.1 m:
///   a(k) = R sin φ(k),  h(k) = R (cos θ − cos φ(k)),  φ(k) = θ (2k/(n−1) − 1)
struct Surface {
  Surface(int nodes, bool flag_shape)
      : n(nodes), flag(flag_shape), radius(kHalfRod / std::sin(kNetArc / (nodes - 1))) {}
  double angle(double k) const { return kNetArc * (2 * k / (n - 1) - 1); }
  double along(int k) const { return radius * std::sin(angle(k)); }
  double height(int k) const { return radius * (std::cos(kNetArc) - std::cos(angle(k))); }
  Vec3 node(int i, int j) const {
    if (flag) return {along(i), 2 * kHalfRod * j, height(i)};
    return {along(i), along(j), height(i) + height(j)};
  }
  Pose x_rod(int i, int j) const {
    Pose pose;
    pose.p = (node(i, j) + node(i + 1, j)) / 2;
    pose.q = exp_so3(Vec3(0, -angle(i + 0.5), 0));
    return pose;
  }
  Pose y_rod(int i, int j) const {
    Pose pose;
    pose.p = (node(i, j) + node(i, j + 1)) / 2;
    pose.q = exp_so3(Vec3(flag ? 0 : angle(j + 0.5), 0, 0)) * exp_so3(Vec3(0, 0, std::numbers::pi / 2));
    return pose;
  }
  bool pinned(int i, int j) const { return (i == 0 || i == n - 1) && (flag ? j == 0 : j == 0 || j == n - 1); }
  int n;
  bool flag;
  double radius;
};

void add_rods(Scene& scene, const Surface& surface) {
  World& world = scene.world;
  const MassProperties rod = thin_rod(2 * kHalfRod, 0.1);
  const int n = surface.n;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n - 1; ++i)
      world.add_body({.name = numbered("rod_x", i, j), .mass = rod, .pose = surface.x_rod(i, j)});
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n - 1; ++j)
      world.add_body({.name = numbered("rod_y", i, j), .mass = rod, .pose = surface.y_rod(i, j)});
  for (int b = 1; b < world.body_count(); ++b) draw(scene, BodyId{b}, rod_shape(2 * kHalfRod, kRodRadius));
}

/// A ball joint whose turns about the axes of A rub with this torque, if there is any.
void add_ball(World& world, const std::string& name, const Ball& ball, double friction) {
  const JointId joint =
      world.add(name, friction > 0 ? ball.with_axes(Quat::Identity(), Quat::Identity()) : ball);
  if (friction > 0)
    for (const char* turn : {"turn_x", "turn_y", "turn_z"})
      world.set_friction(world.axis(joint, turn), AxisFriction{friction, friction, 0});
}

/// Joints of node (i, j): the first of the rod ends that meet there is the hub, held by the world if the node
/// is pinned, and every other rod end hangs on the hub.
void add_node(World& world, const Surface& surface, const NetRods& rods, int i, int j, double friction) {
  const std::vector<NetRods::End> ends = rods.ends(i, j);
  const NetRods::End& hub = ends[0];
  if (surface.pinned(i, j))
    add_ball(world, numbered("pin", i, j), Ball(kGround, hub.rod, surface.node(i, j), hub.p), friction);
  for (int e = 1; e < static_cast<int>(ends.size()); ++e)
    add_ball(world, numbered("node", i, j, e), Ball(hub.rod, ends[e].rod, hub.p, ends[e].p), friction);
}

Scene build_net(const char* name, bool flag, double friction, const Parameters& parameters) {
  const int n = static_cast<int>(parameters.at("n"));
  Scene scene = new_scene(name, parameters, duration_for(n, {{5, 5.0}, {20, 2.0}, {40, 1.0}, {80, 0.5}}));

  const Surface surface(n, flag);
  const NetRods rods{n};
  add_rods(scene, surface);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) add_node(scene.world, surface, rods, i, j, friction);

  // Its free corners whip: with longer sub-steps it keeps its energy to 1e-4 at 1 ms by luck only.
  if (flag) scene.settings.max_tension_number = 0.5;
  scene.energy_scale = fall_energy(scene.world, 2 * kHalfRod * (n - 1), scene.duration);
  add_probe(scene, rods.x((n - 1) / 2, flag ? n - 1 : n / 2));
  return scene;
}

Scene build_flag(const Parameters& parameters) { return build_net("net-flag", true, 0, parameters); }
Scene build_corners(const Parameters& parameters) { return build_net("net-corners", false, 0, parameters); }
Scene build_friction(const Parameters& parameters) {
  return build_net("net-friction", false, parameters.at("friction"), parameters);
}

/// A ball falls into the middle of the net; bars touch it, but not each other.
Scene build_catch(const Parameters& parameters) {
  Scene scene = build_net("net-catch", false, 0, parameters);
  scene.dt = 1e-3;
  scene.duration = 3;
  World& world = scene.world;
  constexpr std::uint32_t kBars = 2, kBalls = 4;
  const Material rope = rubbing(0.3);
  const PlacedShape bar{Capsule{kRodRadius, 2 * kHalfRod},
                        {exp_so3(Vec3(0, std::numbers::pi / 2, 0)), Vec3::Zero()}};
  const auto shape = std::make_shared<const Shape>(bar.shape);
  double lowest = 0;
  for (int b = 1; b < world.body_count(); ++b) {
    world.add_shape(BodyId{b}, shape, bar.pose, rope, {kBars, kBalls});
    lowest = std::min(lowest, world.pose(BodyId{b}).p.z());
  }
  constexpr double kBallRadius = 0.2, kBallSinks = 0.002;  ///< under its own weight on one point [m]
  const double drop = parameters.at("drop"), mass = parameters.at("mass");
  const BodyId ball =
      world.add_body({.name = "ball",
                      .mass = MassProperties::sphere(kBallRadius, mass),
                      .pose = {.p = Vec3(0.013, 0.021, lowest + kRodRadius + kBallRadius + drop)}});
  world.add_shape(ball, Sphere{kBallRadius}, {}, rubbing(0.3, kBallSinks / (mass * world.gravity().norm())),
                  {kBalls, kBars});
  scene.energy_scale = fall_energy(world, drop + 1, scene.duration);
  scene.probes.clear();
  add_probe(scene, ball);
  return scene;
}

/// With fewer than three nodes a pinned edge would be one rod held at both ends, which is redundant.
ParameterInfo net_size(int nodes) { return size(nodes, 3, 500, "nodes along an edge"); }

}  // namespace

std::vector<NetRods::End> NetRods::ends(int i, int j) const {
  std::vector<End> all;
  const Vec3 end(kHalf, 0, 0);
  if (i > 0) all.push_back({x(i - 1, j), end});
  if (i < n - 1) all.push_back({x(i, j), -end});
  if (j > 0) all.push_back({y(i, j - 1), end});
  if (j < n - 1) all.push_back({y(i, j), -end});
  return all;
}

std::vector<SceneInfo> net_scenes() {
  return {
      {"net-flag", "n x n net of rods, pinned at two neighbouring corners", {net_size(20)}, build_flag},
      {"net-corners", "n x n net of rods, pinned at its four corners", {net_size(20)}, build_corners},
      {"net-friction",
       "net-corners with Coulomb friction in every joint",
       {net_size(5), {"friction", 1e-3, "N·m", "torque about each of three axes", 0, 1e3, false}},
       build_friction},
      {"net-catch",
       "a ball falls into net-corners, whose bars touch it",
       {net_size(20),
        {"mass", 50, "kg", "of the ball", 0.1, 1e4, false},
        {"drop", 0.5, "m", "height that it falls", 0, 100, false}},
       build_catch},
      {"net", "net-corners with 40 x 40 nodes", {net_size(40)}, build_corners},
  };
}

}  // namespace taut
