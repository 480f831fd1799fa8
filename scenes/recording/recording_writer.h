#pragma once

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "scenes/recording/recording.h"

namespace taut {

/// Writes a recording chunk by chunk: what has been written stays readable if the program is killed or the
/// disk gets full.  Frames wait for at most a second of wall time or a megabyte.
class RecordingWriter {
 public:
  /// Opens the file and writes the header.
  /// @throws std::invalid_argument if the file cannot be opened, naming it.
  RecordingWriter(const std::filesystem::path& file, const RecordingHeader& header);
  /// Writes waiting frames, but no end: who did not call finish() was interrupted.
  ~RecordingWriter();
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;

  /// @returns false if this or an earlier write failed: see error().
  bool append(Frame frame);
  /// Writes waiting frames and the end, and closes the file.
  bool finish(const std::string& status, const std::string& message);

  int frame_count() const { return frames_; }  ///< that were appended
  /// What went wrong: "net.taut: No space left on device; it is cut short after 12 frames"; "" if nothing.
  const std::string& error() const { return error_; }

  /// Writes waiting frames now.
  bool flush();

 private:
  bool write(const std::string& bytes);
  void give_up(int error_number);

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Close> file_;
  std::vector<Frame> waiting_;
  std::size_t frame_size_;
  std::chrono::steady_clock::time_point flushed_;
  int frames_ = 0;
  long sound_size_ = 0;  // up to the last whole chunk
  std::string error_;
};

}  // namespace taut
