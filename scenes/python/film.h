#pragma once

#include <filesystem>
#include <optional>

#include "scenes/python/session.h"
#include "scenes/recording/frame_sampler.h"
#include "scenes/recording/recording_reader.h"
#include "scenes/recording/recording_writer.h"
#include "scenes/support/temporary_folder.h"

namespace taut::python {

/// The recording of a simulation that goes on, in a file of its own or a temporary one.
class Film {
 public:
  /// @param scene with drawings and probes; null: none
  /// @throws std::invalid_argument for a file that cannot be written, a negative rate, or a scene of another
  /// world.
  Film(nb::object simulator, const Scene* scene, const std::string& file, double frames_per_second);

  const nb::object& simulator() const { return simulator_; }
  /// Takes a frame if the next instant k / frames_per_second has come (within half a microsecond), or if told
  /// to.
  /// @throws std::runtime_error if it cannot be written, std::invalid_argument if the world has got new parts
  /// since.
  bool sample(bool now);
  void finish(const std::string& status, const std::string& message);
  int frame_count() const { return writer_->frame_count(); }
  const std::filesystem::path& file() const { return file_; }
  /// What was taken so far.
  RecordingReader reader();

 private:
  static Scene scene_of(const World& world, const Scene* scene);
  void require_same_parts(const World& world) const;

  nb::object simulator_;
  Session& session_;
  Scene scene_;
  FrameSampler sampler_{scene_};
  double interval_, next_, last_ = -1;
  std::optional<TemporaryFolder> folder_;
  std::filesystem::path file_;
  std::optional<RecordingWriter> writer_;
  bool finished_ = false;
};

}  // namespace taut::python
