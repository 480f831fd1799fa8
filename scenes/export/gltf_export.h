#pragma once

#include <iosfwd>

#include "scenes/recording/recording_reader.h"

namespace taut {

/// Writes a binary glTF 2.0 file with one node per body, whose translation and rotation are animated.  Up
/// (against gravity; z without gravity) becomes +y as glTF has it; time starts at 0.
/// @returns false if it could not be written.
bool write_gltf(RecordingReader& recording, std::ostream& out);

}  // namespace taut
