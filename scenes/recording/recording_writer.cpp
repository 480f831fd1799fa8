#include "scenes/recording/recording_writer.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/base/check.h"
#include "scenes/recording/recording_chunk.h"
#include "scenes/recording/recording_codec.h"
#include "scenes/support/output_file.h"

namespace taut {
namespace {

constexpr std::size_t kChunkBytes = 1 << 20;
constexpr std::chrono::seconds kLongestWait{1};

std::FILE* open_file(const std::filesystem::path& file) {
  const int fd = open_through(file.string());
  return fd < 0 ? nullptr : fdopen(fd, "wb");
}

}  // namespace

RecordingWriter::RecordingWriter(const std::filesystem::path& file, const RecordingHeader& header)
    : path_(file),
      file_(open_file(file)),
      frame_size_(frame_size(header)),
      flushed_(std::chrono::steady_clock::now()) {
  if (!file_) fail("--record", std::string("cannot write the file: ") + std::strerror(errno), file.string());
  write(std::string(kRecordingMark) + make_chunk(kHeaderChunk, encode_header(header)));
}

RecordingWriter::~RecordingWriter() {
  if (file_) flush();
}

bool RecordingWriter::append(Frame frame) {
  if (!file_) return false;
  waiting_.push_back(std::move(frame));
  const bool late = std::chrono::steady_clock::now() - flushed_ > kLongestWait;
  return waiting_.size() * frame_size_ >= kChunkBytes || late ? flush() : true;
}

bool RecordingWriter::finish(const std::string& status, const std::string& message) {
  if (!file_ || !flush()) return false;
  if (!write(make_chunk(kEndChunk, encode_end({status, message, frames_})))) return false;
  // A file system may say only now that it had no space.
  if (std::fclose(file_.release()) != 0) give_up(errno);
  return error_.empty();
}

bool RecordingWriter::flush() {
  if (!file_) return false;
  flushed_ = std::chrono::steady_clock::now();
  if (waiting_.empty()) return true;
  const auto count = static_cast<int>(waiting_.size());
  const std::string chunk = make_chunk(kFramesChunk, encode_frames(waiting_));
  waiting_.clear();
  if (!write(chunk)) return false;
  frames_ += count;
  return true;
}

bool RecordingWriter::write(const std::string& bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size() ||
      std::fflush(file_.get()) != 0) {
    give_up(errno);
    return false;
  }
  sound_size_ += static_cast<long>(bytes.size());
  return true;
}

/// Takes half a chunk off again, says what happened and writes no more.
void RecordingWriter::give_up(int error_number) {
  error_ = path_.string() + ": " + std::strerror(error_number) + "; it is cut short after " +
           std::to_string(frames_) + " frames";
  file_.reset();
  std::error_code no_regular_file;
  std::filesystem::resize_file(path_, static_cast<std::uintmax_t>(sound_size_), no_regular_file);
}

}  // namespace taut
