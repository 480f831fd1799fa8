#include <zlib.h>

#include <stdexcept>
#include <string>

#include "scenes/import/height_picture.h"
#include "tests/fuzz/input_file.h"

// PNG files of height fields.  Sums of their parts are made right, or nearly all would end there.

namespace {

std::size_t number_at(const std::string& bytes, std::size_t at) {
  std::size_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

void make_sums_right(std::string& bytes) {
  for (std::size_t at = 8; at + 12 <= bytes.size();) {
    const std::size_t size = number_at(bytes, at);
    if (size > bytes.size() - at - 12) return;
    const auto sum = crc32(crc32(0, nullptr, 0), reinterpret_cast<const Bytef*>(bytes.data() + at + 4),
                           static_cast<uInt>(size + 4));
    for (std::size_t i = 0; i < 4; ++i)
      bytes[at + 8 + size + i] = static_cast<char>(sum >> (24 - 8 * i) & 0xff);
    at += size + 12;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace taut::fuzz;
  std::string bytes(text_of(data, size));
  make_sums_right(bytes);
  try {
    const taut::model::HeightPicture picture = taut::model::read_png(bytes);
    const auto count = static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
    if (picture.values.size() != count) found("a picture without all its values");
    for (const double value : picture.values)
      if (!(value >= 0 && value <= 1)) found("a value that is not from 0 to 1");
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
