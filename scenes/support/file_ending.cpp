#include "scenes/support/file_ending.h"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <vector>

#include "core/base/check.h"

namespace taut {
namespace {

struct EndingsOfKind {
  FileKind kind;
  std::vector<std::string_view> endings;  // the usual one first
  bool needed;                            // programs know what it is by nothing else
  const char* what;
};

const std::vector<EndingsOfKind>& endings_of_kinds() {
  static const std::vector<EndingsOfKind> all{
      {FileKind::kPage, {".html", ".htm"}, true, "a page"},
      {FileKind::kAnimation, {".glb"}, true, "binary glTF"},
      {FileKind::kPicture, {".svg"}, true, "a picture"},
      {FileKind::kTable, {".csv", ".txt", ".dat", ".tsv"}, false, "a table"},
      {FileKind::kJson, {".json"}, false, "JSON"},
      {FileKind::kRecording, {".taut"}, false, "a recording"},
  };
  return all;
}

/// Of files that no command writes under such an option.
constexpr std::string_view kOtherEndings[] = {".gltf", ".vtk", ".vtu",  ".vtp", ".pvd",
                                              ".png",  ".jpg", ".jpeg", ".pdf", ".xml",
                                              ".urdf", ".sdf", ".obj",  ".stl", ".md"};

bool is_of_a_file(std::string_view ending) {
  return std::ranges::find(kOtherEndings, ending) != std::end(kOtherEndings) ||
         std::ranges::any_of(endings_of_kinds(), [&](const EndingsOfKind& kind) {
           return std::ranges::find(kind.endings, ending) != kind.endings.end();
         });
}

/// There, and no regular file, as /dev/stdout and pipes.
bool is_special(const std::string& file) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  return std::filesystem::exists(status) && !std::filesystem::is_regular_file(status);
}

}  // namespace

std::string ending_of(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return ending;
}

void require_ending(const char* option, const std::string& file, FileKind kind) {
  if (file.empty() || is_special(file)) return;
  const EndingsOfKind& of_kind = *std::ranges::find(endings_of_kinds(), kind, &EndingsOfKind::kind);
  const std::string ending = ending_of(file);
  if (ending.empty() || std::ranges::find(of_kind.endings, ending) != of_kind.endings.end()) return;
  if (of_kind.needed || is_of_a_file(ending))
    fail(option,
         std::string("writes ") + of_kind.what + ", its file must end in " + std::string(of_kind.endings[0]),
         file);
}

void require_folder_name(const char* option, const std::string& folder) {
  std::error_code error;
  if (folder.empty() || std::filesystem::is_directory(folder, error)) return;
  if (is_of_a_file(ending_of(folder)))
    fail(option, "writes several files into a folder, whose name must not end like that of a file", folder);
}

}  // namespace taut
