#include "scenes/recording/recording_reader.h"

#include <algorithm>
#include <stdexcept>

#include "core/base/check.h"
#include "scenes/recording/recording_chunk.h"
#include "scenes/recording/recording_codec.h"
#include "scenes/support/suggestion.h"

namespace taut {

RecordingReader::RecordingReader(const std::filesystem::path& file) : file_(file) {
  std::error_code error;
  if (std::filesystem::is_regular_file(file, error)) in_.open(file, std::ios::binary);
  size_ = std::filesystem::file_size(file, error);
  if (!in_.is_open() || error)
    fail("recording", "cannot read the file" + did_you_mean_file(file), file.string());
  check_mark();
  scan();
  if (!has_header_)
    fail("recording", "the header is damaged or cut off, so nothing can be read", file.string());
}

void RecordingReader::check_mark() {
  const std::string mark = read(0, kRecordingMark.size());
  if (mark == kRecordingMark || mark == kFirstRecordingMark) return;
  const bool is_ours = mark.starts_with(kRecordingMark.substr(0, kRecordingMark.find('/') + 1));
  const std::string ours(kRecordingMark);
  if (is_ours && mark.size() == ours.size())
    fail("recording", "its format " + mark + " is not one that this version reads, up to " + ours,
         file_.string());
  fail("recording", "this is no taut recording: it does not begin with " + ours, file_.string());
}

/// Fewer bytes at the end of the file.
std::string RecordingReader::read(std::uint64_t place, std::uint64_t size) {
  if (place >= size_) return {};
  std::string bytes(std::min(size, size_ - place), '\0');
  in_.clear();
  in_.seekg(static_cast<std::streamoff>(place));
  in_.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in_.gcount()));
  return bytes;
}

void RecordingReader::note_damage(const std::string& what, std::uint64_t place) {
  if (damage_.empty()) damage_ = what + " at byte " + std::to_string(place) + " of " + std::to_string(size_);
}

/// Goes from chunk to chunk.  A chunk with a bad payload is left out; after a bad head there is no telling
/// where the next chunk begins.
void RecordingReader::scan() {
  std::uint64_t place = kRecordingMark.size();
  while (place < size_ && !end_) {
    const std::string bytes = read(place, kChunkHeadSize);
    const std::optional<ChunkHead> head = read_chunk_head(bytes);
    const bool cut =
        bytes.size() < kChunkHeadSize || (head && head->stored_size > size_ - place - kChunkHeadSize);
    if (cut) return note_damage("the file is cut short", place);
    if (!head) return note_damage("a chunk is damaged, and what follows cannot be found,", place);
    if (!take_chunk(*head, place + kChunkHeadSize)) note_damage("a chunk is damaged and left out", place);
    if (!has_header_) return;
    place += kChunkHeadSize + head->stored_size;
  }
  if (!end_) return note_damage("the run was killed or could not write on: the recording has no end", place);
  if (place < size_) note_damage("something follows the end of the recording", place);
  if (end_->frames != frame_count()) note_damage("frames are missing before the end", place);
}

bool RecordingReader::take_chunk(const ChunkHead& head, std::uint64_t place) {
  const std::string stored = read(place, head.stored_size);
  if (!payload_is_sound(head, stored)) return false;
  if (head.type != kFramesChunk) {
    const auto raw = inflate_payload(stored, head.raw_size);
    if (!raw) return false;
    try {
      if (head.type == kHeaderChunk) header_ = decode_header(*raw), has_header_ = true;
      if (head.type == kEndChunk) end_ = decode_end(*raw);
    } catch (const std::exception&) {
      return false;
    }
    return true;  // a type of a later version is passed over
  }
  const auto begin = inflate_payload(stored, std::min<std::uint64_t>(kFramesHeadSize, head.raw_size));
  if (!begin || begin->size() < kFramesHeadSize || frame_times_size(*begin) > head.raw_size) return false;
  const auto times = inflate_payload(stored, frame_times_size(*begin));
  if (!times) return false;
  const std::vector<double> found = decode_frame_times(*times);
  if (has_header_ && found.size() > head.raw_size / frame_size(header_)) return false;
  chunks_.push_back({place, head.stored_size, head.raw_size, frame_count(), static_cast<int>(found.size())});
  times_.insert(times_.end(), found.begin(), found.end());
  return true;
}

const Frame& RecordingReader::frame(int index) {
  if (index < 0 || index >= frame_count())
    throw std::out_of_range("frame " + std::to_string(index) + " of " + std::to_string(frame_count()));
  const auto after = std::upper_bound(chunks_.begin(), chunks_.end(), index,
                                      [](int i, const Chunk& chunk) { return i < chunk.first_frame; });
  const auto number = static_cast<int>(after - chunks_.begin()) - 1;
  const Chunk& chunk = chunks_[number];
  if (number != loaded_chunk_) {
    const auto raw = inflate_payload(read(chunk.place, chunk.stored_size), chunk.raw_size);
    auto frames = raw ? decode_frames(*raw, header_) : std::nullopt;
    if (!frames || static_cast<int>(frames->size()) != chunk.frame_count)
      throw std::runtime_error(file_.string() + ": the frames at byte " + std::to_string(chunk.place) +
                               " do not fit the header of the recording");
    loaded_ = std::move(*frames);
    loaded_chunk_ = number;
  }
  return loaded_[index - chunk.first_frame];
}

}  // namespace taut
