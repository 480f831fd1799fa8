#pragma once

#include <optional>

#include "scenes/python/session.h"
#include "scenes/recording/film.h"

namespace taut::python {

/// A Film of a Session, whose simulator is asked with the GIL.
class SessionFilm {
 public:
  /// @param scene with drawings and probes; null: none
  /// @throws std::invalid_argument for a file that cannot be written, a negative rate, or a scene of another
  /// world.
  SessionFilm(nb::object simulator, const Scene* scene, const std::string& file, double frames_per_second);

  const nb::object& simulator() const { return simulator_; }
  Film& film() { return *film_; }
  /// Takes a frame if the next instant k / frames_per_second has come (within half a microsecond), or if told
  /// to.
  /// @throws std::runtime_error if it cannot be written, std::invalid_argument if the world has got new parts
  /// since.
  bool sample(bool now);

 private:
  nb::object simulator_;
  Session& session_;
  std::optional<Scene> scene_;  // a copy: Python may change or drop its own
  std::optional<Film> film_;
};

}  // namespace taut::python
