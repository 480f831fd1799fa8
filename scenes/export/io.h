#pragma once

/// \file
/// Scenes and files for programs of one's own, from the library taut::io:
///
///     find_package(taut REQUIRED COMPONENTS io)
///     target_link_libraries(mine PRIVATE taut::io)
///
///     taut::Scene scene = taut::open_scene_or_model("arm.urdf");  // or "arm.json", or "bridge"
///     taut::Simulator simulator(scene.world, scene.settings);
///     taut::Film film(scene);
///     while (simulator.step(scene.dt).ok() && scene.world.time() < 5) film.sample(simulator);
///     taut::RecordingReader recording = film.reader();
///     taut::export_recording(recording, {.html = "arm.html", .gltf = "arm.glb"});
///
/// Everything throws std::invalid_argument, with the name and the value, for what it cannot use, and
/// std::runtime_error for files that cannot be written.

#include "scenes/builders/scene.h"
#include "scenes/export/exports.h"
#include "scenes/export/gltf_export.h"
#include "scenes/export/html_export.h"
#include "scenes/export/mjcf_export.h"
#include "scenes/export/svg_plot.h"
#include "scenes/export/urdf_export.h"
#include "scenes/export/vtk_export.h"
#include "scenes/files/scene_file.h"
#include "scenes/files/scene_source.h"
#include "scenes/files/state_file.h"
#include "scenes/import/import.h"
#include "scenes/recording/film.h"
#include "scenes/recording/recording_reader.h"
#include "solvers/taut.h"
