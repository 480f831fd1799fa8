#pragma once

#include "scenes/support/embedded_text.h"

namespace taut {

/// The files of scenes/export/viewer.
std::span<const EmbeddedText> viewer_texts();
/// One of them; empty if there is none of that name.
inline std::string_view viewer_source(std::string_view name) { return text_of(viewer_texts(), name); }

}  // namespace taut
