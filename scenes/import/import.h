#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/builders/scene.h"
#include "scenes/import/notice.h"

/// Models of robots in the formats of others: URDF, SDF, MJCF.
namespace taut {

/// A model as a scene file says it, and all that the scene does not have, or has otherwise.
struct ImportedModel {
  nlohmann::ordered_json document;    ///< taut-scene/1
  std::vector<ImportNotice> notices;  ///< by file and line
};

/// True for what ends in .urdf, .sdf, .world, .mjcf or .xml.
bool is_model_file(const std::string& name);
/// Also true for a scene file (scenes/files/scene_source.h).
bool is_scene_or_model_file(const std::string& name);

/// Reads a model.  Which format it is in is what its outermost element says: <robot>, <sdf> or <mujoco>.
/// @throws ImportError (an std::invalid_argument) with file and line if the file cannot be read or
/// understood, or what it describes cannot be a scene, as a body that moves and has no mass.
ImportedModel import_model(const std::filesystem::path& file);
/// The same for a text; files that it names are looked for beside `file`.
ImportedModel import_model_text(std::string_view text, const std::filesystem::path& file);

/// The scene of a model file; what it lacks is added to `notices` if that is given.
Scene load_model_file(const std::filesystem::path& file, std::vector<ImportNotice>* notices = nullptr);

/// As open_scene(), and model files as well.
Scene open_scene_or_model(const std::string& name_or_file,
                          const std::map<std::string, double>& parameters = {},
                          std::vector<ImportNotice>* notices = nullptr);

}  // namespace taut
