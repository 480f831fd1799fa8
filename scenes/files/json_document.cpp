#include "scenes/files/json_document.h"

#include <algorithm>
#include <limits>
#include <map>

#include "scenes/files/json_positions.h"

namespace taut {
namespace {

using Json = nlohmann::json;

/// More numbers out of range than this and the rest is not looked for.
constexpr std::size_t kMaxOverflows = 100;

/// A problem of the syntax, at a byte.
SceneFileProblem syntax_problem(std::string_view text, std::size_t byte, std::string message,
                                std::string value = "") {
  TextPlace place;
  place.advance(text, byte);
  return {"", std::move(message), std::move(value), "", place.line, place.column};
}

/// The parser's own words without its prefix "[json.exception...] parse error at line 1, column 2: ".
std::string parser_message(std::string message) {
  for (const char* prefix : {"] ", "parse error", ": "})
    if (const auto found = message.find(prefix); found < 80)
      message.erase(0, found + std::string_view(prefix).size());
  // What was last read may break a multi-byte character.
  for (char& c : message)
    if (static_cast<unsigned char>(c) >= 0x80) c = '?';
  if (const auto last_read = message.find("; last read: ");
      last_read != message.npos && message.size() > last_read + 80)
    message = message.substr(0, last_read + 80) + "...";
  return message;
}

/// What stopped the parser at a byte: of a comma before a closing bracket the comma itself, else what the
/// parser says.
SceneFileProblem stop_problem(std::string_view text, std::size_t byte, const Json::exception& error) {
  if (byte < text.size() && (text[byte] == ']' || text[byte] == '}'))
    if (const std::size_t comma = last_before(text, byte); comma < byte && text[comma] == ',')
      return syntax_problem(text, comma,
                            std::string("syntax error: trailing comma before '") + text[byte] + "'");
  return syntax_problem(text, byte, parser_message(error.what()));
}

/// Builds the document from the parser's events (the `sax` interface of nlohmann-json).
class DocumentBuilder {
 public:
  DocumentBuilder(std::string_view text, const std::map<int, double>& overflows, Problems& problems)
      : text_(text), overflows_(overflows), problems_(problems) {}

  Json document;
  /// Set if the parse stopped at a number out of range: which one, where it ends, and its text.
  int overflow_number = -1;
  std::size_t overflow_end = 0;
  std::string overflow_token;

  bool null() { return value(nullptr); }
  bool boolean(bool b) { return value(b); }
  bool number_integer(Json::number_integer_t i) { return number(i); }
  bool number_unsigned(Json::number_unsigned_t u) { return number(u); }
  bool number_float(Json::number_float_t f, const std::string&) { return number(f); }
  bool string(std::string& s) { return value(std::move(s)); }
  bool binary(Json::binary_t&) { return false; }
  bool start_object(std::size_t) { return open(Json::object()); }
  bool start_array(std::size_t) { return open(Json::array()); }
  bool end_object() { return close(); }
  bool end_array() { return close(); }

  bool key(std::string& name) {
    keys_.back() = name;
    if (open_.back()->contains(name))
      problems_.push_back({path(), "this key is given twice in the same object", ""});
    return true;
  }

  bool parse_error(std::size_t position, const std::string& last_token, const Json::exception& error) {
    if (error.id == 406) {  // number overflow
      overflow_number = numbers_;
      overflow_end = position;
      overflow_token = last_token;
    } else {
      problems_.push_back(stop_problem(text_, position == 0 ? 0 : position - 1, error));
    }
    return false;
  }

 private:
  template <typename Number>
  bool number(Number n) {
    const auto overflow = overflows_.find(numbers_++);
    return overflow == overflows_.end() ? value(n) : value(overflow->second);
  }

  bool value(Json&& v) {
    add(std::move(v));
    return true;
  }

  Json* add(Json&& v) {
    if (open_.empty()) return &(document = std::move(v));
    if (open_.back()->is_array()) {
      open_.back()->push_back(std::move(v));
      return &open_.back()->back();
    }
    return &((*open_.back())[keys_.back()] = std::move(v));
  }

  bool open(Json&& container) {
    if (open_.size() == kMaxJsonDepth) {
      problems_.push_back(
          {path(), "is nested too deeply; at most " + std::to_string(kMaxJsonDepth) + " levels are read",
           ""});
      return false;
    }
    open_.push_back(add(std::move(container)));
    keys_.emplace_back();
    return true;
  }

  bool close() {
    open_.pop_back();
    keys_.pop_back();
    return true;
  }

  /// Of the value that is being read.
  std::string path() const {
    std::string result = "/";
    for (std::size_t i = 0; i < open_.size(); ++i) {
      // The last entry of an open array is the one being read, but at the innermost level it is yet to come.
      const std::size_t size = open_[i]->size();
      result = child_path(result, open_[i]->is_object()   ? keys_[i]
                                  : i + 1 == open_.size() ? std::to_string(size)
                                                          : std::to_string(size - 1));
    }
    return result;
  }

  std::string_view text_;
  const std::map<int, double>& overflows_;
  Problems& problems_;
  std::vector<Json*> open_;        // containers around the present place; only the last one grows
  std::vector<std::string> keys_;  // one per open container, used if it is an object
  int numbers_ = 0;
};

}  // namespace

std::string child_path(const std::string& path, std::string_view key) {
  std::string result = path == "/" ? "" : path;
  result += '/';
  for (char c : key) {
    if (c == '~')
      result += "~0";
    else if (c == '/')
      result += "~1";
    else
      result += c;
  }
  return result;
}

std::optional<Json> parse_json(std::string_view text, Problems& problems) {
  // The parser stops at a number out of range.  Each one is overwritten by a 1 and remembered by its ordinal,
  // and the parse begins again.
  std::string readable(text);
  std::map<int, double> overflows;
  const std::size_t problems_before = problems.size();
  while (true) {
    problems.resize(problems_before);
    DocumentBuilder builder(text, overflows, problems);
    if (Json::sax_parse(readable, &builder, Json::input_format_t::json, true, true))
      return std::move(builder.document);
    if (builder.overflow_number < 0) return std::nullopt;
    const std::string& token = builder.overflow_token;
    const std::size_t begin = builder.overflow_end - token.size();
    if (overflows.size() == kMaxOverflows || readable.compare(begin, token.size(), token) != 0) {
      problems.push_back(syntax_problem(text, begin, "must be finite", token));
      return std::nullopt;
    }
    const double infinity = std::numeric_limits<double>::infinity();
    overflows[builder.overflow_number] = token[0] == '-' ? -infinity : infinity;
    readable.replace(begin, token.size(), token.size(), ' ');
    readable[begin] = '1';
  }
}

}  // namespace taut
