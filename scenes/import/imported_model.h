#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "scenes/import/notice.h"

namespace taut {

/// A model as a scene file says it, and all that the scene does not have, or has otherwise.
struct ImportedModel {
  nlohmann::ordered_json document;    ///< taut-scene/1
  std::vector<ImportNotice> notices;  ///< by file and line
};

/// Reads a model.  Which format it is in is what its outermost element says: <robot>, <sdf> or <mujoco>.
/// @throws ImportError (an std::invalid_argument) with file and line if the file cannot be read or
/// understood, or what it describes cannot be a scene, as a body that moves and has no mass.
ImportedModel import_model(const std::filesystem::path& file);
/// The same for a text; files that it names are looked for beside `file`.
ImportedModel import_model_text(std::string_view text, const std::filesystem::path& file);

}  // namespace taut
