#pragma once

#include "scenes/python/casters.h"

/// The concepts of the package, one source each; a concept may use types of those above it.
namespace taut::python {

void bind_ids(nb::module_& m);
void bind_state(nb::module_& m);
void bind_axes(nb::module_& m);
void bind_bodies(nb::module_& m);
void bind_shapes(nb::module_& m);
void bind_joints(nb::module_& m);
void bind_forces(nb::module_& m);
void bind_reports(nb::module_& m);
void bind_world(nb::module_& m);
void bind_settings(nb::module_& m);
void bind_events(nb::module_& m);
void bind_simulator(nb::module_& m);
void bind_analysis(nb::module_& m);
void bind_matrices(nb::module_& m);
void bind_file_errors(nb::module_& m);
void bind_scenes(nb::module_& m);
void bind_models(nb::module_& m);
void bind_recording(nb::module_& m);

}  // namespace taut::python
