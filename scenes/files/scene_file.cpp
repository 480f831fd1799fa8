#include "scenes/files/scene_file.h"

#include <fstream>
#include <vector>

#include "scenes/files/json_document.h"
#include "scenes/files/scene_reader.h"
#include "scenes/support/suggestion.h"

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
  const auto refuse = [&](const std::string& why) { throw SceneFileError(path.string(), {{"/", why, ""}}); };
  const std::string too_long =
      "the file is too long: at most " + std::to_string(kMostTextBytes) + " bytes are read";
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found)
    refuse("there is no such file" + did_you_mean_file(path));
  std::ifstream file;
  if (!std::filesystem::is_directory(status)) file.open(path, std::ios::binary);
  if (!file.is_open()) refuse("the file cannot be read");
  if (std::filesystem::is_regular_file(status) && std::filesystem::file_size(path, error) > kMostTextBytes &&
      !error)
    refuse(too_long);
  // Devices and pipes do not tell how long they are.
  std::string text;
  std::vector<char> block(std::size_t{1} << 16);
  while (file) {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    text.append(block.data(), static_cast<std::size_t>(file.gcount()));
    if (text.size() > kMostTextBytes) refuse(too_long);
  }
  if (file.bad()) refuse("the file cannot be read");
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
