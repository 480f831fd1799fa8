#pragma once

#include <ostream>
#include <streambuf>

namespace taut {

/// While it lives, what is printed to a stream holds no control characters but newlines and tabs: names from
/// files must not move the cursor of a terminal, change its title or answer for its user.  C0 and DEL become
/// their pictures, as in printable(), and C1 (U+0080 … U+009F) U+FFFD.
class PrintableStream : public std::streambuf {
 public:
  explicit PrintableStream(std::ostream& stream);
  ~PrintableStream() override;
  PrintableStream(const PrintableStream&) = delete;
  PrintableStream& operator=(const PrintableStream&) = delete;

 protected:
  int_type overflow(int_type c) override;
  std::streamsize xsputn(const char* text, std::streamsize size) override;
  int sync() override;

 private:
  bool put(unsigned char byte);

  std::ostream& stream_;
  std::streambuf* target_;
  bool begun_ = false;  ///< 0xC2, with which C1 characters begin, is waiting for the byte after it
};

}  // namespace taut
