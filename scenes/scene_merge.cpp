#include "scenes/scene_merge.h"

#include "core/check.h"

namespace taut {

void append_scene(Scene& scene, const Scene& block, const std::string& prefix, const Pose& placement) {
  for (const Probe& probe : block.probes)
    for (const Probe& other : scene.probes)
      if (other.name == prefix + probe.name) fail("probe", "name is already taken", other.name);
  const Relocation to = scene.world.append(block.world, prefix, placement);
  for (Probe probe : block.probes) {
    probe.name = prefix + probe.name;
    probe.body = to(probe.body);
    if (probe.joint.index >= 0) probe.joint = to(probe.joint);
    if (probe.axis.joint.index >= 0) probe.axis.joint = to(probe.axis.joint);
    scene.probes.push_back(std::move(probe));
  }
  for (const Drawing& drawing : block.drawings) scene.drawings.push_back({to(drawing.body), drawing.shape});
  scene.assemble = scene.assemble || block.assemble;
  for (const auto& [name, value] : block.parameters) scene.parameters[prefix + name] = value;
}

}  // namespace taut
