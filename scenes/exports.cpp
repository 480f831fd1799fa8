#include "scenes/exports.h"

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <functional>
#include <system_error>

#include "core/check.h"
#include "scenes/gltf_export.h"
#include "scenes/html_export.h"
#include "scenes/output_file.h"
#include "scenes/recorder.h"
#include "scenes/svg_plot.h"
#include "scenes/vtk_export.h"

namespace taut {
namespace {

bool write_csv(RecordingReader& recording, const std::string& file) {
  std::ofstream out(file);
  out << "time";
  for (const RecordedScalar& scalar : recording.header().scalars) out << ',' << csv_field(scalar.name);
  out << '\n';
  for (int i = 0; i < recording.frame_count(); ++i) {
    const Frame& frame = recording.frame(i);
    out << shortest(frame.time);
    for (const double value : frame.scalars) out << ',' << shortest(value);
    out << '\n';
  }
  return static_cast<bool>(out.flush());
}

bool write_text(const std::string& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  return static_cast<bool>(out.flush());
}

/// A file that could not be written to its end is taken away: half a page looks like a page.
void make_file(const std::string& file, const std::function<bool()>& write,
               std::vector<std::string>& errors) {
  std::string reason;
  try {
    errno = 0;
    if (write()) return;
    if (errno != 0) reason = ": " + std::generic_category().message(errno);
  } catch (const std::exception& error) {
    reason = std::string(": ") + error.what();
  }
  errors.push_back("could not write " + file + reason);
  std::error_code ignored;
  if (std::filesystem::is_regular_file(file, ignored)) std::filesystem::remove(file, ignored);
}

}  // namespace

void check_exports(const ExportFiles& files) {
  require_writable("--html", files.html);
  require_writable("--gltf", files.gltf);
  require_writable("--plot", files.plot);
  require_writable("--csv", files.csv);
  require_writable_folder("--vtk", files.vtk_folder);
  if (!files.html.empty()) (void)find_three();
}

ExportOutcome export_recording(RecordingReader& recording, const ExportFiles& files) {
  if (recording.frame_count() == 0)
    fail("recording", "has no frames, so there is nothing to show", recording.file().string());
  ExportOutcome outcome;
  const auto make = [&](const std::string& file, const std::function<bool()>& write) {
    if (!file.empty()) make_file(file, write, outcome.errors);
  };
  make(files.html, [&] {
    const HtmlPage page = html_page(recording);
    if (!page.note.empty()) outcome.notes.push_back(files.html + ": " + page.note);
    return write_text(files.html, page.text);
  });
  make(files.gltf, [&] { return write_gltf(recording, files.gltf); });
  make(files.vtk_folder, [&] { return write_vtk(recording, files.vtk_folder); });
  make(files.plot, [&] { return write_text(files.plot, svg_plot(recording)); });
  make(files.csv, [&] { return write_csv(recording, files.csv); });
  return outcome;
}

}  // namespace taut
