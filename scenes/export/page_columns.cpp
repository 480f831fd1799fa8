#include "scenes/export/page_columns.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace taut {

std::uint16_t half_float(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const auto sign = static_cast<std::uint16_t>(bits >> 16 & 0x8000);
  const float magnitude = std::abs(value);
  if (!(magnitude < 65520)) return static_cast<std::uint16_t>(sign | (std::isnan(value) ? 0x7e00 : 0x7c00));
  if (magnitude < 0x1p-14f)  // subnormal: multiples of 2⁻²⁴
    return static_cast<std::uint16_t>(sign | std::lrint(magnitude * 0x1p24f));
  int exponent;
  const float mantissa = std::frexp(magnitude, &exponent);             // in [½, 1)
  const auto rounded = static_cast<int>(std::lrint(mantissa * 2048));  // 1024 … 2048; a carry is right too
  return static_cast<std::uint16_t>(sign | (((exponent + 14) << 10) + rounded - 1024));
}

void ColumnWriter::begin(const char* name, std::size_t count) {
  while (bytes_.size() % 8 != 0) bytes_ += '\0';
  description_["columns"][name] = {{"offset", bytes_.size()}, {"count", count}};
}

void ColumnWriter::predicted(const char* name, Words words, std::size_t per_frame, int order) {
  begin(name, words.size());
  description_["columns"][name]["order"] = order;
  description_["columns"][name]["per_frame"] = per_frame;
  for (int pass = 0; pass < order; ++pass)
    for (std::size_t i = words.size(); i-- > per_frame;)
      words[i] = static_cast<std::uint16_t>(words[i] - words[i - per_frame]);
  for (const int shift : {0, 8})
    for (const std::uint16_t word : words) bytes_ += static_cast<char>(word >> shift & 255);
}

void HalfColumn::add(double value) {
  values.push_back(std::isfinite(value) ? static_cast<float>(value) : 0.0f);
}

void HalfColumn::add(const Vec3& v) {
  for (int i = 0; i < 3; ++i) add(v[i]);
}

bool HalfColumn::is_zero() const { return largest() == 0; }

float HalfColumn::largest() const {
  float most = 0;
  for (const float value : values) most = std::max(most, std::abs(value));
  return most;
}

Words HalfColumn::words() const {
  const float scale = largest();
  Words words;
  words.reserve(values.size());
  for (const float value : values)
    words.push_back(static_cast<std::uint16_t>((half_float(scale > 0 ? value / scale : 0.0f) + 2) & ~3));
  return words;
}

void HalfColumn::write(ColumnWriter& columns, const char* name, std::size_t per_frame) const {
  if (is_zero()) return;
  columns.predicted(name, words(), per_frame, 1);
  columns.scale(name, largest());
}

}  // namespace taut
