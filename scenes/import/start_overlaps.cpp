#include "scenes/import/start_overlaps.h"

#include <vector>

#include "core/base/union_find.h"
#include "scenes/files/scene_file.h"
#include "solvers/diagnosis/start_checks.h"

namespace taut::model {
namespace {

/// What is deeper in each other than round-off of poses [m].
constexpr double kDeep = 1e-6;

/// Overlaps of bodies between which joints lead without the ground.
std::vector<StartOverlap> overlaps_of_robots(const World& world) {
  UnionFind robots;
  robots.reset(world.body_count());
  for (int j = 0; j < world.joint_count(); ++j) {
    int last = kGround.index;
    for (const BodyId body : world.joint({j}).bodies()) {
      if (body == kGround) continue;
      if (last != kGround.index) robots.join(body.index, last);
      last = body.index;
    }
  }
  std::vector<StartOverlap> found = start_overlaps(world);
  std::erase_if(found, [&](const StartOverlap& pair) {
    return robots.find(pair.a.index) != robots.find(pair.b.index);
  });
  return found;
}

}  // namespace

std::vector<LinkOverlap> forbid_overlaps(nlohmann::ordered_json& document, const std::string& file,
                                         Meant meant) {
  const Scene scene = parse_scene(document.dump(), file);
  const World& world = scene.world;
  std::vector<LinkOverlap> names;
  for (const auto& [a, b, depth] :
       meant == Meant::kAll ? overlaps_deeper_than(kDeep, world) : overlaps_of_robots(world)) {
    names.push_back({world.name(a), world.name(b), depth});
    document["pairs"].push_back({{"a", world.name(a)}, {"b", world.name(b)}, {"collide", false}});
  }
  return names;
}

}  // namespace taut::model
