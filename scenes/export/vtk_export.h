#pragma once

#include <filesystem>

#include "scenes/recording/recording_reader.h"

namespace taut {

/// Writes five series for ParaView into a folder, each with one .vtp file (XML PolyData, zlib) per frame:
/// bodies.pvd (surfaces with velocities and largest joint force), joints.pvd (points at the anchors with
/// force, torque and gap), wires.pvd (lines with force), springs.pvd (lines with tension) and contacts.pvd
/// (points with normal and force); and names.csv, which says what the indices mean.
/// @returns false if a file could not be written.
/// @throws std::filesystem::filesystem_error if the folder cannot be made.
bool write_vtk(RecordingReader& recording, const std::filesystem::path& folder);

}  // namespace taut
