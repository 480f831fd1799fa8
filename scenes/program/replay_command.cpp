#include "scenes/program/replay_command.h"

#include <cstdio>
#include <iostream>

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

}  // namespace

int replay_command(const std::string& file, const ExportFiles& exports, bool quiet) {
  require_distinct({{"--html", exports.html},
                    {"--gltf", exports.gltf},
                    {"--plot", exports.plot},
                    {"--csv", exports.csv},
                    {"--vtk", exports.vtk_folder}},
                   {{"the recording", file}});
  RecordingReader recording(file);
  const std::string& damage = recording.damage();
  if (!damage.empty()) std::cerr << "taut: " << file << ": " << damage << '\n';
  if (recording.frame_count() == 0) fail("recording", "has no frames, so there is nothing to show", file);
  if (!quiet) print_summary(recording);
  check_exports(exports);
  const ExportOutcome outcome = export_recording(recording, exports);
  for (const std::string& note : outcome.notes) std::cerr << "taut: " << note << '\n';
  for (const std::string& error : outcome.errors) std::cerr << "taut: " << error << '\n';
  return damage.empty() && outcome.errors.empty() ? kExitSuccess : kExitFailure;
}

}  // namespace taut
