#include "scenes/files/scene_merge.h"

#include "core/base/check.h"

namespace taut {

void append_scene(Scene& scene, const Scene& block, const std::string& prefix, const Pose& placement) {
  if (const std::string taken = taken_name(scene, block, prefix, placement); !taken.empty())
    fail("prefix", taken + " is there already", prefix);
  if (!block.events.empty()) fail("block", "has events, which cannot be moved", block.events[0].name);
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

std::string taken_name(const Scene& scene, const Scene& block, const std::string& prefix,
                       const Pose& placement) {
  const World &world = scene.world, &added = block.world;
  const auto shown = [](const char* kind, const std::string& name) { return kind + (" \"" + name + "\""); };
  const bool placed = !(placement.p.isZero(0) && placement.q.vec().isZero(0));
  for (int b = placed ? 0 : 1; b < added.body_count(); ++b)
    if (const std::string name = prefix + added.name(BodyId{b}); world.has_body(name))
      return shown("body", name);
  for (int j = 0; j < added.joint_count(); ++j)
    if (const std::string name = prefix + added.name(JointId{j}); world.has_joint(name))
      return shown("joint", name);
  for (int m = 0; m < added.material_count(); ++m)
    for (int other = 0; other < world.material_count(); ++other)
      if (const std::string name = prefix + added.name(MaterialId{m}); name == world.name(MaterialId{other}))
        return shown("material", name);
  for (const Probe& probe : block.probes)
    for (const Probe& other : scene.probes)
      if (other.name == prefix + probe.name) return shown("probe", other.name);
  return "";
}

}  // namespace taut
