#include "scenes/builders/net_drag.h"

#include <cmath>
#include <numbers>

#include "core/joints/joints.h"
#include "core/state/motion.h"
#include "scenes/builders/net.h"
#include "scenes/builders/scene_parts.h"

namespace taut {
namespace {

using namespace scene_parts;

constexpr double kRod = 2 * NetRods::kHalf, kRodMass = 0.1;
constexpr double kKnotRadius = 0.02;                    ///< [m]
constexpr double kBumpArc = 0.8;                        ///< θ: half the angle of the front edge [rad]
constexpr double kRopeAngle = 1.0;                      ///< of the ropes to the front edge [rad]
constexpr double kWay = 3;                              ///< that the net is dragged [m]
constexpr double kDragStart = 0.5;                      ///< time to full speed [s]
constexpr double kCell = 0.1, kWave = 0.8, kRim = 0.6;  ///< of the ground [m]
const Vec3 kLoadSize(0.25, 0.25, 0.15);                 ///< [m]
constexpr double kSinks = 3e-4;                         ///< of a knot under a quarter of the load [m]
constexpr double kDragPlay = 0.05;                      ///< of the rope that ties the load [m]
constexpr std::uint32_t kDragGroundGroup = 1, kKnots = 2, kLoads = 4;

/// The net at the start, flat, with its front edge ahead, i along x: rows of rods along x whose ends lie on
/// an arc,
///   (x, y) = (0.1 i − R (cos φ(j) − cos θ), R sin φ(j)),  φ(j) = θ (2j/(n−1) − 1),
/// each rod 0.1 m.  It is nearly the shape in which friction leaves it; corners that were pulled straight
/// ahead would have to carry the front edge by endless tension.
struct Layout {
  Layout(int nodes, double height)
      : n(nodes), radius(NetRods::kHalf / std::sin(kBumpArc / (nodes - 1))), z(height) {}
  Vec3 node(int i, int j) const {
    const double angle = kBumpArc * (2.0 * j / (n - 1) - 1);
    return {kRod * (i - n + 1) - radius * (std::cos(angle) - std::cos(kBumpArc)), radius * std::sin(angle),
            z};
  }
  double half_width() const { return radius * std::sin(kBumpArc); }
  int n;
  double radius;
  double z;  ///< of the nodes [m]
};

/// z = b s(x) (1/2 + sin(kx)/4 + sin(k (0.6 x + 0.8 y))/4), between 0 and the height b of the bumps; s rises
/// smoothly from 0, where the net lies at the start, to 1 within a wavelength.
double ground_height(double x, double y, double bump) {
  const double k = 2 * std::numbers::pi / kWave, t = std::clamp((x - 2 * kCell) / kWave, 0.0, 1.0);
  return bump * t * t * (3 - 2 * t) *
         (0.5 + 0.25 * std::sin(k * x) + 0.25 * std::sin(k * (0.6 * x + 0.8 * y)));
}

void add_ground(World& world, const Layout& net, double bump, const Material& material) {
  const double back = net.node(0, net.n / 2).x() - kRim, front = kWay + kRim;
  HeightField field;
  field.dx = field.dy = kCell;
  field.nx = static_cast<int>(std::ceil((front - back) / kCell)) + 1;
  field.ny = 2 * static_cast<int>(std::ceil((net.half_width() + kRim) / kCell)) + 1;
  const double middle = back + 0.5 * kCell * (field.nx - 1);
  for (int j = 0; j < field.ny; ++j)
    for (int i = 0; i < field.nx; ++i)
      field.heights.push_back(ground_height(back + kCell * i, kCell * (j - 0.5 * (field.ny - 1)), bump));
  world.add_shape(kGround, field, {.p = Vec3(middle, 0, 0)}, material, {kDragGroundGroup, kKnots | kLoads});
}

/// A ball around the end of the rod.  Balls at the knots are enough: the ground curves too little to reach
/// the rods in between, which are half as thick, and each is one point with a force that the statics of the
/// net determine.  Capsules along the rods would be five times as many points, and would roll, since rods
/// turn freely about themselves.  Knots touch each other, too: a mesh of four equal rods that folds flat has
/// no determinate forces, and nets that were pulled sharply did fold.
void add_knot(Scene& scene, const NetRods::End& hub, const Material& material) {
  const PlacedShape knot{Sphere{kKnotRadius}, {.p = hub.p}};
  scene.world.add_shape(hub.rod, knot.shape, knot.pose, material,
                        {kKnots, kDragGroundGroup | kKnots | kLoads});
  draw(scene, hub.rod, knot);
}

/// Joints of node (i, j).  The knot is a part of its hub.  So that it slides and does not roll, each rod
/// along x is kept from turning about itself by one rod across it.
void add_node(World& world, const Layout& net, const NetRods& rods, int i, int j) {
  const std::vector<NetRods::End> ends = rods.ends(i, j);
  const BodyId hub = ends[0].rod;
  bool upright = i == 0;
  for (int e = 1; e < static_cast<int>(ends.size()); ++e) {
    const BodyId rod = ends[e].rod;
    const std::string name = numbered("node", i, j, e);
    const Vec3 p = net.node(i, j), along = world.pose(rod).q * Vec3::UnitX();
    const bool across = rod >= rods.y(0, 0);
    if (across && !upright)
      world.add(name, Universal::at(world, hub, rod, p, Vec3::UnitZ(), along));
    else
      world.add(name, Ball::at(world, hub, rod, p));
    upright = upright || across;
  }
}

void add_net(Scene& scene, const Layout& net, const NetRods& rods, const Material& material) {
  const int n = net.n;
  const auto rod = [&](const std::string& name, const Vec3& from, const Vec3& to) {
    add_rod(scene, name, from, to, kRodRadius, kRodMass);
  };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n - 1; ++i) rod(numbered("rod_x", i, j), net.node(i, j), net.node(i + 1, j));
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n - 1; ++j) rod(numbered("rod_y", i, j), net.node(i, j), net.node(i, j + 1));
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      add_knot(scene, rods.ends(i, j)[0], material);
      add_node(scene.world, net, rods, i, j);
    }
}

