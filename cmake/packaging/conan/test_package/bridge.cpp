// The hanging bridge for a tenth of a second: that both libraries link, step and keep joints closed.
#include <taut/io.h>

#include <cstdio>

int main() {
  taut::Scene scene = taut::open_scene_or_model("bridge");
  taut::Simulator simulator(scene.world, scene.settings);
  while (scene.world.time() < 0.1)
    if (!simulator.step(scene.dt).ok()) return std::puts(simulator.report().message.c_str()), 1;
  std::printf("joints open by %.1e m\n", simulator.report().gap.metres);
  return simulator.report().gap.metres < 1e-9 ? 0 : 1;
}
