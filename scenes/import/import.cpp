#include "scenes/import/import.h"

#include <algorithm>
#include <map>
#include <tuple>

#include "core/base/check.h"
#include "scenes/files/scene_file.h"
#include "scenes/files/scene_source.h"
#include "scenes/import/imported_model.h"
#include "scenes/import/mjcf_reader.h"
#include "scenes/import/rigid_groups.h"
#include "scenes/import/scene_document.h"
#include "scenes/import/sdf_reader.h"
#include "scenes/import/start_limits.h"
#include "scenes/import/start_overlaps.h"
#include "scenes/import/urdf_reader.h"
#include "scenes/import/xml_files.h"
#include "scenes/support/format.h"

namespace taut {
namespace {

/// Those that say the same become one, by file and line.
std::vector<ImportNotice> gathered(std::vector<ImportNotice> notices) {
  std::stable_sort(notices.begin(), notices.end(), [](const ImportNotice& a, const ImportNotice& b) {
    return std::tie(a.place.file, a.place.line) < std::tie(b.place.file, b.place.line);
  });
  std::map<std::pair<std::string, std::string>, std::size_t> seen;
  std::vector<ImportNotice> result;
  for (ImportNotice& notice : notices) {
    const auto [known, added] = seen.try_emplace({notice.place.file, notice.message}, result.size());
    if (added)
      result.push_back(std::move(notice));
    else
      result[known->second].count += notice.count;
  }
  return result;
}

model::RobotModel read_robot_model(model::XmlFiles& files, const pugi::xml_node& root) {
  const std::string_view format = root.name();
  if (format == "robot") return model::read_urdf(files, root);
  if (format == "sdf") return model::read_sdf(files, root);
  if (format == "mujoco") return model::read_mjcf(files, root);
  files.fail(root,
             "is none of <robot>, <sdf> and <mujoco> (value: <" + std::string(format.substr(0, 60)) + ">)");
}

/// Names and files may have bytes that a scene file cannot.
void require_utf8(const nlohmann::ordered_json& document, const ModelPlace& place) {
  try {
    (void)document.dump();
  } catch (const nlohmann::ordered_json::type_error&) {
    throw ImportError(place, "names and values must be UTF-8");
  }
}

ImportedModel import_root(model::XmlFiles& files, const pugi::xml_node& root,
                          const std::filesystem::path& file) {
  model::RobotModel robot;
  files.attempt([&] { robot = read_robot_model(files, root); });
  files.throw_problems();
  if (robot.name.empty()) robot.name = file.stem().string();
  model::fuse_links_without_mass(robot);
  model::start_within_limits(robot);
  ImportedModel result;
  result.document = model::SceneDocument(robot).write();
  require_utf8(result.document, files.place(root));
  const bool urdf = std::string_view(root.name()) == "robot";
  for (const model::LinkOverlap& pair : model::forbid_overlaps(
           result.document, file.string(), urdf ? model::Meant::kAll : model::Meant::kOfRobot))
    robot.notices.push_back({files.place(root),
                             format("\"%s\" and \"%s\" are in each other at the start, by %.3g m: they do "
                                    "not touch; \"pairs\" of the scene says so",
                                    pair.a.c_str(), pair.b.c_str(), pair.depth),
                             1});
  for (ImportNotice& notice : files.unread()) robot.notices.push_back(std::move(notice));
  result.notices = gathered(std::move(robot.notices));
  return result;
}

}  // namespace

bool is_model_file(const std::string& name) {
  return std::ranges::any_of(
      std::initializer_list<std::string_view>{".urdf", ".sdf", ".world", ".mjcf", ".xml"},
      [&](std::string_view ending) { return name.ends_with(ending); });
}

bool is_scene_or_model_file(const std::string& name) { return is_model_file(name) || is_scene_file(name); }

ImportedModel import_model(const std::filesystem::path& file) {
  model::XmlFiles files;
  return import_root(files, files.open(file), file);
}

ImportedModel import_model_text(std::string_view text, const std::filesystem::path& file) {
  model::XmlFiles files;
  return import_root(files, files.parse(text, file), file);
}

std::string model_scene_text(const std::filesystem::path& file, std::vector<ImportNotice>* notices) {
  const ImportedModel imported = import_model(file);
  if (notices) notices->insert(notices->end(), imported.notices.begin(), imported.notices.end());
  return imported.document.dump(1) + '\n';
}

Scene load_model_file(const std::filesystem::path& file, std::vector<ImportNotice>* notices) {
  return parse_scene(model_scene_text(file, notices), file.string(), false);
}

Scene open_scene_or_model(const std::string& name_or_file, const std::map<std::string, double>& parameters,
                          std::vector<ImportNotice>* notices) {
  if (!is_model_file(name_or_file)) return open_scene(name_or_file, parameters);
  if (!parameters.empty()) fail("--set", "a model file has no parameters", parameters.begin()->first);
  return load_model_file(name_or_file, notices);
}

}  // namespace taut
