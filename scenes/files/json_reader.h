#pragma once

#include <cstddef>
#include <exception>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/math/so3.h"
#include "scenes/files/json_document.h"
#include "scenes/support/suggestion.h"

/// A reader of JSON values that goes on after an error: what is wrong is added to a list with its path, and a
/// harmless value is returned in its place.
namespace taut {

/// A key of an object.  That of an angle, or of what is an angle per time, can also be given with "_deg" at
/// its end: then its numbers are in degrees.
struct JsonKey {
  JsonKey(const char* of) : name(of) {}
  const char* name;
  bool angle = false;
};
/// The key of an angle, if that is what it is.
inline JsonKey in_angles(const char* name, bool is_angle = true) {
  JsonKey key(name);
  key.angle = is_angle;
  return key;
}
inline constexpr double kDegree = std::numbers::pi / 180;  ///< [rad]

/// One value of the document.
class JsonNode {
 public:
  /// @param unit what its number, or the numbers of its vector, are multiplied by
  JsonNode(const nlohmann::json& value, std::string path, Problems& problems, double unit = 1)
      : value_(&value), path_(std::move(path)), problems_(&problems), unit_(unit) {}

  const std::string& path() const { return path_; }
  const nlohmann::json& json() const { return *value_; }
  bool is_array() const { return value_->is_array(); }
  double unit() const { return unit_; }

  /// Adds a problem of this value.
  void problem(std::string message) const;
  void problem(std::string message, std::string value) const;
  /// Adds what is strange about this value, and no problem.
  void warning(std::string message) const;
  /// The same of what is right, but may be a slip of the hand that has written it.
  void slip(std::string message) const {
    if (problems_->by_hand) warning(std::move(message));
  }
  Problems& problems() const { return *problems_; }
  /// Runs `function`; what it throws as bad input becomes a problem of this value.
  template <typename Function>
  void guard(Function function) const {
    try {
      function();
    } catch (const std::invalid_argument& error) {
      problem_of_core(error.what());
    }
  }

  /// The same, but silent if there are problems beyond the first `before`: then the input was stand-ins.
  template <typename Function>
  void guard_if_sound(std::size_t before, Function function) const {
    guard_if([this, before] { return problems_->size() == before; }, std::move(function));
  }
  /// The same, but silent unless `counts()` afterwards.
  template <typename Predicate, typename Function>
  void guard_if(Predicate counts, Function function) const {
    try {
      function();
    } catch (const std::invalid_argument& error) {
      if (counts()) problem_of_core(error.what());
    }
  }

  bool boolean() const;
  double number() const;        ///< finite
  double positive() const;      ///< finite, > 0
  double not_negative() const;  ///< finite, ≥ 0
  double half_to_one() const;   ///< between 1/2 and 1
  double zero_to_one() const;   ///< between 0 and 1
  double below_two() const;     ///< between 0 and 2, neither of them
  int positive_integer() const;
  std::string string() const;  ///< not empty
  Vec3 vector() const;
  Vec3 positive_vector() const;
  /// A direction, of length 1 whatever it has in the file: what is not within 1e-3 of it gets a warning, and
  /// 0 is a problem.
  Vec3 unit_vector() const;
  /// A rotation as w, x, y, z, likewise.
  Quat quaternion() const;
  /// Entries of an array; of anything else none, and a problem.
  std::vector<JsonNode> items(const char* expected = "an array") const;
  /// Entries of an object of any keys, by key; of anything else none, and a problem.
  std::vector<std::pair<std::string, JsonNode>> members() const;
  /// Exactly `count` finite numbers, or a problem and zeros.
  std::vector<double> numbers(std::size_t count, const char* expected) const;
  /// Any number of finite numbers, and of vectors; problems for entries that are none.
  std::vector<double> numbers() const;
  std::vector<Vec3> vectors() const;

  /// The value whose name the string is.
  template <typename Value, std::size_t count>
  Value choice(const std::pair<const char*, Value> (&table)[count]) const {
    return choice(std::span<const std::pair<const char*, Value>>(table));
  }
  template <typename Value>
  Value choice(std::span<const std::pair<const char*, Value>> table) const {
    std::vector<std::string> names;
    for (const auto& [name, value] : table) {
      if (value_->is_string() && value_->get_ref<const std::string&>() == name) return value;
      names.emplace_back(name);
    }
    not_a_choice(names);
    return table[0].second;
  }
  /// The same, or what others call so, with a problem; nothing of anything else, with a problem.
  template <typename Value, std::size_t count>
  std::optional<Value> choice_or_meant(const std::pair<const char*, Value> (&table)[count]) const {
    const std::size_t before = problems_->size();
    const Value value = choice(table);
    if (problems_->size() == before) return value;
    std::vector<std::string> names;
    for (const auto& [name, each] : table) names.emplace_back(name);
    const std::string meant = meant_choice(names);
    for (const auto& [name, each] : table)
      if (meant == name) return each;
    return {};
  }
  void not_a_choice(const std::vector<std::string>& names) const;

 private:
  /// The name that others have for the string; "" if there is none.
  std::string meant_choice(const std::vector<std::string>& names) const;
  Eigen::VectorXd of_unit_length(const std::vector<double>& values, std::size_t before) const;
  double number_that(bool (*fits)(double), const char* expected) const;
  void problem_of_core(std::string_view what) const;

  const nlohmann::json* value_;
  std::string path_;
  Problems* problems_;
  double unit_;
};

/// The members of an object.  Every key that is asked for is thereby a known key, an angle's also with
/// "_deg"; both are a problem.
class JsonObject {
 public:
  /// Anything but an object is a problem and reads like an empty one.
  explicit JsonObject(const JsonNode& node);

  const JsonNode& node() const { return node_; }
  std::optional<JsonNode> find(JsonKey key);
  /// Like find, but a missing key is a problem.
  std::optional<JsonNode> required(JsonKey key);

  /// The member's value, or `fallback` if it is not there.
  template <typename Value>
  Value get(JsonKey key, Value (JsonNode::*read)() const, Value fallback) {
    const auto member = find(key);
    return member ? ((*member).*read)() : fallback;
  }
  /// The member's value; if it is not there, a problem and `harmless`.
  template <typename Value>
  Value get_required(JsonKey key, Value (JsonNode::*read)() const, Value harmless) {
    const auto member = required(key);
    return member ? ((*member).*read)() : harmless;
  }
  /// Which of the keys is there; none or more than one is a problem.  `or_else`: what could be in their
  /// place.
  std::optional<JsonNode> one_of(std::initializer_list<JsonKey> keys,
                                 std::initializer_list<const char*> or_else = {});

  /// At least one of these keys must be there, as the object has no effect without them.  To be called when
  /// all known keys have been asked for; silent if there are unknown ones, which are problems themselves.
  void needs_any_of(std::initializer_list<JsonKey> keys) {
    needs_any_of(std::span(keys.begin(), keys.size()));
  }
  void needs_any_of(std::span<const JsonKey> keys);

  /// To be called when all known keys have been asked for.
  void reject_unknown_keys() const;
  /// Its keys are not known, for instance because its type is wrong: none will be rejected.
  void accept_all_keys() { accepts_all_ = true; }

 private:
  std::optional<JsonNode> at(const std::string& key) const;
  void missing(const std::vector<std::string>& names, const std::string& message);

  JsonNode node_;
  bool is_object_, accepts_all_ = false;
  std::set<std::string> known_, in_degrees_, reported_;
};

}  // namespace taut
