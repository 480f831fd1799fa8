#include "scenes/support/printable_stream.h"

#include <algorithm>
#include <string_view>

#include "scenes/support/printable.h"

namespace taut {
namespace {

constexpr unsigned char kC1Lead = 0xC2;

bool write_all(std::streambuf& target, std::string_view text) {
  const auto size = static_cast<std::streamsize>(text.size());
  return target.sputn(text.data(), size) == size;
}

/// Whether a byte can be written without a look at its neighbours.
bool is_plain(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return (byte >= 0x20 && byte != 0x7F && byte != kC1Lead) || c == '\n' || c == '\t';
}

}  // namespace

PrintableStream::PrintableStream(std::ostream& stream) : stream_(stream), target_(stream.rdbuf(this)) {}

PrintableStream::~PrintableStream() {
  if (begun_) target_->sputc(static_cast<char>(kC1Lead));
  const auto state = stream_.rdstate();
  stream_.rdbuf(target_);  // forgets the errors of the stream
  stream_.setstate(state);
}

bool PrintableStream::put(unsigned char byte) {
  const char c = static_cast<char>(byte);
  if (begun_) {
    begun_ = false;
    if (byte >= 0x80 && byte < 0xA0) return write_all(*target_, "\xEF\xBF\xBD");
    const char lead = static_cast<char>(kC1Lead);
    if (!write_all(*target_, {&lead, 1})) return false;
  }
  begun_ = byte == kC1Lead;
  if (begun_) return true;
  return is_plain(c) ? write_all(*target_, {&c, 1}) : write_all(*target_, printable({&c, 1}));
}

PrintableStream::int_type PrintableStream::overflow(int_type c) {
  if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
  return put(static_cast<unsigned char>(traits_type::to_char_type(c))) ? c : traits_type::eof();
}

std::streamsize PrintableStream::xsputn(const char* text, std::streamsize size) {
  for (std::streamsize at = 0; at < size;) {
    const char* end = begun_ ? text + at : std::find_if_not(text + at, text + size, is_plain);
    const std::string_view plain(text + at, static_cast<std::size_t>(end - (text + at)));
    if (!write_all(*target_, plain)) return at;
    at += static_cast<std::streamsize>(plain.size());
    if (at < size && !put(static_cast<unsigned char>(text[at++]))) return at - 1;
  }
  return size;
}

int PrintableStream::sync() { return target_->pubsync(); }

}  // namespace taut
