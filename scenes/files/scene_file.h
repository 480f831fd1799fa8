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

/// One thing that is wrong in a scene file, or strange.
struct SceneFileProblem {
  std::string path;     ///< where: a JSON pointer such as /bodies/3/mass; empty if the syntax is wrong
  std::string message;  ///< what is wrong or what is expected there
  std::string value;    ///< what was found, shortened; empty if there is nothing to show
  std::string name{};   ///< of the body, joint, ... that it is in; empty if that has none
  int line = 0;         ///< where the value begins, from 1; 0: not known
  int column = 0;       ///< in characters, from 1; 0: not known
  /// arm.json:12:7: /bodies/3/mass of "arm": must be finite and positive (value: -1)
  std::string text(const std::string& file_name) const;
};

/// All problems of a file at once.  what() has the text() of each, a line each.
class SceneFileError : public std::invalid_argument {
 public:
  SceneFileError(const std::string& file_name, std::vector<SceneFileProblem> problems);
  const std::vector<SceneFileProblem>& problems() const {
    return problems_;
  }  ///< all, in the order of the file

 private:
  std::vector<SceneFileProblem> problems_;
};

/// No text that is read is longer [bytes]: some million bodies.
constexpr std::size_t kMostTextBytes = std::size_t{1} << 30;
/// All of a file, which may be a pipe.  @throws SceneFileError if it cannot be read or is longer than
/// kMostTextBytes.
std::string read_text_file(const std::filesystem::path& path);

/// What is only strange is in `warnings` of the scene, a line each.
/// @throws SceneFileError if the file cannot be read or anything in it is wrong.
Scene load_scene_file(const std::filesystem::path& path);
/// Reads the text of a scene file in memory; `file_name` is for the messages, its stem the default name of
/// the scene, and mesh files are looked for in its folder.
/// @param by_hand false for a text that a program has made of something else: its lines are nobody's, and
/// what looks like a slip of the hand is none
Scene parse_scene(std::string_view text, const std::string& file_name, bool by_hand = true);

}  // namespace taut
