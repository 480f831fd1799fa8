#pragma once

#include <string>

namespace taut {

/// The JSON Schema of scene files: that of the sources, in which the definition of what acts along an axis is
/// made of the fields of its properties (core/axes).  `taut schema` prints it, and its output is the file in
/// the sources.
std::string scene_schema();

}  // namespace taut
