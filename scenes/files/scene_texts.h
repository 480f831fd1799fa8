#pragma once

#include "scenes/support/embedded_text.h"

namespace taut {

/// The JSON Schema of scene files, and the scenes of scenes/files/templates, as they are in the sources.
std::span<const EmbeddedText> scene_texts();

/// File name of the schema.
inline constexpr std::string_view kSceneSchema = "taut-scene.schema.json";

}  // namespace taut
