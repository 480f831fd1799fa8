#include "scenes/export/html_export.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <sstream>

#include "core/base/check.h"
#include "scenes/export/page_data.h"
#include "scenes/export/viewer_sources.h"
#include "scenes/recording/recording_chunk.h"
#include "scenes/support/base64.h"
#include "scenes/support/printable.h"
#include "scenes/support/program_path.h"

namespace taut {
namespace {

namespace fs = std::filesystem;

constexpr int kBest = 9, kFast = 6;  // effort of deflate

/// Modules in the order in which they need each other; a name that starts with three is of that package.
struct Module {
  const char* names;  ///< under which others import it
  const char* file;
};
constexpr Module kModules[] = {
    {"three.core.js", "build/three.core.js"},
    {"three three.module.js", "build/three.module.js"},
    {"three/addons/controls/OrbitControls.js", "examples/jsm/controls/OrbitControls.js"},
    {"colors.js", nullptr},
    {"data.js", nullptr},
    {"geometry.js", nullptr},
    {"instances.js", nullptr},
    {"plots.js", nullptr},
    {"view.js", nullptr},
    {"panel.js", nullptr},
    {"keys.js", nullptr},
    {"menus.js", nullptr},
    {"options.js", nullptr},
    {"overlay.js", nullptr},
    {"saving.js", nullptr},
    {"beside.js", nullptr},
    {"player.js", nullptr},
    {"live.js", nullptr},
    {"main.js", nullptr},
};

std::string read_file(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in || text.str().empty()) fail("--html", "cannot read a file of three.js", file.string());
  return text.str();
}

std::string modules(const fs::path& three) {
  std::string html;
  for (const auto& [names, file] : kModules) {
    const std::string source = file ? read_file(three / file) : std::string(viewer_source(names));
    html += "<script type=\"application/octet-stream\" data-module=\"" + std::string(names) + "\">" +
            base64(deflate(source, kBest)) + "</script>\n";
  }
  return html;
}

std::string escaped(std::string_view text) {
  std::string html;
  for (const char c : text) switch (c) {
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '&':
        html += "&amp;";
        break;
      case '"':
        html += "&quot;";
        break;
      default:
        html += c;
    }
  return html;
}

/// The template with every {{name}} replaced.
std::string filled(std::string_view page, const std::vector<std::pair<std::string, std::string>>& values) {
  std::string html;
  while (true) {
    const std::size_t open = page.find("{{"), close = page.find("}}");
    html += page.substr(0, open);
    if (open == std::string_view::npos) return html;
    const std::string_view name = page.substr(open + 2, close - open - 2);
    for (const auto& [key, value] : values)
      if (name == key) html += value;
    page.remove_prefix(close + 2);
  }
}

fs::path& own_three_folder() {
  static fs::path folder;
  return folder;
}

}  // namespace

void set_three_folder(std::filesystem::path folder) { own_three_folder() = std::move(folder); }

std::filesystem::path find_three() {
  std::vector<fs::path> places;
  if (const char* chosen = std::getenv("TAUT_THREE")) {
    places = {chosen};
  } else {
    places = {program_path().parent_path().parent_path() / "share/taut/three",
              fs::path(TAUT_SHARE_DIR) / "three", TAUT_THREE_DIR};
    if (!own_three_folder().empty()) places.insert(places.begin(), own_three_folder());
  }
  for (const fs::path& place : places)
    if (fs::exists(place / kModules[1].file) && fs::exists(place / kModules[0].file)) return place;
  fail("--html",
       "needs three.js, which is not there; `npm install --prefix scenes/export/viewer` in the sources of "
       "taut gets "
       "it, or set TAUT_THREE to the folder of the npm package",
       places.front().string());
}

std::string page_text(const PageData& data, const std::string& title, const PageData* second) {
  const auto script = [](const PageData& other) {
    return "<script type=\"application/octet-stream\" id=\"second\">" +
           base64(deflate(other.packed(), kFast)) + "</script>\n";
  };
  return filled(viewer_source("page.html"), {{"title", escaped(printable(title))},
                                             {"version", TAUT_VERSION},
                                             {"style", std::string(viewer_source("style.css"))},
                                             {"modules", modules(find_three())},
                                             {"data", base64(deflate(data.packed(), kFast))},
                                             {"second", second ? script(*second) : ""},
                                             {"loader", std::string(viewer_source("loader.js"))}});
}

HtmlPage html_page(RecordingReader& recording, RecordingReader* beside) {
  const std::size_t limit = kMostPageBytes / (beside ? 2 : 1);
  PageData data = page_data(recording, limit);
  std::optional<PageData> second;
  std::string title = recording.header().scene;
  if (beside) {
    second = page_data(*beside, limit);
    data.description["file"] = printable(recording.file().filename().string());
    second->description["file"] = printable(beside->file().filename().string());
    if (const std::string& other = beside->header().scene; other != title) title += " | " + other;
  }
  HtmlPage page;
  if (const int stride = std::max(data.stride, second ? second->stride : 1); stride > 1)
    page.note = "every " + std::to_string(stride) + "th frame only, to keep the page loadable";
  page.text = page_text(data, title, second ? &*second : nullptr);
  return page;
}

}  // namespace taut
