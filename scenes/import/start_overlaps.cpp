#include "scenes/import/start_overlaps.h"

#include <set>

#include "collision/contact_finder.h"
#include "scenes/files/scene_file.h"

namespace taut::model {
namespace {

/// What is deeper in each other than round-off of poses [m].
constexpr double kDeep = 1e-6;

}  // namespace

std::vector<std::pair<std::string, std::string>> forbid_overlaps(nlohmann::ordered_json& document,
                                                                 const std::string& file) {
  const Scene scene = parse_scene(document.dump(), file);
  const World& world = scene.world;
  std::set<std::pair<BodyId, BodyId>> overlaps;
  ContactFinder finder({.margin = 0, .threads = 1});
  for (const Contact& contact : finder.find(world))
    if (contact.gap < -kDeep)
      overlaps.insert(std::minmax(world.shape(contact.a).body, world.shape(contact.b).body));
  std::vector<std::pair<std::string, std::string>> names;
  for (const auto& [a, b] : overlaps) {
    names.emplace_back(world.name(a), world.name(b));
    document["pairs"].push_back({{"a", world.name(a)}, {"b", world.name(b)}, {"collide", false}});
  }
  return names;
}

}  // namespace taut::model
