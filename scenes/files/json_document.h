#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/files/scene_file.h"

namespace taut {

/// What is wrong with a document; beside it what is only strange, which no reading waits for.
struct Problems : std::vector<SceneFileProblem> {
  std::vector<SceneFileProblem> warnings;
  bool by_hand = true;  ///< somebody has written it, who may have slipped
  /// Quaternions that look like x, y, z, w; warnings unless others show that the file has w in front.
  std::vector<SceneFileProblem> perhaps_w_last;
  bool has_w_first = false;
};

/// Deepest nesting of arrays and objects that is read; a scene needs 6.
inline constexpr int kMaxJsonDepth = 64;

/// `path`/`key` as a JSON pointer [RFC 6901]; the root is "/".
std::string child_path(const std::string& path, std::string_view key);

/// Parses JSON with // and /* */ comments.  Duplicate keys are problems.  A number beyond the range of double
/// becomes ±infinity, so that whoever reads it can tell its place.
/// @return nothing if the syntax is wrong or the nesting too deep.
std::optional<nlohmann::json> parse_json(std::string_view text, Problems& problems);

}  // namespace taut
