#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "scenes/recording/recording_chunk.h"
#include "scenes/recording/recording_reader.h"
#include "tests/fuzz/input_file.h"

// Recordings.  An input that begins with the mark of a recording is a file as it is, which seldom passes the
// checksums; another is a list of payloads, 'H', 'F', 'D' or anything with the size in two bytes in front, of
// which the harness makes sound chunks.

namespace taut::fuzz {
namespace {

std::string file_of_payloads(std::string_view input) {
  std::string file(kRecordingMark);
  while (input.size() >= 3) {
    const char kind = input[0];
    const std::size_t wanted =
        static_cast<std::uint8_t>(input[1]) + 256u * static_cast<std::uint8_t>(input[2]);
    const std::string_view payload = input.substr(3, wanted);
    file += make_chunk(kind == 'H'   ? kHeaderChunk
                       : kind == 'F' ? kFramesChunk
                       : kind == 'D' ? kEndChunk
                                     : ChunkType{'X', 'T', 'R', 'A'},
                       payload);
    input.remove_prefix(3 + payload.size());
  }
  return file;
}

void read(const std::filesystem::path& path) {
  std::optional<RecordingReader> reader;
  try {
    reader.emplace(path);
  } catch (const std::invalid_argument&) {  // no recording, or without a sound header
    return;
  }
  const RecordingHeader& header = reader->header();
  for (int f = 0; f < std::min(reader->frame_count(), 20); ++f) {
    try {
      const Frame& frame = reader->frame(f);
      if (frame.poses.size() != header.bodies.size() || frame.joints.size() != header.joints.size() ||
          frame.tensions.size() != header.springs.size() || frame.scalars.size() != header.scalars.size())
        found("a frame does not fit its header");
      for (const ContactSample& contact : frame.contacts)
        for (const BodyId body : {contact.a, contact.b})
          if (body.index < 0 || body.index >= static_cast<int>(header.bodies.size()))
            found("a contact of a body that is not there");
    } catch (const std::runtime_error&) {  // frames that do not fit
    }
  }
}

}  // namespace
}  // namespace taut::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace taut::fuzz;
  static InputFile file;
  const std::string_view input = text_of(data, size);
  const bool whole = input.starts_with("taut-recording/");
  file.set(whole ? std::string(input) : file_of_payloads(input));
  read(file.path());
  return 0;
}
