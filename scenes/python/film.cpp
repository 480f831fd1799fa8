#include "scenes/python/film.h"

#include "scenes/support/output_file.h"

namespace taut::python {

SessionFilm::SessionFilm(nb::object simulator, const Scene* scene, const std::string& file,
                         double frames_per_second)
    : simulator_(std::move(simulator)), session_(nb::cast<Session&>(simulator_)) {
  const World& world = session_.world();
  require_askable(world);
  if (scene && &scene->world != &world)
    throw std::invalid_argument("film: the scene must be the one whose world is simulated");
  require_writable("film", file);
  if (scene)
    film_.emplace(scene_.emplace(*scene), file, frames_per_second);
  else
    film_.emplace(world, file, frames_per_second);
}

bool SessionFilm::sample(bool now) {
  require_askable(session_.world());
  return session_.ask([&](Simulator& it) { return now ? film_->sample_now(it) : film_->sample(it); });
}

}  // namespace taut::python
