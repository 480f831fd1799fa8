#include "scenes/program/new_command.h"

#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/base/check.h"
#include "scenes/files/scene_schema.h"
#include "scenes/files/scene_texts.h"
#include "scenes/program/run_command.h"
#include "scenes/program/run_summary.h"
#include "scenes/support/output_file.h"
#include "scenes/support/program_path.h"
#include "scenes/support/suggestion.h"

namespace taut {
namespace {

namespace fs = std::filesystem;

struct Template {
  std::string name;  ///< of its file, without .json
  std::string_view text;
  /// Its first line without the slashes.
  std::string_view description() const { return text.substr(3, text.find('\n') - 3); }
};

std::vector<Template> templates() {
  std::vector<Template> all;
  for (const EmbeddedText& each : scene_texts())
    if (each.name != kSceneSchema) all.push_back({fs::path(each.name).stem().string(), each.text});
  return all;
}

/// Where an editor finds the schema: installed, or in the sources; else a name that has to be filled in.
std::string schema_place() {
  std::error_code error;
  for (const fs::path& place :
       {program_path().parent_path().parent_path() / "share/taut" / kSceneSchema, fs::path(TAUT_SCHEMA_FILE)})
    if (fs::exists(place, error)) return place.string();
  return std::string(kSceneSchema);
}

/// The template with the place of the schema in its "$schema".
std::string filled_in(std::string_view text) {
  constexpr std::string_view kKey = "\"$schema\": ";
  const std::size_t value = text.find(kKey) + kKey.size();
  std::string result(text.substr(0, value));
  result += nlohmann::json(schema_place()).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return result.append(text.substr(text.find(',', value)));
}

}  // namespace

int new_command(const NewOptions& options) {
  const std::vector<Template> all = templates();
  if (options.list) {
    for (const Template& each : all)
      std::cout << each.name << std::string(12 - std::min<std::size_t>(each.name.size(), 11), ' ')
                << each.description() << '\n';
    return kExitSuccess;
  }
  std::vector<std::string> names;
  const Template* chosen = nullptr;
  for (const Template& each : all) {
    names.push_back(each.name);
    if (each.name == options.name) chosen = &each;
  }
  if (!chosen)
    fail("--template", "must be one of " + quoted_list(names) + did_you_mean(options.name, names),
         options.name);
  if (options.file.empty()) fail("new", "needs the name of a file to write, for example arm.json", "");
  if (!options.file.ends_with(".json")) fail("new", "the file must end in .json", options.file);
  std::error_code error;
  if (!options.force && fs::exists(options.file, error))
    fail("new", "the file is there already; --force writes over it", options.file);
  require_writable("new", options.file);
  if (const std::string failed = write_output(options.file, filled_in(chosen->text)); !failed.empty()) {
    std::cerr << "taut: could not write " << failed << '\n';
    return kExitFailure;
  }
  const std::string program = shell_word(options.program), file = shell_word(options.file);
  std::cout << "wrote " << options.file << "; now: " << program << " check " << file << ", " << program
            << " run " << file << " --html page.html\n";
  return kExitSuccess;
}

int schema_command() {
  std::cout << scene_schema();
  return kExitSuccess;
}

}  // namespace taut
