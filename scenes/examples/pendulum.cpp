// A rod on a hinge, released from the horizontal: how long it takes to come back, beside the closed form.
//   pendulum [FOLDER]   writes pendulum.html and pendulum.svg
#include <taut/io.h>

#include <cstdio>

int main(int argc, char** argv) {
  using namespace taut;
  const std::string folder = argc > 1 ? argv[1] : ".";
  const double length = 1, g = 9.81;
  Scene scene{.name = "pendulum"};
  World& world = scene.world;
  world.set_gravity({0, 0, -g});
  const BodyId rod = world.add_body({.name = "rod",
                                     .mass = MassProperties::box({length, 0.04, 0.04}, 1),
                                     .pose = {Quat::Identity(), Vec3(length / 2, 0, 0)}});
  const JointId hinge = world.add("hinge", Hinge::at(world, kGround, rod, Vec3::Zero(), Vec3::UnitY()));
  const AxisId angle = world.axis(hinge, "angle");
  scene.drawings.push_back({rod, {Box{{length, 0.04, 0.04}}}});
  scene.probes.push_back({.name = "angle", .quantity = Probe::Quantity::kAxis, .axis = angle});

  Simulator simulator(world, {.integrator = Integrator::kRattle4});
  Film film(scene);
  const double dt = 1e-3;
  double before = 0, period = 0;  // it is back where its rate changes sign for the second time
  for (int turns = 0; world.time() < 3;) {
    film.sample(simulator);
    if (!simulator.step(dt).ok()) return std::fprintf(stderr, "%s\n", simulator.report().message.c_str()), 1;
    const double rate = world.axis_rate(angle);
    if (before * rate < 0 && ++turns == 2) period = world.time() - dt * rate / (rate - before);
    before = rate;
  }
  // T = 4 √(I / m g s) K(sin 45°), I = m L²/3 and more for its thickness, K by means [AGM].
  const double inertia = (length * length + 0.04 * 0.04) / 12 + length * length / 4;
  double a = 1, b = std::sqrt(0.5);
  for (int i = 0; i < 6; ++i) std::tie(a, b) = std::pair((a + b) / 2, std::sqrt(a * b));
  const double truth = 4 * std::sqrt(inertia / (g * length / 2)) * std::acos(-1) / (2 * a);
  std::printf("period %.9f s, closed form %.9f s, joint open by %.1e m\n", period, truth,
              simulator.report().gap.metres);

  RecordingReader recording = film.reader();
  const ExportOutcome made =
      export_recording(recording, {.html = folder + "/pendulum.html", .plot = folder + "/pendulum.svg"});
  for (const std::string& error : made.errors) std::fprintf(stderr, "%s\n", error.c_str());
  return std::abs(period / truth - 1) < 1e-6 && made.errors.empty() ? 0 : 1;
}
