#pragma once

#include <filesystem>

#include "scenes/recording_reader.h"

namespace taut {

/// Writes a binary glTF 2.0 file with one node per body, whose translation and rotation are animated.  Up
/// (against gravity; z without gravity) becomes +y as glTF has it; time starts at 0.
/// @returns false if the file could not be written.
bool write_gltf(RecordingReader& recording, const std::filesystem::path& file);

}  // namespace taut
