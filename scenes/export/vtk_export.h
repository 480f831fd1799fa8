#pragma once

#include <filesystem>

#include "scenes/recording/recording_reader.h"

namespace taut {

/// Writes three series for ParaView into a folder: bodies.pvd (surfaces with the body's index, velocity and
/// largest joint force per cell), joints.pvd (points at the anchors with force, torque and gap) and
/// contacts.pvd (points with normal and force), each with one .vtp file (XML PolyData, zlib) per frame; and
/// names.csv, which says what the indices mean.
/// @returns false if a file could not be written.
/// @throws std::filesystem::filesystem_error if the folder cannot be made.
bool write_vtk(RecordingReader& recording, const std::filesystem::path& folder);

}  // namespace taut
