#include "tests/scenes/import/corpus_checker.h"

#include <algorithm>

#include "scenes/import/import.h"
#include "tests/source_dir.h"

namespace taut::testing {

std::filesystem::path model_folder() {
  return std::filesystem::path(source_dir()) / "tests/scenes/import/models";
}

std::vector<std::string> model_files() {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(model_folder()))
    if (is_model_file(entry.path().string()))
      files.push_back(entry.path().lexically_relative(model_folder()).generic_string());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace taut::testing
