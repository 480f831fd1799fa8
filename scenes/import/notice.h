#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <tuple>
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

/// Problems of a model that are told at once.
inline constexpr std::size_t kMostProblems = 20;
/// Problems in the order of their places; where they are more than are told, the last stands for the rest.
inline std::vector<ImportNotice> in_order(std::vector<ImportNotice> problems) {
  std::ranges::stable_sort(problems, [](const ImportNotice& a, const ImportNotice& b) {
    return std::tie(a.place.file, a.place.line) < std::tie(b.place.file, b.place.line);
  });
  if (problems.size() > kMostProblems) {
    problems[kMostProblems - 1].count = static_cast<int>(problems.size() - kMostProblems) + 1;
    problems.resize(kMostProblems);
  }
  return problems;
}

/// A model file that cannot be a scene.  what() has a line for each problem that was found, which begins with
/// file and line; not all that there are need to be found at once.
class ImportError : public std::invalid_argument {
 public:
  /// Of one problem.
  ImportError(ModelPlace place, std::string message)
      : ImportError(std::vector<ImportNotice>{{std::move(place), std::move(message), 1}}) {}
  /// Of one or more.
  explicit ImportError(std::vector<ImportNotice> problems)
      : std::invalid_argument(text_of(problems)), problems_(std::move(problems)) {}
  /// Where the first of them is.
  const ModelPlace& place() const { return problems_.front().place; }
  const std::vector<ImportNotice>& problems() const { return problems_; }  ///< in their order

 private:
  static std::string text_of(const std::vector<ImportNotice>& problems) {
    std::string text;
    for (const ImportNotice& problem : problems) text += (text.empty() ? "" : "\n") + problem.text();
    return text;
  }

  std::vector<ImportNotice> problems_;
};

}  // namespace taut
