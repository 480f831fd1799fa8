#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/recording/recording.h"

/// The inner layer of a recording: header, frames and end as bytes (scenes/recording/FORMAT.md).
namespace taut {

std::string encode_header(const RecordingHeader& header);
/// @throws std::exception for anything that is not what encode_header() makes.
RecordingHeader decode_header(std::string_view raw);

/// [{name, type: spring or damper, course: two points [body, x, y, z]}, ...]
nlohmann::json springs_to_json(const std::vector<RecordedSpring>& springs);

std::string encode_end(const RecordingEnd& end);
/// @throws std::exception.
RecordingEnd decode_end(std::string_view raw);

/// Frames of one recording, one behind the other.
std::string encode_frames(std::span<const Frame> frames);
/// Nothing if the bytes do not fit themselves or the header.
std::optional<std::vector<Frame>> decode_frames(std::string_view raw, const RecordingHeader& header);

/// The leading bytes of encoded frames hold their number and times: how many bytes that are, from the first
/// kFramesHeadSize of them.
inline constexpr std::size_t kFramesHeadSize = 16;
std::size_t frame_times_size(std::string_view head);
std::vector<double> decode_frame_times(std::string_view raw);

/// Bytes of one encoded frame without contacts.
std::size_t frame_size(const RecordingHeader& header);

}  // namespace taut
