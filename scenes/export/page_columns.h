#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/math/so3.h"
#include "scenes/support/byte_order.h"

/// The columns of 16-bit words that the data of a page consists of (scenes/export/viewer/data.js reads them).
namespace taut {

using Words = std::vector<std::uint16_t>;

/// IEEE 754 binary16, rounded to nearest; overflow gives infinity.
std::uint16_t half_float(float value);

/// Columns one behind the other, each with its place in the description.
class ColumnWriter {
 public:
  ColumnWriter(nlohmann::json& description, std::string& bytes) : description_(description), bytes_(bytes) {
    description_["columns"] = nlohmann::json::object();
  }

  template <typename Number>
  void plain(const char* name, const std::vector<Number>& values) {
    begin(name, values.size());
    for (const Number value : values) append_little(bytes_, value);
  }
  /// 16-bit words of all frames as differences to what the last `order` frames predict (0: nothing, 1: they
  /// stay, 2: they go on as they went), modulo 2¹⁶, low bytes first and then high bytes.
  void predicted(const char* name, Words words, std::size_t per_frame, int order);
  /// The number by which a reader multiplies what a column holds.
  void scale(const char* name, double scale) { description_["columns"][name]["scale"] = scale; }

 private:
  void begin(const char* name, std::size_t count);

  nlohmann::json& description_;
  std::string& bytes_;
};

/// Numbers of one kind as halves of their largest absolute value; 8 bits of mantissa are kept.
struct HalfColumn {
  std::vector<float> values;

  void add(double value);
  void add(const Vec3& v);
  bool is_zero() const;
  float largest() const;
  Words words() const;
  /// A column that is all zero is left out.
  void write(ColumnWriter& columns, const char* name, std::size_t per_frame) const;
};

}  // namespace taut
