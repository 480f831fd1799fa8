#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace taut {

/// A line of a model file.
struct ModelPlace {
  std::string file;  ///< as it was opened
  int line = 0;      ///< from 1; of the start of the element; 0: the file as a whole

  /// "arm.urdf:12"
  std::string text() const { return line > 0 ? file + ':' + std::to_string(line) : file; }
};

/// Something of a model file that the scene does not have, or has otherwise.
struct ImportNotice {
  ModelPlace place;     ///< where the first of them is
  std::string message;  ///< what it is, and what became of it
  int count = 1;        ///< how many there are

  /// "arm.urdf:12: <gazebo>: has no counterpart (and 3 more)"
  std::string text() const {
    const std::string more = count > 1 ? " (and " + std::to_string(count - 1) + " more)" : "";
    return place.text() + ": " + message + more;
  }
};

/// A model file that cannot be a scene.  what() begins with file and line.
class ImportError : public std::invalid_argument {
 public:
  ImportError(ModelPlace place, const std::string& message)
      : std::invalid_argument(place.text() + ": " + message), place_(std::move(place)) {}
  /// Where it is.
  const ModelPlace& place() const { return place_; }

 private:
  ModelPlace place_;
};

}  // namespace taut
