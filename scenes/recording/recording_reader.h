#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "scenes/recording/recording.h"

namespace taut {

/// Reads a recording, also one that was cut short or damaged: frames in sound chunks can be had, damage()
/// says what is missing.  Only one chunk of frames is in memory at a time.
class RecordingReader {
 public:
  /// Checks every chunk.
  /// @throws std::invalid_argument if the file cannot be read, is no recording, or its header is not sound.
  explicit RecordingReader(const std::filesystem::path& file);

  const RecordingHeader& header() const { return header_; }  ///< what is the same in all frames
  /// Number of frames that are whole.
  int frame_count() const { return static_cast<int>(times_.size()); }
  /// Time of a frame [s].  @throws std::out_of_range for one that is not there.
  double time(int frame) const { return times_.at(frame); }
  /// A frame, which lives until the next call.  Reading in order is fast.
  /// @throws std::out_of_range for a frame that is not there, std::runtime_error if the file was changed
  /// since it was opened.
  const Frame& frame(int index);

  /// How the run ended; nothing if the recording has no end: its run was killed or the disk was full.
  const std::optional<RecordingEnd>& end() const { return end_; }
  /// What is wrong with the file, one sentence; "" if it is whole.
  const std::string& damage() const { return damage_; }
  const std::filesystem::path& file() const { return file_; }  ///< that was opened

 private:
  struct Chunk {
    std::uint64_t place = 0;  // of the payload
    std::uint64_t stored_size = 0, raw_size = 0;
    int first_frame = 0, frame_count = 0;
  };
  void check_mark();
  void scan();
  std::string read(std::uint64_t place, std::uint64_t size);
  bool take_chunk(const struct ChunkHead& head, std::uint64_t place);
  void note_damage(const std::string& what, std::uint64_t place);

  std::filesystem::path file_;
  std::ifstream in_;
  std::uint64_t size_ = 0;
  RecordingHeader header_;
  bool has_header_ = false;
  std::optional<RecordingEnd> end_;
  std::string damage_;
  std::vector<double> times_;
  std::vector<Chunk> chunks_;
  int loaded_chunk_ = -1;
  std::vector<Frame> loaded_;
};

}  // namespace taut
