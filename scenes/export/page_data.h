#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "scenes/recording/recording_reader.h"

namespace taut {

/// A recording as the page has it: quantised to 16 bits, in columns (scenes/export, "The page").
struct PageData {
  nlohmann::json description;
  std::string bytes;
  int stride = 1;  ///< every how many frames one was taken, so that the bytes stay below the limit
};

/// @param limit [bytes] before compression
PageData page_data(RecordingReader& recording, std::size_t limit = 400'000'000);

}  // namespace taut
