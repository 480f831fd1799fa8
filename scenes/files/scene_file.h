#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/builders/scene.h"

/// Scene files: JSON with comments.  scenes/files/FORMAT.md describes the format,
/// scenes/examples/taut-scene.schema.json is its schema.
namespace taut {

/// One thing that is wrong in a scene file.
struct SceneFileProblem {
  std::string path;     ///< where: a JSON pointer such as /bodies/3/mass, or "line 3, column 5"
  std::string message;  ///< what is wrong or what is expected there
  std::string value;    ///< what was found, shortened; empty if there is nothing to show
};

/// All problems of a file at once.  what() has one line for each:
///     arm.json: /bodies/3/mass: must be finite and positive (value: -1)
class SceneFileError : public std::invalid_argument {
 public:
  SceneFileError(const std::string& file_name, std::vector<SceneFileProblem> problems);
  const std::vector<SceneFileProblem>& problems() const { return problems_; }

 private:
  std::vector<SceneFileProblem> problems_;
};

/// No text that is read is longer [bytes]: some million bodies.
constexpr std::size_t kMostTextBytes = std::size_t{1} << 30;
/// All of a file, which may be a pipe.  @throws SceneFileError if it cannot be read or is longer than
/// kMostTextBytes.
std::string read_text_file(const std::filesystem::path& path);

/// @throws SceneFileError if the file cannot be read or anything in it is wrong.
Scene load_scene_file(const std::filesystem::path& path);
/// The same for a text in memory; `file_name` is for the messages, its stem the default name of the scene,
/// and mesh files are looked for in its folder.
Scene parse_scene(std::string_view text, const std::string& file_name);

}  // namespace taut
