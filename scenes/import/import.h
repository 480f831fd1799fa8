#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "scenes/builders/scene.h"
#include "scenes/import/notice.h"

/// Models of robots in the formats of others: URDF, SDF, MJCF.
namespace taut {

/// True for what ends in .urdf, .sdf, .world, .mjcf or .xml.
bool is_model_file(const std::string& name);
/// Also true for a scene file (scenes/files/scene_source.h).
bool is_scene_or_model_file(const std::string& name);

/// The scene of a model file; what it lacks is added to `notices` if that is given.
/// @throws ImportError (an std::invalid_argument) with file and line if the file cannot be read or
/// understood, or what it describes cannot be a scene, as a body that moves and has no mass.
Scene load_model_file(const std::filesystem::path& file, std::vector<ImportNotice>* notices = nullptr);

/// The text of a scene file that says what a model file says.  Notices and errors: load_model_file().
std::string model_scene_text(const std::filesystem::path& file, std::vector<ImportNotice>* notices = nullptr);

/// What open_scene() (scenes/files/scene_source.h) gives, and the scene of a model file by its name.
Scene open_scene_or_model(const std::string& name_or_file,
                          const std::map<std::string, double>& parameters = {},
                          std::vector<ImportNotice>* notices = nullptr);

}  // namespace taut
