// A pole on a cart that a force law of one's own keeps upright, from 10° off.
//   cart_pole [FOLDER]   writes cart_pole.html and cart_pole.svg
#include <taut/io.h>

#include <cstdio>

int main(int argc, char** argv) {
  using namespace taut;
  const std::string folder = argc > 1 ? argv[1] : ".";
  Scene scene{.name = "cart_pole"};
  World& world = scene.world;
  const double tilt = 10 * std::acos(-1) / 180;
  const Quat lean = exp_so3(Vec3(0, tilt, 0));
  const BodyId cart = world.add_body({.name = "cart", .mass = MassProperties::box({0.4, 0.2, 0.1}, 1)});
  const BodyId pole = world.add_body({.name = "pole",
                                      .mass = MassProperties::box({0.04, 0.04, 1}, 0.2),
                                      .pose = {lean, lean * Vec3(0, 0, 0.5)}});
  world.add("rail", Slider::at(world, kGround, cart, Vec3::Zero(), Vec3::UnitX()));
  world.add("pivot", Hinge::at(world, cart, pole, Vec3::Zero(), Vec3::UnitY()));
  // State feedback on x, ẋ, the pole's angle and its rate.  A law sees trial states: it reads its argument,
  // not the world.
  world.add_force(ForceCallback([=](const State& state, std::span<Wrench> wrenches) {
    const Vec3 up = state.poses[pole.index].q * Vec3::UnitZ();
    const double angle = std::atan2(up.x(), up.z());
    const double force = 3 * state.poses[cart.index].p.x() + 5 * state.twists[cart.index].v.x() + 45 * angle +
                         11 * state.twists[pole.index].w.y();
    wrenches[cart.index].force.x() += force;
  }));
  scene.drawings.push_back({cart, {Box{{0.4, 0.2, 0.1}}}});
  scene.drawings.push_back({pole, {Box{{0.04, 0.04, 1}}}});
  scene.probes.push_back({.name = "cart", .quantity = Probe::Quantity::kPosition, .body = cart});
  Simulator simulator(world);
  Film film(scene);
  while (world.time() < 8) {
    film.sample(simulator);
    if (!simulator.step(2e-3).ok())
      return std::fprintf(stderr, "%s\n", simulator.report().message.c_str()), 1;
  }
  const double left = (world.pose(pole).q * Vec3::UnitZ()).x(), x = world.pose(cart).p.x();
  std::printf(
      "after 8 s the pole leans by %.1e rad, the cart is %.1e m from where it began; joints open by %.1e m\n",
      left, x, simulator.report().gap.metres);
  RecordingReader recording = film.reader();
  const ExportOutcome made =
      export_recording(recording, {.html = folder + "/cart_pole.html", .plot = folder + "/cart_pole.svg"});
  for (const std::string& error : made.errors) std::fprintf(stderr, "%s\n", error.c_str());
  return std::abs(left) < 1e-3 && std::abs(x) < 1e-2 && made.errors.empty() ? 0 : 1;
}
