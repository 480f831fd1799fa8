#include "scenes/exports.h"

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <functional>
#include <system_error>

#include "core/check.h"
#include "scenes/gltf_export.h"
#include "scenes/html_export.h"
#include "scenes/recorder.h"
#include "scenes/svg_plot.h"
#include "scenes/vtk_export.h"

namespace taut {
namespace {

void check_writable(const char* option, const std::string& file) {
  if (file.empty()) return;
  if (!std::ofstream(file, std::ios::binary)) fail(option, "cannot write the file", file);
}

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
  if (!files.html.empty()) (void)find_three();
  check_writable("--html", files.html);
  check_writable("--gltf", files.gltf);
  check_writable("--plot", files.plot);
  check_writable("--csv", files.csv);
  if (files.vtk_folder.empty()) return;
  std::error_code error;
  std::filesystem::create_directories(files.vtk_folder, error);
  if (error) fail("--vtk", "cannot make the folder: " + error.message(), files.vtk_folder);
  check_writable("--vtk", files.vtk_folder + "/bodies.pvd");
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
