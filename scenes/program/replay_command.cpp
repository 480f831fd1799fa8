#include "scenes/program/replay_command.h"

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <vector>

#include "core/base/check.h"
#include "scenes/program/run_command.h"
#include "scenes/recording/recorder.h"
#include "scenes/support/output_file.h"

namespace taut {
namespace {

void print_summary(const RecordingReader& recording) {
  const RecordingHeader& header = recording.header();
  std::string parameters;
  for (const auto& [key, value] : header.parameters) parameters += " " + key + "=" + shortest(value);
  const auto line = [](const char* name, const std::string& value) {
    std::printf("%-26s%s\n", name, value.c_str());
  };
  line("scene", header.scene + parameters);
  line("bodies", std::to_string(header.bodies.size() - 1));
  line("joints", std::to_string(header.joints.size()));
  if (!header.springs.empty()) line("springs", std::to_string(header.springs.size()));
  const int frames = recording.frame_count();
  std::string span = std::to_string(frames);
  if (frames > 0)
    span += ", from " + shortest(recording.time(0)) + " to " + shortest(recording.time(frames - 1)) + " s";
  line("frames", span);
  for (const RecordedScalar& scalar : header.scalars) line("scalar", scalar.name + " [" + scalar.unit + "]");
  if (recording.end())
    line("status",
         recording.end()->status + (recording.end()->message.empty() ? "" : ": " + recording.end()->message));
}

/// Of what is damaged, what is readable can be shown.
RecordingReader opened(const std::string& file) {
  RecordingReader recording(file);
  if (!recording.damage().empty()) std::cerr << "taut: " << file << ": " << recording.damage() << '\n';
  if (recording.frame_count() == 0) fail("recording", "has no frames, so there is nothing to show", file);
  return recording;
}

/// All files that can be made; the first one, the page, also of two recordings.
std::vector<NamedFile> outputs_of(const ExportFiles& exports) {
  return {{"--html", exports.html},
          {"--gltf", exports.gltf},
          {"--plot", exports.plot},
          {"--csv", exports.csv},
          {"--vtk", exports.vtk_folder}};
}

}  // namespace

int replay_command(const std::string& file, const std::string& beside, const ExportFiles& exports,
                   bool quiet) {
  const std::vector<NamedFile> outputs = outputs_of(exports);
  require_distinct(outputs, {{"the recording", file}, {"the recording beside it", beside}});
  const auto of_one = std::find_if(outputs.begin() + 1, outputs.end(),
                                   [](const NamedFile& output) { return !output.file.empty(); });
  if (!beside.empty() && of_one != outputs.end())
    fail(of_one->option, "is made of one recording; of two there is a page, --html", of_one->file);
  std::vector<RecordingReader> recordings;
  recordings.push_back(opened(file));
  if (!beside.empty()) recordings.push_back(opened(beside));
  if (!quiet)
    for (const RecordingReader& recording : recordings) print_summary(recording);
  check_exports(exports);
  RecordingReader* const second = beside.empty() ? nullptr : &recordings.back();
  const ExportOutcome outcome = export_recording(recordings.front(), exports, second);
  for (const std::string& note : outcome.notes) std::cerr << "taut: " << note << '\n';
  for (const std::string& error : outcome.errors) std::cerr << "taut: " << error << '\n';
  const bool damaged = std::ranges::any_of(recordings, [](const auto& it) { return !it.damage().empty(); });
  return !damaged && outcome.errors.empty() ? kExitSuccess : kExitFailure;
}

}  // namespace taut
