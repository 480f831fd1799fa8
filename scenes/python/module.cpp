#include "scenes/python/parts.h"

NB_MODULE(_taut, m) {
  using namespace taut::python;
  m.doc() = "Rigid multibody systems with very many joints, solved directly.";
  m.attr("__version__") = TAUT_VERSION;
  // A callback that refers to its own world lives as long as the process; a message about it at the end helps
  // nobody.
  nb::set_leak_warnings(false);
  bind_ids(m);
  bind_state(m);
  bind_axes(m);
  bind_bodies(m);
  bind_shapes(m);
  bind_world(m);
  bind_joints(m);
  bind_forces(m);
  bind_settings(m);
  bind_reports(m);
  bind_events(m);
  bind_simulator(m);
  bind_matrices(m);
  bind_analysis(m);
  bind_file_errors(m);
  bind_scenes(m);
  bind_models(m);
  bind_recording(m);
}
