#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "scenes/recording/recording_reader.h"

namespace taut {

/// A recording as the page has it: quantised to 16 bits, in columns (scenes/export/PAGE, "Data").
struct PageData {
  nlohmann::json description;
  std::string bytes;
  int stride = 1;  ///< every how many frames one was taken, so that the bytes stay below the limit

  /// Length of the description, the description, then the columns at a multiple of 8 bytes.
  std::string packed() const;
};

/// What a page holds at most [bytes], before compression.
constexpr std::size_t kMostPageBytes = 400'000'000;

PageData page_data(RecordingReader& recording, std::size_t limit = kMostPageBytes);

/// One frame by itself, of a run that goes on: its positions are the floats themselves.
/// @param with_header also what is the same in all frames
PageData page_frame(const RecordingHeader& header, const Frame& frame, bool with_header);

/// The page of these data, whole.
/// @param second shown beside them, if given
/// @throws std::invalid_argument if three.js is missing.
std::string page_text(const PageData& data, const std::string& title, const PageData* second = nullptr);

}  // namespace taut
