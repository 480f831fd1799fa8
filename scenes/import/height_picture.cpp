#include "scenes/import/height_picture.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>

#include "core/base/check.h"
#include "scenes/files/scene_file.h"
#include "scenes/import/mesh_shape.h"

namespace taut::model {
namespace {

std::uint32_t big_endian_at(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  return value;
}

/// What the chunks of a PNG say.
struct PngFile {
  int width = 0, height = 0, bits = 0, colours = 0;
  std::string packed;                  ///< a zlib stream of rows
  std::array<std::uint8_t, 256> reds;  ///< of a palette

  int channels() const { return colours == 2 ? 3 : colours == 4 ? 2 : colours == 6 ? 4 : 1; }
  std::size_t bits_per_pixel() const {
    return static_cast<std::size_t>(channels()) * static_cast<std::size_t>(bits);
  }
  std::size_t row_bytes() const { return (static_cast<std::size_t>(width) * bits_per_pixel() + 7) / 8; }
};

void read_png_head(std::string_view data, PngFile& png) {
  if (data.size() != 13) fail("PNG", "has a wrong header of length", data.size());
  const std::uint32_t width = big_endian_at(data, 0), height = big_endian_at(data, 4);
  constexpr std::uint32_t kLongest = 1 << 20;
  if (width < 2 || height < 2)
    fail("PNG", "must be at least 2 pixels wide and high", std::min(width, height));
  if (width > kLongest || height > kLongest || static_cast<long long>(width) * height > kMostHeights)
    fail("PNG", "has more than 4200000 pixels", static_cast<double>(width) * height);
  png.width = static_cast<int>(width), png.height = static_cast<int>(height);
  png.bits = static_cast<std::uint8_t>(data[8]), png.colours = static_cast<std::uint8_t>(data[9]);
  constexpr int kSorts[][2] = {{0, 1}, {0, 2}, {0, 4}, {0, 8}, {0, 16}, {2, 8}, {2, 16}, {3, 1},
                               {3, 2}, {3, 4}, {3, 8}, {4, 8}, {4, 16}, {6, 8}, {6, 16}};
  if (std::ranges::none_of(kSorts, [&](const int(&s)[2]) { return s[0] == png.colours && s[1] == png.bits; }))
    fail("PNG", "has a colour type that there is not, or not with its depth", png.colours);
  if (data[12] != 0) fail("PNG", "is interlaced, which is not read", static_cast<int>(data[12]));
}

PngFile read_png_chunks(std::string_view bytes) {
  constexpr std::string_view kSignature("\x89PNG\r\n\x1a\n", 8);
  if (!bytes.starts_with(kSignature)) fail("picture", "is no PNG", std::string(bytes.substr(0, 4)));
  PngFile png;
  png.reds.fill(0);
  for (std::size_t at = kSignature.size();;) {
    if (bytes.size() - at < 12) fail("PNG", "ends early, after bytes", bytes.size());
    const std::size_t size = big_endian_at(bytes, at);
    if (size > bytes.size() - at - 12) fail("PNG", "ends early, after bytes", bytes.size());
    const std::string_view kind = bytes.substr(at + 4, 4), data = bytes.substr(at + 8, size);
    const auto sum =
        crc32(crc32(0, nullptr, 0), reinterpret_cast<const Bytef*>(kind.data()), static_cast<uInt>(size + 4));
    if (sum != big_endian_at(bytes, at + 8 + size)) fail("PNG", "is damaged in its part", std::string(kind));
    if (png.width == 0 && kind != "IHDR") fail("PNG", "does not begin with its header", std::string(kind));
    if (kind == "IHDR") read_png_head(data, png);
    if (kind == "PLTE")
      for (std::size_t i = 0; i < std::min<std::size_t>(256, size / 3); ++i)
        png.reds[i] = static_cast<std::uint8_t>(data[3 * i]);
    if (kind == "IDAT") png.packed += data;
    if (kind == "IEND") return png;
    at += size + 12;
  }
}

/// The nearest of left, above and left above to left + above − left above.
int nearest_of(int left, int above, int corner) {
  const int guess = left + above - corner;
  const int to_left = std::abs(guess - left), to_above = std::abs(guess - above),
            to_corner = std::abs(guess - corner);
  if (to_left <= to_above && to_left <= to_corner) return left;
  return to_above <= to_corner ? above : corner;
}

/// Rows are differences to what is left of them, `step` bytes away, and above.
void undo_filter(int kind, std::uint8_t* row, const std::uint8_t* above, std::size_t size, std::size_t step) {
  for (std::size_t i = 0; i < size; ++i) {
    const int left = i < step ? 0 : row[i - step], up = above ? above[i] : 0,
              corner = i < step || !above ? 0 : above[i - step];
    const int added = kind == 1   ? left
                      : kind == 2 ? up
                      : kind == 3 ? (left + up) / 2
                      : kind == 4 ? nearest_of(left, up, corner)
                                  : 0;
    row[i] = static_cast<std::uint8_t>(row[i] + added);
  }
}

/// The rows as bytes, with the kind of filter in front of each.
std::string unpacked_rows(const PngFile& png) {
  const std::size_t length = png.row_bytes() + 1, step = std::max<std::size_t>(1, png.bits_per_pixel() / 8);
  std::string rows(length * static_cast<std::size_t>(png.height), '\0');
  uLongf size = rows.size();
  auto* data = reinterpret_cast<std::uint8_t*>(rows.data());
  if (uncompress(data, &size, reinterpret_cast<const Bytef*>(png.packed.data()), png.packed.size()) != Z_OK ||
      size != rows.size())
    fail("PNG", "has not the pixels of its size; packed bytes", png.packed.size());
  for (int y = 0; y < png.height; ++y) {
    std::uint8_t* row = data + static_cast<std::size_t>(y) * length;
    if (row[0] > 4) fail("PNG", "has an unknown filter", static_cast<int>(row[0]));
    undo_filter(row[0], row + 1, y > 0 ? row + 1 - length : nullptr, length - 1, step);
  }
  return rows;
}

}  // namespace

HeightPicture read_png(std::string_view bytes) {
  const PngFile png = read_png_chunks(bytes);
  const std::string rows = unpacked_rows(png);
  HeightPicture picture{png.width, png.height, png.colours == 3 ? 8 : png.bits, {}};
  const double most = (1 << picture.bits) - 1;
  for (int y = 0; y < png.height; ++y)
    for (int x = 0; x < png.width; ++x) {
      const std::size_t bit = static_cast<std::size_t>(x) * png.bits_per_pixel();
      const std::size_t at = static_cast<std::size_t>(y) * (png.row_bytes() + 1) + 1 + bit / 8;
      int value = static_cast<std::uint8_t>(rows[at]);
      if (png.bits < 8) value = value >> (8 - png.bits - static_cast<int>(bit % 8)) & ((1 << png.bits) - 1);
      if (png.bits == 16) value = value << 8 | static_cast<std::uint8_t>(rows[at + 1]);
      if (png.colours == 3) value = png.reds[static_cast<std::size_t>(value)];
      picture.values.push_back(value / most);
    }
  return picture;
}

std::string read_named_file(const std::filesystem::path& folder, std::string_view name) {
  const std::filesystem::path path = find_asset("height field", folder, name);
  try {
    return read_text_file(path);
  } catch (const SceneFileError& error) {
    fail("height field", error.problems().front().message, path.string());
  }
}

void turn_rows(std::vector<double>& values, int columns) {
  const auto width = static_cast<std::ptrdiff_t>(columns);
  for (auto low = values.begin(), high = values.end() - width; low < high; low += width, high -= width)
    std::swap_ranges(low, low + width, high);
}

HeightField field_over(int columns, int rows, const Vec3& size, std::vector<double> heights) {
  HeightField field{columns, rows, size.x() / (columns - 1), size.y() / (rows - 1), std::move(heights)};
  check_shape(field);
  return field;
}

}  // namespace taut::model
