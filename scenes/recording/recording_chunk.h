#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

/// The outer layer of a recording: a 16-byte mark, then chunks with length, checksum and compressed payload.
namespace taut {

inline constexpr std::string_view kRecordingMark = "taut-recording/2";
/// Of recordings before there were springs in them; they are read all the same.
inline constexpr std::string_view kFirstRecordingMark = "taut-recording/1";
static_assert(kRecordingMark.size() == kFirstRecordingMark.size());

/// Type of a chunk, four letters.
using ChunkType = std::array<char, 4>;
inline constexpr ChunkType kHeaderChunk{'H', 'E', 'A', 'D'};
inline constexpr ChunkType kFramesChunk{'F', 'R', 'M', 'S'};
inline constexpr ChunkType kEndChunk{'D', 'O', 'N', 'E'};

inline constexpr std::size_t kChunkHeadSize = 32;

/// The fixed part in front of a payload.
struct ChunkHead {
  ChunkType type{};
  std::uint64_t stored_size = 0, raw_size = 0;  ///< of the payload, as in the file and inflated
  std::uint32_t stored_crc = 0;                 ///< CRC-32 [ISO 3309] of the payload as in the file
};

/// Head and payload, ready to be written.  @throws std::bad_alloc.
std::string make_chunk(ChunkType type, std::string_view raw);

/// Nothing unless the bytes begin with a chunk head whose own checksum is right and whose sizes deflate could
/// have made.
std::optional<ChunkHead> read_chunk_head(std::string_view bytes);
bool payload_is_sound(const ChunkHead& head, std::string_view stored);

/// The first `size` bytes of the inflated payload; nothing if it is no zlib stream of that length.
std::optional<std::string> inflate_payload(std::string_view stored, std::size_t size);

/// zlib stream [RFC 1950] of the bytes.  @param level 1 fast … 9 small
std::string deflate(std::string_view raw, int level);

}  // namespace taut
