#include "scenes/import/start_overlaps.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "collision/contact_finder.h"
#include "scenes/files/scene_file.h"
#include "solvers/diagnosis/start_checks.h"

namespace taut::model {
namespace {

/// What is deeper in each other than round-off of poses [m].
constexpr double kDeep = 1e-6;

/// All overlaps, deepest first.
std::vector<StartOverlap> all_overlaps(const World& world) {
  std::map<std::pair<BodyId, BodyId>, double> depths;
  ContactFinder finder({.margin = 0, .threads = 1});
  for (const Contact& contact : finder.find(world)) {
    if (!(contact.gap < -kDeep)) continue;
    double& depth = depths[std::minmax(world.shape(contact.a).body, world.shape(contact.b).body)];
    depth = std::max(depth, -contact.gap);
  }
  std::vector<StartOverlap> found;
  for (const auto& [pair, depth] : depths) found.push_back({pair.first, pair.second, depth});
  std::stable_sort(found.begin(), found.end(),
                   [](const StartOverlap& a, const StartOverlap& b) { return a.depth > b.depth; });
  return found;
}

/// Joints lead from one body to the other without the ground, for each body by a body that stands for all.
std::vector<int> robots(const World& world) {
  std::vector<int> robot(world.body_count());
  std::iota(robot.begin(), robot.end(), 0);
  const auto first_of = [&](int body) {
    while (robot[body] != body) body = robot[body] = robot[robot[body]];
    return body;
  };
  for (int j = 0; j < world.joint_count(); ++j) {
    int last = kGround.index;
    for (const BodyId body : world.joint({j}).bodies()) {
      if (body == kGround) continue;
      if (last != kGround.index) robot[first_of(body.index)] = first_of(last);
      last = body.index;
    }
  }
  for (int b = 0; b < world.body_count(); ++b) robot[b] = first_of(b);
  return robot;
}

std::vector<StartOverlap> overlaps_of_robots(const World& world) {
  std::vector<StartOverlap> found = start_overlaps(world);
  const std::vector<int> robot = robots(world);
  std::erase_if(found, [&](const StartOverlap& pair) { return robot[pair.a.index] != robot[pair.b.index]; });
  return found;
}

}  // namespace

std::vector<LinkOverlap> forbid_overlaps(nlohmann::ordered_json& document, const std::string& file,
                                         Meant meant) {
  const Scene scene = parse_scene(document.dump(), file);
  const World& world = scene.world;
  std::vector<LinkOverlap> names;
  for (const auto& [a, b, depth] : meant == Meant::kAll ? all_overlaps(world) : overlaps_of_robots(world)) {
    names.push_back({world.name(a), world.name(b), depth});
    document["pairs"].push_back({{"a", world.name(a)}, {"b", world.name(b)}, {"collide", false}});
  }
  return names;
}

}  // namespace taut::model
