#include "scenes/recording/film.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "core/base/check.h"
#include "scenes/recording/frame_sampler.h"
#include "scenes/support/temporary_folder.h"

namespace taut {
namespace {

constexpr double kNearInstant = 5e-7;  // [s]

bool is_of_joint(Probe::Quantity quantity) {
  return quantity == Probe::Quantity::kReactionForce || quantity == Probe::Quantity::kReactionTorque ||
         quantity == Probe::Quantity::kGap;
}

Scene scene_of(const World& world) {
  Scene own;
  own.name = "simulation";
  own.world = world;
  return own;
}

}  // namespace

Film::Film(const Scene& scene, const std::string& file, double frames_per_second)
    : Film(std::nullopt, &scene, file, frames_per_second) {}

Film::Film(const World& world, const std::string& file, double frames_per_second)
    : Film(scene_of(world), nullptr, file, frames_per_second) {}

Film::Film(std::optional<Scene> own, const Scene* scene, const std::string& file, double frames_per_second)
    : own_(std::move(own)),
      scene_(own_ ? *own_ : *scene),
      sampler_(std::make_unique<FrameSampler>(scene_)),
      interval_(frames_per_second > 0 ? 1 / frames_per_second : 0),
      next_(scene_.world.time()),
      file_(file) {
  require_not_negative("frames_per_second", frames_per_second);
  for (const Probe& probe : scene_.probes)
    if (is_of_joint(probe.quantity)) (void)scene_.world.joint(probe.joint);  // throws if it is not there
  if (file.empty()) {
    folder_ = std::make_unique<TemporaryFolder>("film");
    file_ = folder_->path() / "run.taut";
  }
  writer_.emplace(file_, sampler_->header(frames_per_second));
}

Film::~Film() = default;

void Film::set_contact_source(ContactSource source) { sampler_->set_contact_source(std::move(source)); }

bool Film::sample(Simulator& simulator) {
  const double time = simulator.world().time();
  if (!finished_ && time < next_ - kNearInstant) return false;
  return take(simulator);
}

bool Film::sample_now(Simulator& simulator) {
  if (!finished_ && simulator.world().time() <= last_) return false;
  return take(simulator);
}

bool Film::take(Simulator& simulator) {
  if (finished_) throw std::invalid_argument("film: it is finished");
  if (Parts(simulator.world()) != parts_)
    throw std::invalid_argument(
        "film: bodies, joints, forces or shapes were added since it began; make a new one");
  const double time = simulator.world().time();
  // A step may pass several instants; the frame is of the last of them.
  if (interval_ > 0 && time >= next_ - kNearInstant)
    next_ += interval_ * std::max(1.0, std::floor((time + kNearInstant - next_) / interval_) + 1);
  last_ = time;
  if (!writer_->append(sampler_->sample(simulator))) throw std::runtime_error(writer_->error());
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

}  // namespace taut
