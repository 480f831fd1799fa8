#include "scenes/export/exports.h"

#include <cerrno>
#include <functional>
#include <system_error>

#include "core/base/check.h"
#include "scenes/export/gltf_export.h"
#include "scenes/export/html_export.h"
#include "scenes/export/svg_plot.h"
#include "scenes/export/vtk_export.h"
#include "scenes/recording/recorder.h"
#include "scenes/support/file_ending.h"
#include "scenes/support/output_file.h"

namespace taut {
namespace {

bool write_csv(RecordingReader& recording, std::ostream& out) {
  out << "time";
  for (const RecordedScalar& scalar : recording.header().scalars) out << ',' << csv_field(scalar.name);
  out << '\n';
  for (int i = 0; i < recording.frame_count(); ++i) {
    const Frame& frame = recording.frame(i);
    out << shortest(frame.time);
    for (const double value : frame.scalars) out << ',' << shortest(value);
    out << '\n';
  }
  return out.good();
}

/// What keeps something from being made, if anything.
void attempt(const std::string& what, const std::function<std::string()>& make,
             std::vector<std::string>& errors) {
  std::string error;
  try {
    error = make();
  } catch (const std::exception& thrown) {
    error = what + ": " + thrown.what();
  }
  if (!error.empty()) errors.push_back("could not write " + error);
}

/// A file that could not be written to its end is none: half a page looks like a page.
std::string make_file(const std::string& file, const std::function<bool(std::ostream&)>& write) {
  OutputFile output(file);
  const bool good = output.error().empty() && write(output.out());
  if (good || !output.flush()) return output.finish() ? "" : output.error();
  return file + ": it cannot be made";
}

}  // namespace

void check_exports(const ExportFiles& files) {
  require_ending("--html", files.html, FileKind::kPage);
  require_ending("--gltf", files.gltf, FileKind::kAnimation);
  require_ending("--plot", files.plot, FileKind::kPicture);
  require_ending("--csv", files.csv, FileKind::kTable);
  require_folder_name("--vtk", files.vtk_folder);
  require_writable("--html", files.html);
  require_writable("--gltf", files.gltf);
  require_writable("--plot", files.plot);
  require_writable("--csv", files.csv);
  require_writable_folder("--vtk", files.vtk_folder);
  if (!files.html.empty()) (void)find_three();
}

ExportOutcome export_recording(RecordingReader& recording, const ExportFiles& files,
                               RecordingReader* beside) {
  for (const RecordingReader* each : {&recording, beside})
    if (each && each->frame_count() == 0)
      fail("recording", "has no frames, so there is nothing to show", each->file().string());
  ExportOutcome outcome;
  const auto make = [&](const std::string& file, const std::function<bool(std::ostream&)>& write) {
    if (!file.empty())
      attempt(
          file, [&] { return make_file(file, write); }, outcome.errors);
  };
  make(files.html, [&](std::ostream& out) {
    const HtmlPage page = html_page(recording, beside);
    if (!page.note.empty()) outcome.notes.push_back(files.html + ": " + page.note);
    return (out << page.text).good();
  });
  make(files.gltf, [&](std::ostream& out) { return write_gltf(recording, out); });
  const auto vtk = [&]() -> std::string {
    errno = 0;
    if (write_vtk(recording, files.vtk_folder)) return "";
    return files.vtk_folder + (errno != 0 ? ": " + std::generic_category().message(errno) : "");
  };
  if (!files.vtk_folder.empty()) attempt(files.vtk_folder, vtk, outcome.errors);
  make(files.plot, [&](std::ostream& out) { return (out << svg_plot(recording)).good(); });
  make(files.csv, [&](std::ostream& out) { return write_csv(recording, out); });
  return outcome;
}

}  // namespace taut
