#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scenes/builders/scene.h"
#include "scenes/recording/recording.h"
#include "scenes/recording/recording_reader.h"
#include "scenes/recording/recording_writer.h"
#include "solvers/simulator/simulator.h"

namespace taut {

class FrameSampler;
class TemporaryFolder;

/// The recording of a simulation that goes on:
///
///     Film film(scene);                                   // or film(world), of a world without a scene
///     while (…) { simulator.step(dt);  film.sample(simulator); }
///     RecordingReader recording = film.reader();
///     export_recording(recording, {.html = "run.html"});
///
/// What was taken can be read at any time, and from its file by `taut replay`.
class Film {
 public:
  /// @param scene gives drawings and probes; it must outlive this object
  /// @param file of the recording, written anew; "": a temporary one, which goes with this object
  /// @param frames_per_second of simulated time; 0: a frame at every call of sample()
  /// @throws std::invalid_argument, naming it, for a file that cannot be written, a negative rate, or a probe
  /// of a joint that the scene does not have.
  explicit Film(const Scene& scene, const std::string& file = "", double frames_per_second = 60);
  /// Of a world by itself: bodies are drawn by their shapes, and nothing is probed.  The world is copied.
  explicit Film(const World& world, const std::string& file = "", double frames_per_second = 60);
  Film(Scene&&, const std::string& = "", double = 60) = delete;
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;
  ~Film();  ///< Of a temporary file, too.

  /// Takes a frame of the present instant if the next instant k / frames_per_second has come (within half a
  /// microsecond); of several that a step has passed there is one frame.
  /// @returns whether it did.
  /// @throws std::runtime_error if it cannot be written, std::invalid_argument if the film is finished, or
  /// the world has got new bodies, joints, forces or shapes since it began.
  bool sample(Simulator& simulator);
  /// Takes a frame unless there is one of this instant.  @returns whether it did.
  /// @throws std::runtime_error if it cannot be written, std::invalid_argument if the film is finished, or
  /// the world has got new bodies, joints, forces or shapes since it began.
  bool sample_now(Simulator& simulator);
  /// Ends the recording: how the run ended, "success" as a rule, and why.  Once; later calls do nothing.
  /// @throws std::runtime_error if it cannot be written.
  void finish(const std::string& status = "success", const std::string& message = "");

  /// Appends the present contacts with their forces.
  using ContactSource = std::function<void(const Simulator&, std::vector<ContactSample>&)>;
  /// What frames have in place of the contacts of the simulator that give a force.
  void set_contact_source(ContactSource source);
  /// Frames that were taken.
  int frame_count() const { return writer_->frame_count(); }
  /// Of the recording.
  const std::filesystem::path& file() const { return file_; }
  /// What was taken so far; the file must still be there.
  /// @throws std::runtime_error if it cannot be written.
  RecordingReader reader();

 private:
  Film(std::optional<Scene> own, const Scene* scene, const std::string& file, double frames_per_second);
  bool take(Simulator& simulator);

  /// How many there are of what frames have entries for.
  struct Parts {
    int bodies, joints, forces, shapes;
    explicit Parts(const World& world)
        : bodies(world.body_count()),
          joints(world.joint_count()),
          forces(world.force_count()),
          shapes(world.shape_count()) {}
    bool operator==(const Parts&) const = default;
  };

  std::optional<Scene> own_;
  const Scene& scene_;
  Parts parts_{scene_.world};
  std::unique_ptr<FrameSampler> sampler_;
  double interval_, next_, last_ = -1;  // between frames, time of the next and of the last [s]
  std::unique_ptr<TemporaryFolder> folder_;
  std::filesystem::path file_;
  std::optional<RecordingWriter> writer_;
  bool finished_ = false;
};

}  // namespace taut
