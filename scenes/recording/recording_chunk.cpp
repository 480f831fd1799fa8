#include "scenes/recording/recording_chunk.h"

#include <zlib.h>

#include <algorithm>
#include <new>

#include "scenes/support/byte_order.h"

namespace taut {
namespace {

constexpr std::string_view kMark = "tCHK";
// The low bytes of floating-point numbers are noise: more effort than this costs time and gains nothing.
constexpr int kLevel = 2;

std::uint32_t checksum(std::string_view bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

/// Deflate shrinks by 1032 at most; anything larger is not a size but a trap.  Frames that do not move come
/// near to that.  The other chunks are JSON, which shrinks by some 20.
constexpr std::uint64_t kMostShrinking = 1040, kMostShrinkingOfText = 256;
/// Writers begin a new chunk after a megabyte, and a frame of ten million bodies is not met.
constexpr std::uint64_t kMostRawBytes = std::uint64_t{1} << 30;

bool is_plausible(const ChunkHead& head) {
  const std::uint64_t shrinking = head.type == kFramesChunk ? kMostShrinking : kMostShrinkingOfText;
  return head.raw_size <= kMostRawBytes && head.raw_size / shrinking <= head.stored_size;
}

}  // namespace

std::string deflate(std::string_view raw, int level) {
  uLongf size = compressBound(static_cast<uLong>(raw.size()));
  std::string stored(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(stored.data()), &size, reinterpret_cast<const Bytef*>(raw.data()),
                static_cast<uLong>(raw.size()), level) != Z_OK)
    throw std::bad_alloc();
  stored.resize(size);
  return stored;
}

std::string make_chunk(ChunkType type, std::string_view raw) {
  const std::string stored = deflate(raw, kLevel);
  std::string chunk;
  chunk.reserve(kChunkHeadSize + stored.size());
  chunk += kMark;
  chunk.append(type.data(), type.size());
  append_little<std::uint64_t>(chunk, stored.size());
  append_little<std::uint64_t>(chunk, raw.size());
  append_little(chunk, checksum(stored));
  append_little(chunk, checksum(chunk));
  return chunk += stored;
}

std::optional<ChunkHead> read_chunk_head(std::string_view bytes) {
  if (bytes.size() < kChunkHeadSize || !bytes.starts_with(kMark)) return std::nullopt;
  if (read_little<std::uint32_t>(bytes.data() + 28) != checksum(bytes.substr(0, 28))) return std::nullopt;
  ChunkHead head;
  std::copy_n(bytes.data() + 4, 4, head.type.begin());
  head.stored_size = read_little<std::uint64_t>(bytes.data() + 8);
  head.raw_size = read_little<std::uint64_t>(bytes.data() + 16);
  head.stored_crc = read_little<std::uint32_t>(bytes.data() + 24);
  if (!is_plausible(head)) return std::nullopt;
  return head;
}

bool payload_is_sound(const ChunkHead& head, std::string_view stored) {
  return stored.size() == head.stored_size && checksum(stored) == head.stored_crc;
}

std::optional<std::string> inflate_payload(std::string_view stored, std::size_t size) {
  constexpr std::size_t kMost = 1u << 30;  // zlib counts input and output in 32 bits
  constexpr std::size_t kBlock =
      1u << 20;  // room is made as it is needed: the size is only what the file says
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) return std::nullopt;
  std::string raw;
  std::size_t taken = 0, made = 0;
  int status = Z_OK;
  while (status == Z_OK && made < size) {
    if (made == raw.size()) raw.resize(std::min(size, made + std::max(made, kBlock)));
    const std::size_t in = std::min(kMost, stored.size() - taken), out = std::min(kMost, raw.size() - made);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(stored.data() + taken));
    stream.avail_in = static_cast<uInt>(in);
    stream.next_out = reinterpret_cast<Bytef*>(raw.data() + made);
    stream.avail_out = static_cast<uInt>(out);
    status = inflate(&stream, Z_NO_FLUSH);
    taken += in - stream.avail_in;
    made += out - stream.avail_out;
  }
  inflateEnd(&stream);
  if (made != size) return std::nullopt;
  return raw;
}

}  // namespace taut
