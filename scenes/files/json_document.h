#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/files/scene_file.h"

namespace taut {

using Problems = std::vector<SceneFileProblem>;

/// Deepest nesting of arrays and objects that is read; a scene needs 6.
inline constexpr int kMaxJsonDepth = 64;

/// `path`/`key` as a JSON pointer [RFC 6901]; the root is "/".
std::string child_path(const std::string& path, std::string_view key);

/// Parses JSON with // and /* */ comments.  Duplicate keys are problems.  A number beyond the range of double
/// becomes ±infinity, so that whoever reads it can tell its place.
/// @return nothing if the syntax is wrong or the nesting too deep.
std::optional<nlohmann::json> parse_json(std::string_view text, Problems& problems);

}  // namespace taut
