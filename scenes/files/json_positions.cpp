#include "scenes/files/json_positions.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "scenes/files/json_document.h"

namespace taut {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// Goes through the text of a document whose syntax is right as far as the values that are asked for, and
/// notes where the values begin that are asked for.  What holds none of them is passed over without a look at
/// its paths.
class PositionScan {
 public:
  explicit PositionScan(std::string_view text) : text_(text) {
    if (text_.starts_with(kByteOrderMark)) at_ = kByteOrderMark.size();
  }

  /// Byte at which each value begins, by its path; of keys that are given twice, the last one.
  std::map<std::string, std::size_t> wanted;

  void run() {
    pass_space();
    value("/");
  }

  std::size_t last_before(std::size_t end) {
    std::size_t last = std::string_view::npos;
    for (pass_space(); at_ < end; pass_space()) {
      last = at_;
      if (peek() == '"')
        pass_string();
      else
        ++at_;
    }
    return last;
  }

 private:
  bool is_wanted_within(const std::string& path) const {
    const std::string start = path == "/" ? path : path + "/";
    const auto found = wanted.lower_bound(start);
    return found != wanted.end() && found->first.starts_with(start);
  }

  /// Nesting is at most kMaxJsonDepth, which the parser has made sure of.
  void value(const std::string& path) {
    if (const auto found = wanted.find(path); found != wanted.end()) found->second = at_;
    const char first = peek();
    if (first == '"') return pass_string();
    if (first != '{' && first != '[') return pass_word();
    if (!is_wanted_within(path)) return pass_container();
    ++at_;
    for (std::size_t i = 0, before = 0;; ++i) {
      pass_space();
      if (at_ == before) ++at_;  // not in a text of right syntax
      before = at_;
      if (peek() == '}' || peek() == ']' || at_ >= text_.size()) break;
      std::string key = std::to_string(i);
      if (first == '{') {
        const std::size_t begin = at_;
        pass_string();
        const auto name = nlohmann::json::parse(text_.substr(begin, at_ - begin), nullptr, false);
        key = name.is_string() ? name.get<std::string>() : "";
        pass_space();
        ++at_;  // the colon
        pass_space();
      }
      value(child_path(path, key));
      pass_space();
      if (peek() == ',') ++at_;
    }
    ++at_;
  }

  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }

  void pass_string() {
    for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_) at_ += text_[at_] == '\\';
    ++at_;
  }
  void pass_word() {
    const std::size_t end = text_.find_first_of(",]} \t\r\n/", at_);
    at_ = std::min(end, text_.size());
  }
  /// From its opening bracket to behind its closing one.
  void pass_container() {
    int depth = 0;
    do {
      const char c = peek();
      if (c == '"') {
        pass_string();
      } else {
        depth += (c == '{' || c == '[') - (c == '}' || c == ']');
        ++at_;
      }
      pass_space();
    } while (depth > 0 && at_ < text_.size());
  }
  void pass_space() {
    while (at_ < text_.size()) {
      const std::string_view rest = text_.substr(at_, 2);
      if (rest == "//")  // up to a byte that the parser ends such a comment with
        at_ = std::min(text_.find_first_of(std::string_view("\n\r\0", 3), at_), text_.size() - 1) + 1;
      else if (rest == "/*")
        at_ = std::min(text_.find("*/", at_ + 2), text_.size() - 2) + 2;
      else if (std::string_view(" \t\r\n").find(text_[at_]) == std::string_view::npos)
        return;
      else
        ++at_;
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

void TextPlace::advance(std::string_view text, std::size_t to) {
  if (byte == 0 && text.starts_with(kByteOrderMark)) byte = std::min(kByteOrderMark.size(), text.size());
  for (const std::size_t end = std::min(to, text.size()); byte < end; ++byte) {
    if (text[byte] == '\n')
      ++line, column = 1;
    else
      column += (static_cast<unsigned char>(text[byte]) & 0xC0) != 0x80;  // others go on with a character
  }
}

std::size_t last_before(std::string_view text, std::size_t end) {
  return PositionScan(text).last_before(std::min(end, text.size()));
}

void locate(std::string_view text, std::vector<SceneFileProblem>& problems) {
  PositionScan scan(text);
  for (const SceneFileProblem& problem : problems)
    if (problem.line == 0 && !problem.path.empty()) scan.wanted[problem.path] = std::string_view::npos;
  if (scan.wanted.empty()) return;
  scan.run();
  std::map<std::size_t, TextPlace> places;  // by byte, so that the text is counted through once
  for (const auto& [path, byte] : scan.wanted)
    if (byte != std::string_view::npos) places[byte];
  TextPlace at;
  for (auto& [byte, place] : places) {
    at.advance(text, byte);
    place = at;
  }
  for (SceneFileProblem& problem : problems) {
    const auto found = scan.wanted.find(problem.path);
    if (problem.line != 0 || found == scan.wanted.end() || found->second == std::string_view::npos) continue;
    problem.line = places[found->second].line;
    problem.column = places[found->second].column;
  }
}

}  // namespace taut