/// A box that lies on the net, tied to a knot in the middle by a rope with some play, so that it is not lost.
BodyId add_load(Scene& scene, const Layout& net, const NetRods& rods, double mass, const Material& material,
                double sinks) {
  World& world = scene.world;
  const int a = (net.n - 1) / 2, b = net.n / 2;
  BodySpec spec{.name = "load", .mass = MassProperties::box(kLoadSize, mass)};
  spec.pose.p = (net.node(a, a) + net.node(a, b) + net.node(b, a) + net.node(b, b)) / 4;
  spec.pose.p.z() += kKnotRadius + 0.5 * kLoadSize.z() - sinks;
  const BodyId load = world.add_body(spec);
  world.add_shape(load, Box{kLoadSize}, {}, material, {kLoads, kDragGroundGroup | kKnots});
  const NetRods::End knot = rods.ends(b, b)[0];
  const Vec3 under(0, 0, -0.5 * kLoadSize.z());
  const double way = (world.pose(load).point(under) - net.node(b, b)).norm();
  world.add("lashing", Rope(knot.rod, load, knot.p, under, way + kDragPlay));
  world.set_collision(knot.rod, load, true);
  return load;
}

/// A bar above all bumps that moves ahead, with a rope to each of the front corners.
void add_bar(Scene& scene, const Layout& net, const NetRods& rods, double bump, const Motion& way) {
  World& world = scene.world;
  const double length = 0.5;
  const Vec3 ahead(length * std::sin(kRopeAngle), length * std::cos(kRopeAngle), bump);
  const auto hook = [&](int j) -> Vec3 {
    return net.node(net.n - 1, j) + Vec3(ahead.x(), j > 0 ? ahead.y() : -ahead.y(), ahead.z());
  };
  const int last = net.n - 1;
  const BodyId bar = add_rod(scene, "bar", hook(0), hook(last), kRodRadius, 1);
  const JointId rail = world.add("rail", Slider::at(world, kGround, bar, world.pose(bar).p, Vec3::UnitX()));
  world.add("drive", Driver(world, world.axis(rail, "displacement"), way));
  for (const int j : {0, last})
    world.add(j > 0 ? "rope_left" : "rope_right",
              Rope::between(world, bar, rods.ends(last, j)[0].rod, hook(j), net.node(last, j)));
}

Scene build_net_drag(const Parameters& parameters) {
  const double speed = parameters.at("speed"), bump = parameters.at("bump");
  const double load = parameters.at("load"), friction = parameters.at("friction");
  Scene scene = new_scene("net-drag", parameters, kWay / speed + kDragStart / 2, 1.0 / 500);
  const NetRods rods{static_cast<int>(parameters.at("n"))};
  // Knots and load give way: friction at knots that rods hold together is not determinate otherwise.  Rigid
  // ones took ten times as many Newton steps.  At the start they have settled in part, since round-off would
  // decide about a gap of 0.
  const double knot_weight = 2 * kRodMass * scene.world.gravity().norm();
  const double load_share = 0.25 * load * scene.world.gravity().norm();
  const double compliance = kSinks / (knot_weight + load_share);
  const Layout net(rods.n, kKnotRadius - compliance * knot_weight);
  const Material material = rubbing(friction, compliance);
  add_net(scene, net, rods, material);
  add_ground(scene.world, net, bump, rubbing(friction));
  add_probe(scene, add_load(scene, net, rods, load, material, compliance * load_share));
  add_bar(scene, net, rods, bump, speed_motion(Curve({{0, 0}, {kDragStart, speed}}), 0));
  scene.energy_scale = fall_energy(scene.world, 0.1, scene.duration);
  return scene;
}

}  // namespace

std::vector<SceneInfo> net_drag_scenes() {
  return {{"net-drag",
           "a net with a load on it is dragged over bumpy ground by two corners",
           {size(8, 3, 100, "nodes along an edge of the net"),
            {"load", 10, "kg", "mass of the box that lies on its middle", 0.1, 1e4, false},
            {"speed", 0.5, "m/s", "at which it is dragged", 0.01, 10, false},
            {"friction", 0.5, "", "Coulomb coefficient of net, load and ground", 0.1, 10, false},
            {"bump", 0.05, "m", "height of the bumps; 0 is a flat ground", 0, 0.1, false}},
           build_net_drag}};
}

}  // namespace taut
