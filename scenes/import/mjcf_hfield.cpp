#include "scenes/import/mjcf_hfield.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>

#include "core/base/check.h"
#include "scenes/import/height_picture.h"
#include "scenes/support/file_ending.h"

namespace taut::model {
namespace {

/// Heights in any unit, x fastest, from the side of −y.
struct Elevations {
  int columns = 0, rows = 0;
  std::vector<double> values;
};

/// Two whole numbers of 32 bits, rows and columns, and as many heights in single precision, from the side of
/// −y, in the order of bytes of this machine.
Elevations read_binary_field(std::string_view bytes) {
  std::int32_t size[2] = {0, 0};
  if (bytes.size() < sizeof size) fail("hfield", "its file ends early, after bytes", bytes.size());
  std::memcpy(size, bytes.data(), sizeof size);
  bytes.remove_prefix(sizeof size);
  if (size[0] < 2 || size[1] < 2) fail("hfield", "needs two rows and columns", std::min(size[0], size[1]));
  const long long count = static_cast<long long>(size[0]) * size[1];
  if (count > kMostHeights) fail("hfield", "has more than 4200000 heights", count);
  if (bytes.size() != static_cast<std::size_t>(count) * sizeof(float))
    fail("hfield", "has not as many bytes of heights as rows and columns", bytes.size());
  Elevations result{size[1], size[0], {}};
  for (long long i = 0; i < count; ++i) {
    float value = 0;
    std::memcpy(&value, bytes.data() + static_cast<std::size_t>(i) * sizeof value, sizeof value);
    require_finite("hfield", value);
    result.values.push_back(value);
  }
  return result;
}

/// A picture counts with 8 bits, its first row at +y.
Elevations read_field_file(const MjcfElement& hfield, const MjcfCompiler& compiler) {
  const std::filesystem::path file(hfield.text("file"));
  const std::string bytes = read_named_file(hfield.files().folder(hfield.node()), compiler.asset(file));
  if (ending_of(file) != ".png" && hfield.text("content_type") != "image/png")
    return read_binary_field(bytes);
  HeightPicture picture = read_png(bytes);
  if (picture.bits == 16)
    for (double& value : picture.values) value = std::floor(value * 65535 / 256);
  turn_rows(picture.values, picture.width);
  return {picture.width, picture.height, std::move(picture.values)};
}

/// The first row of the text is at +y.
Elevations read_field_text(const MjcfElement& hfield) {
  const double rows = hfield.number("nrow", 0), columns = hfield.number("ncol", 0);
  if (!(rows >= 2 && columns >= 2 && rows * columns <= static_cast<double>(kMostHeights)))
    hfield.fail("\"nrow\" and \"ncol\" must be 2 or more, of at most 4200000 heights");
  Elevations result{static_cast<int>(columns), static_cast<int>(rows), hfield.numbers("elevation")};
  const auto count = static_cast<std::size_t>(result.columns) * static_cast<std::size_t>(result.rows);
  if (result.values.empty()) result.values.assign(count, 0.0);
  if (result.values.size() != count)
    hfield.fail("\"elevation\" must have nrow·ncol numbers (value: " + std::to_string(result.values.size()) +
                ")");
  turn_rows(result.values, result.columns);
  return result;
}

/// The lowest height is 0, the highest that of the size.
HeightField scaled_field(const Elevations& given, const Vec3& size) {
  const auto [low, high] = std::ranges::minmax(given.values);
  std::vector<double> heights;
  for (double value : given.values)
    heights.push_back(high > low ? (value - low) / (high - low) * size.z() : 0.0);
  return field_over(given.columns, given.rows, size, std::move(heights));
}

}  // namespace

MjcfFields::MjcfFields(XmlFiles& files, const MjcfDefaults& defaults, const MjcfCompiler& compiler,
                       const pugi::xml_node& mujoco, std::vector<ImportNotice>& notices) {
  for (const pugi::xml_node& asset : files.children(mujoco, "asset"))
    for (const pugi::xml_node& node : files.children(asset, "hfield"))
      files.attempt([&] { read(defaults.element(node, ""), compiler, notices); });
}

void MjcfFields::read(const MjcfElement& hfield, const MjcfCompiler& compiler,
                      std::vector<ImportNotice>& notices) {
  XmlFiles& files = hfield.files();
  const pugi::xml_node& node = hfield.node();
  const std::string file = hfield.text("file");
  Entry& entry = fields_[hfield.text("name", std::filesystem::path(file).stem().string().c_str())];
  const char* text = files.required(node, "size");
  const auto size = exactly(files, node, "size", text, 4);  // half x, half y, z, and of the base
  for (double length : size) positive(files, node, "size", length);
  try {
    entry.field = scaled_field(file.empty() ? read_field_text(hfield) : read_field_file(hfield, compiler),
                               {2 * size[0], 2 * size[1], size[2]});
  } catch (const ImportError&) {
    throw;
  } catch (const std::invalid_argument& error) {
    entry.problem = hfield.place().text() + ": " + error.what();
    return;
  }
  if (file.empty() && !node.attribute("elevation"))
    notices.push_back({hfield.place(), "<hfield> whose heights a program sets later: it is flat", 1});
  notices.push_back(
      {hfield.place(), "<hfield>: it has no base and no sides, all that is below it is solid", 1});
}

const HeightField& MjcfFields::field(const std::string& name) const {
  const auto found = fields_.find(name);
  if (found == fields_.end()) fail("hfield", "there is none of this name" + near_name(name, fields_), name);
  if (!found->second.problem.empty()) throw std::invalid_argument(found->second.problem);
  return found->second.field;
}

}  // namespace taut::model
