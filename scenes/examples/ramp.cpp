// Three boxes on a ramp of 20°, with friction 0.5, 0.3 and 0.1: the first holds, the others slide as Coulomb
// says.
//   ramp [FOLDER]   writes ramp.html
#include <taut/io.h>

#include <cstdio>

int main(int argc, char** argv) {
  using namespace taut;
  const std::string folder = argc > 1 ? argv[1] : ".";
  const double slope = 20 * std::acos(-1) / 180, g = 9.81, duration = 1, dt = 1e-3;
  const double friction[] = {0.5, 0.3, 0.1};
  World world;
  world.set_gravity({0, 0, -g});
  const Quat tilt = exp_so3(Vec3(0, slope, 0));
  const ShapeId ground = world.add_shape(kGround, HalfSpace{}, {tilt, Vec3::Zero()});
  std::vector<BodyId> boxes;
  for (int i = 0; i < 3; ++i) {
    const BodyId box = world.add_body({.mass = MassProperties::box({0.4, 0.3, 0.2}, 2),
                                       .pose = {tilt, tilt * Vec3(0, 0.6 * (i - 1), 0.1)}});
    const ShapeId shape = world.add_shape(box, Box{{0.4, 0.3, 0.2}});
    world.set_contact_material(ground, shape,
                               {.static_friction = friction[i], .dynamic_friction = friction[i]});
    boxes.push_back(box);
  }
  Simulator simulator(world);
  Film film(world);
  while (world.time() < duration - dt / 2) {
    film.sample(simulator);
    if (!simulator.step(dt).ok()) return std::fprintf(stderr, "%s\n", simulator.report().message.c_str()), 1;
  }
  bool right = true;
  for (int i = 0; i < 3; ++i) {
    const double pull = g * (std::sin(slope) - friction[i] * std::cos(slope));
    const double truth = 0.5 * std::max(pull, 0.0) * duration * duration;
    const double way = world.pose(boxes[i]).p.dot(tilt * Vec3::UnitX());
    std::printf("friction %.1f: slid %.9f m, Coulomb says %.9f m\n", friction[i], way, truth);
    right = right && std::abs(way - truth) < 1e-6;
  }
  RecordingReader recording = film.reader();
  const ExportOutcome made = export_recording(recording, {.html = folder + "/ramp.html"});
  for (const std::string& error : made.errors) std::fprintf(stderr, "%s\n", error.c_str());
  return right && made.errors.empty() ? 0 : 1;
}
