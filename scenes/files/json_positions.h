#pragma once

#include <string_view>
#include <vector>

#include "scenes/files/scene_file.h"

namespace taut {

/// A place in a text, counted on from its beginning.
struct TextPlace {
  int line = 1, column = 1;  ///< from 1; columns are characters of UTF-8
  std::size_t byte = 0;
  /// Goes on to a byte that is not before this one.
  void advance(std::string_view text, std::size_t to);
};

/// The byte at which the last thing before `end` begins or, of a word, ends: what is no space and no comment.
/// npos if there is none.
std::size_t last_before(std::string_view text, std::size_t end);

/// Adds line and column to problems with a path, from a text that parse_json() has read: those where the
/// value begins.  Paths that are not in the text stay without.
void locate(std::string_view text, std::vector<SceneFileProblem>& problems);

}  // namespace taut
