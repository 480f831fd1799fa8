#pragma once

#include <algorithm>
#include <map>
#include <string>

#include "scenes/builders/drawing.h"
#include "scenes/builders/scene.h"

/// Small things that the builders share.
namespace taut::scene_parts {

using Parameters = std::map<std::string, double>;

/// The size parameter that every builder has.
inline ParameterInfo size(double default_value, double minimum, double maximum, std::string description) {
  return {"n", default_value, "", std::move(description), minimum, maximum, true};
}

/// What every builder begins with; dt and duration in seconds.
inline Scene new_scene(std::string name, const Parameters& parameters, double duration = 1,
                       double dt = 1.0 / 240) {
  Scene scene;
  scene.name = std::move(name);
  scene.parameters = parameters;
  scene.duration = duration;
  scene.dt = dt;
  return scene;
}

/// A solid cylinder along body x.
inline constexpr double kRodRadius = 0.01;  ///< [m]
inline MassProperties thin_rod(double length, double mass) {
  return MassProperties::rod(length, kRodRadius, mass);
}

/// A solid cylinder from one point to another, its body x that way, drawn as it is.
inline BodyId add_rod(Scene& scene, std::string name, const Vec3& from, const Vec3& to, double radius,
                      double mass) {
  const double length = (to - from).norm();
  BodySpec body{.name = std::move(name), .mass = MassProperties::rod(length, radius, mass)};
  body.pose.p = 0.5 * (from + to);
  body.pose.q = rotation_between(Vec3::UnitX(), to - from).normalized();
  const BodyId rod = scene.world.add_body(body);
  draw(scene, rod, rod_shape(length, radius));
  return rod;
}

/// With this Coulomb coefficient while sticking and sliding; it gives way by `compliance` [m/N].
inline Material rubbing(double friction, double compliance = 0) {
  Material material;
  material.static_friction = material.dynamic_friction = friction;
  material.compliance = compliance;
  return material;
}

/// One row of a table of durations: T holds from this size on, up to the next row.
struct DurationFrom {
  int size;
  double duration;
};
/// T of the largest tabulated size that is not above n, and of the smallest one below that.
template <std::size_t Count>
double duration_for(int n, const DurationFrom (&table)[Count]) {
  double duration = table[0].duration;
  for (const DurationFrom& row : table)
    if (n >= row.size) duration = row.duration;
  return duration;
}

/// E_scale = M g min(h, g T²/2) [J]: what the moving mass M can at most turn into motion in T seconds when it
/// has h metres to fall.
inline double fall_energy(const World& world, double height, double duration) {
  double mass = 0;
  for (int b = 0; b < world.body_count(); ++b)
    if (!world.is_fixed(BodyId{b})) mass += world.mass_properties(BodyId{b}).mass();
  const double g = world.gravity().norm();
  return mass * g * std::min(height, 0.5 * g * duration * duration);
}

/// The body position by which engines are compared.
inline void add_probe(Scene& scene, BodyId body) {
  Probe probe;
  probe.name = "probe";
  probe.quantity = Probe::Quantity::kPosition;
  probe.body = body;
  scene.probes.push_back(probe);
}

/// A name like node_3_4.
template <typename... Index>
std::string numbered(std::string stem, Index... index) {
  ((stem += '_', stem += std::to_string(index)), ...);
  return stem;
}

}  // namespace taut::scene_parts
