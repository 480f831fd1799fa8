#include "scenes/python/film.h"

#include <cmath>

#include "core/base/check.h"
#include "scenes/support/output_file.h"

namespace taut::python {
namespace {

constexpr double kNear = 5e-7;  // [s]

bool is_of_joint(Probe::Quantity quantity) {
  return quantity == Probe::Quantity::kReactionForce || quantity == Probe::Quantity::kReactionTorque ||
         quantity == Probe::Quantity::kGap;
}

}  // namespace

Film::Film(nb::object simulator, const Scene* scene, const std::string& file, double frames_per_second)
    : simulator_(std::move(simulator)),
      session_(nb::cast<Session&>(simulator_)),
      scene_(scene_of(session_.world(), scene)),
      interval_(frames_per_second > 0 ? 1 / frames_per_second : 0),
      next_(session_.world().time()),
      file_(file) {
  require_not_negative("frames_per_second", frames_per_second);
  for (const Probe& probe : scene_.probes)
    if (is_of_joint(probe.quantity))
      (void)scene_.world.joint(probe.joint);  // throws for one that is not there
  require_writable("film", file);
  if (file.empty()) {
    folder_.emplace("film");
    file_ = folder_->path() / "run.taut";
  }
  writer_.emplace(file_, sampler_.header(frames_per_second));
}

Scene Film::scene_of(const World& world, const Scene* scene) {
  require_askable(world);
  if (scene) {
    if (&scene->world != &world)
      throw std::invalid_argument("film: the scene must be the one whose world is simulated");
    return *scene;
  }
  Scene own;
  own.name = "simulation";
  own.world = world;
  return own;
}

void Film::require_same_parts(const World& world) const {
  const World& then = scene_.world;
  if (world.body_count() != then.body_count() || world.joint_count() != then.joint_count() ||
      world.force_count() != then.force_count() || world.shape_count() != then.shape_count())
    throw std::invalid_argument(
        "film: bodies, joints, forces or shapes were added since it began; make a new one");
}

bool Film::sample(bool now) {
  if (finished_) throw std::invalid_argument("film: it is finished");
  const World& world = session_.world();
  require_askable(world);
  const double time = world.time();
  if (now ? time <= last_ : time < next_ - kNear) return false;
  require_same_parts(world);
  // A step may pass several instants; the frame is of the last of them.
  if (interval_ > 0 && time >= next_ - kNear)
    next_ += interval_ * std::max(1.0, std::floor((time + kNear - next_) / interval_) + 1);
  last_ = time;
  Frame frame = session_.ask([&](Simulator& simulator) { return sampler_.sample(simulator); });
  if (!writer_->append(std::move(frame))) throw std::runtime_error(writer_->error());
  return true;
}

void Film::finish(const std::string& status, const std::string& message) {
  if (finished_) return;
  finished_ = true;
  if (!writer_->finish(status, message)) throw std::runtime_error(writer_->error());
}

RecordingReader Film::reader() {
  if (!finished_ && !writer_->flush()) throw std::runtime_error(writer_->error());
  return RecordingReader(file_);
}

}  // namespace taut::python
