#pragma once

#include <string>
#include <vector>

#include "scenes/recording/recording_reader.h"

namespace taut {

/// Curves over time as an SVG image: energies, the largest joint gap on a logarithmic axis, and each probe.
std::string svg_plot(RecordingReader& recording);

/// Round numbers for an axis from low to high, about `count` of them: 1, 2 or 5 times a power of ten apart.
/// @pre low < high, both finite
std::vector<double> axis_ticks(double low, double high, int count);

}  // namespace taut
