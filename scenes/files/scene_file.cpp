#include "scenes/files/scene_file.h"

#include <algorithm>
#include <fstream>
#include <vector>

#include "scenes/files/json_document.h"
#include "scenes/files/json_positions.h"
#include "scenes/files/scene_reader.h"
#include "scenes/support/suggestion.h"

namespace taut {
namespace {

/// Longer names are left out of messages.
constexpr std::size_t kLongestShownName = 60;

std::string lines(const std::string& file_name, const std::vector<SceneFileProblem>& problems) {
  std::string all;
  for (const SceneFileProblem& problem : problems) {
    if (!all.empty()) all += '\n';
    all += problem.text(file_name);
  }
  return all;
}

bool is_index(const std::string& token) {
  return !token.empty() && token.size() < 10 && token.find_first_not_of("0123456789") == token.npos;
}

bool fits_a_line(const std::string& name) {
  return name.size() <= kLongestShownName &&
         std::none_of(name.begin(), name.end(), [](unsigned char c) { return c < 0x20; });
}

/// The name of what a path leads into, such as that of a joint: the last "name" on the way from the lists at
/// the top.
std::string name_on_the_way(const nlohmann::json& document, const std::string& path) {
  std::string name;
  const nlohmann::json* at = &document;
  for (std::size_t begin = 1; begin < path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    const std::string token = path.substr(begin, end - begin);  // names of items stand below arrays only
    if (at->is_array() && is_index(token)) {
      const std::size_t index = std::stoul(token);
      if (index >= at->size()) return name;
      at = &(*at)[index];
      if (at->is_object() && at->contains("name") && at->at("name").is_string())
        name = at->at("name").get<std::string>();
    } else if (at->is_object() && at->contains(token)) {
      at = &(*at)[token];
    } else {
      return name;
    }
    begin = end + 1;
  }
  return path.ends_with("/name") || !fits_a_line(name) ? "" : name;  // its own value says it
}

void add_names(const nlohmann::json& document, std::vector<SceneFileProblem>& problems) {
  for (SceneFileProblem& problem : problems)
    if (problem.name.empty() && !problem.path.empty()) problem.name = name_on_the_way(document, problem.path);
}

}  // namespace

std::string SceneFileProblem::text(const std::string& file_name) const {
  std::string result = file_name;
  if (line > 0) result += ":" + std::to_string(line) + ":" + std::to_string(column);
  if (!path.empty()) result += ": " + path;
  if (!name.empty() && message.find("\"" + name + "\"") == message.npos) result += " of \"" + name + "\"";
  result += ": " + message;
  return value.empty() ? result : result + " (value: " + value + ")";
}

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

Scene parse_scene(std::string_view text, const std::string& file_name, bool by_hand) {
  Problems problems;
  problems.by_hand = by_hand;
  Scene scene;
  const std::filesystem::path path(file_name);
  if (const auto document = parse_json(text, problems)) {
    scene = SceneReader(problems, path.parent_path()).read(*document, path.stem().string());
    if (by_hand && !problems.has_w_first)
      problems.warnings.insert(problems.warnings.end(), problems.perhaps_w_last.begin(),
                               problems.perhaps_w_last.end());
    add_names(*document, problems);
    add_names(*document, problems.warnings);
  }
  if (by_hand) locate(text, problems), locate(text, problems.warnings);
  if (!problems.empty()) throw SceneFileError(file_name, std::move(problems));
  for (const SceneFileProblem& warning : problems.warnings)
    if (std::string line = warning.text(file_name);
        std::find(scene.warnings.begin(), scene.warnings.end(), line) == scene.warnings.end())
      scene.warnings.push_back(std::move(line));  // a value may have been read twice
  return scene;
}

}  // namespace taut
