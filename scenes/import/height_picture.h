#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "core/world/shape.h"

/// Height fields of models, from pictures and files.
namespace taut::model {

/// No field has more heights: a little more than 2049 × 2049.
inline constexpr long long kMostHeights = 4'200'000;

/// The red of a picture, from 0 to 1, row by row from the top.
struct HeightPicture {
  int width = 0, height = 0;
  int bits = 8;  ///< of a value in the file
  std::vector<double> values;
};

/// A PNG [PNG 2003], of any colour type and depth, not interlaced.
/// @throws std::invalid_argument if it is none, is damaged, or has too many values.
HeightPicture read_png(std::string_view bytes);

/// The bytes of a file that a model names, found as meshes are.
/// @throws std::invalid_argument if there is none, or it cannot be read.
std::string read_named_file(const std::filesystem::path& folder, std::string_view name);

/// Rows from the top become rows from the side of −y.
void turn_rows(std::vector<double>& values, int columns);

/// A field over size.x × size.y with these heights, x fastest, from the side of −y.
HeightField field_over(int columns, int rows, const Vec3& size, std::vector<double> heights);

}  // namespace taut::model
