#include "scenes/scene_file.h"

#include <fstream>
#include <iterator>

#include "scenes/json_document.h"
#include "scenes/scene_reader.h"

namespace taut {
namespace {

/// file: path: message (value: ...)
std::string lines(const std::string& file_name, const std::vector<SceneFileProblem>& problems) {
  std::string text;
  for (const SceneFileProblem& problem : problems) {
    text += (text.empty() ? "" : "\n") + file_name + ": " + problem.path + ": " + problem.message;
    if (!problem.value.empty()) text += " (value: " + problem.value + ")";
  }
  return text;
}

}  // namespace

SceneFileError::SceneFileError(const std::string& file_name, std::vector<SceneFileProblem> problems)
    : std::invalid_argument(lines(file_name, problems)), problems_(std::move(problems)) {}

std::string read_text_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text;
  std::error_code ignored;
  if (file && !std::filesystem::is_directory(path, ignored))
    text.assign(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  else
    file.setstate(std::ios::failbit);
  if (!file) throw SceneFileError(path.string(), {{"/", "the file cannot be read", ""}});
  return text;
}

Scene load_scene_file(const std::filesystem::path& path) {
  return parse_scene(read_text_file(path), path.string());
}

Scene parse_scene(std::string_view text, const std::string& file_name) {
  std::vector<SceneFileProblem> problems;
  Scene scene;
  const std::filesystem::path path(file_name);
  if (const auto document = parse_json(text, problems))
    scene = SceneReader(problems, path.parent_path()).read(*document, path.stem().string());
  if (!problems.empty()) throw SceneFileError(file_name, std::move(problems));
  return scene;
}

}  // namespace taut
