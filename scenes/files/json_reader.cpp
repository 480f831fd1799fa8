#include "scenes/files/json_reader.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/base/check.h"
#include "scenes/files/synonyms.h"
#include "scenes/support/format.h"

namespace taut {
namespace {

constexpr std::size_t kShownLength = 60;
/// Directions whose length differs from 1 by no more than this are numbers with few digits; with more they
/// may be a mistake.  Three decimals, as in 0.707, are as good as 7e-4.
constexpr double kSilentlyOfUnitLength = 1e-3;
/// A quaternion whose first number is so small and whose last one is the largest is a turn by 133° or more as
/// w, x, y, z, about an axis nearer to z than to x and y, but one by less than 117° as x, y, z, w, which is
/// met more often.
constexpr double kLittleW = 0.4;
/// A first number that says that w is in front.
constexpr double kMostly = 0.7;

/// The value as the file has it, shortened.
std::string shown(const nlohmann::json& value) {
  if (value.is_number_float() && !std::isfinite(value.get<double>()))
    return value.get<double>() < 0 ? "-inf" : "inf";
  std::string text = value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  if (text.size() <= kShownLength) return text;
  std::size_t cut = kShownLength;
  while (cut > 0 && (static_cast<unsigned char>(text[cut]) & 0xC0) == 0x80) --cut;  // not within a character
  return text.substr(0, cut) + "...";
}

/// What is known, and which of it is meant by a name of the format: that of something which others call so,
/// or one that is spelt alike.
std::string known_names(const char* before, const std::vector<std::string>& known, const std::string& given,
                        const std::vector<std::string>& candidates, bool is_list = false) {
  if (std::string other = called_here(given, candidates, is_list); !other.empty()) return other;
  return before + quoted_list(known) + did_you_mean(given, candidates);
}

}  // namespace

void JsonNode::problem(std::string message) const { problem(std::move(message), shown(*value_)); }

void JsonNode::problem(std::string message, std::string value) const {
  problems_->push_back({path_, std::move(message), std::move(value)});
}

void JsonNode::warning(std::string message) const {
  problems_->warnings.push_back({path_, std::move(message), shown(*value_)});
}

/// "inertia: must be symmetric (value: ...)", with the file's own value, and the name only if the path does
/// not end in it.
void JsonNode::problem_of_core(std::string_view what) const {
  what = what.substr(0, what.rfind(" (value: "));
  if (const auto colon = what.find(": "); colon != what.npos && path_.ends_with(what.substr(0, colon)))
    what.remove_prefix(colon + 2);
  problem(std::string(what));
}

bool JsonNode::boolean() const {
  if (!value_->is_boolean()) problem("must be true or false");
  return value_->is_boolean() && value_->get<bool>();
}

double JsonNode::number() const {
  if (!value_->is_number()) {
    problem("must be a number");
    return 0;
  }
  const double number = unit_ * value_->get<double>();
  if (std::isfinite(number)) return number;
  problem("must be finite");
  return 0;
}

double JsonNode::positive() const {
  return number_that([](double x) { return x > 0; }, "must be finite and positive");
}

double JsonNode::half_to_one() const {
  return number_that([](double x) { return x >= 0.5 && x <= 1; }, "must be between 1/2 and 1");
}

double JsonNode::zero_to_one() const {
  return number_that([](double x) { return x >= 0 && x <= 1; }, "must be between 0 and 1");
}

double JsonNode::below_two() const {
  return number_that([](double x) { return x > 0 && x < 2; }, "must be between 0 and 2");
}

/// 1 if it is another, with one problem.
double JsonNode::number_that(bool (*fits)(double), const char* expected) const {
  const std::size_t before = problems_->size();
  const double value = number();
  if (fits(value)) return value;
  if (problems_->size() == before) problem(expected);
  return 1;
}

double JsonNode::not_negative() const {
  const double value = number();
  if (value >= 0) return value;
  problem("must be finite and not negative");
  return 0;
}

int JsonNode::positive_integer() const {
  const double value = value_->is_number() ? value_->get<double>() : 0;
  if (value >= 1 && value <= std::numeric_limits<int>::max() && value == std::floor(value))
    return static_cast<int>(value);
  problem("must be a positive whole number");
  return 1;
}

std::string JsonNode::string() const {
  if (value_->is_string() && !value_->get_ref<const std::string&>().empty())
    return value_->get<std::string>();
  problem("must be a string that is not empty");
  return "";
}

std::vector<double> JsonNode::numbers(std::size_t count, const char* expected) const {
  std::vector<double> result(count, 0.0);
  if (!value_->is_array() || value_->size() != count) {
    problem(std::string("must be ") + expected);
    return result;
  }
  for (std::size_t i = 0; i < count; ++i)
    result[i] = JsonNode((*value_)[i], child_path(path_, std::to_string(i)), *problems_, unit_).number();
  return result;
}

std::vector<double> JsonNode::numbers() const {
  std::vector<double> result;
  for (const JsonNode& item : items("an array of numbers")) result.push_back(item.number());
  return result;
}

std::vector<Vec3> JsonNode::vectors() const {
  std::vector<Vec3> result;
  for (const JsonNode& item : items("an array of vectors")) result.push_back(item.vector());
  return result;
}

Vec3 JsonNode::vector() const {
  const std::vector<double> v = numbers(3, "an array of 3 numbers");
  return {v[0], v[1], v[2]};
}

Vec3 JsonNode::positive_vector() const {
  const std::size_t before = problems_->size();
  const Vec3 v = vector();
  if (v.minCoeff() > 0) return v;
  if (problems_->size() == before) problem("must be 3 positive numbers");
  return Vec3::Ones();
}

/// The numbers, divided by their length where the World would not take them as they are; the first axis
/// if there are problems beyond the first `before`, or they have no direction.
Eigen::VectorXd JsonNode::of_unit_length(const std::vector<double>& values, std::size_t before) const {
  Eigen::VectorXd v = Eigen::VectorXd::Map(values.data(), static_cast<Eigen::Index>(values.size()));
  const double length = v.stableNorm();
  if (problems_->size() == before && length > 0) {
    if (std::abs(length - 1) <= kUnitTolerance) return v;
    if (std::abs(length - 1) > kSilentlyOfUnitLength) {
      std::ostringstream message;
      message << "has length " << length << " and is taken with length 1";
      warning(message.str());
    }
    v /= v.lpNorm<Eigen::Infinity>();  // its square might be too large or too small for a number
    return v.normalized();
  }
  if (problems_->size() == before) problem("must not be 0: it has no direction");
  return Eigen::VectorXd::Unit(v.size(), 0);
}

Vec3 JsonNode::unit_vector() const {
  const std::size_t before = problems_->size();
  const Vec3 v = vector();
  return of_unit_length({v.x(), v.y(), v.z()}, before);
}

Quat JsonNode::quaternion() const {
  const std::size_t before = problems_->size();
  const std::vector<double> given = numbers(4, "a quaternion of 4 numbers w, x, y, z");
  const Eigen::VectorXd q = of_unit_length(given, before);
  problems_->has_w_first = problems_->has_w_first || std::abs(q[0]) >= kMostly;
  if (std::abs(q[0]) < kLittleW && q[3] >= q.head(3).lpNorm<Eigen::Infinity>()) {
    const nlohmann::json& v = *value_;
    problems_->perhaps_w_last.push_back(
        {path_,
         format("turns by %.3g degrees, as quaternions are w, x, y, z here; if x, y, z, w is meant, write ",
                2 * std::acos(std::min(1.0, std::abs(q[0]))) / kDegree) +
             nlohmann::json{v[3], v[0], v[1], v[2]}.dump() +
             ", and else an axis with an angle, which says so",
         shown(v)});
  }
  return {q[0], q[1], q[2], q[3]};
}

std::vector<JsonNode> JsonNode::items(const char* expected) const {
  std::vector<JsonNode> result;
  if (!value_->is_array()) {
    problem(std::string("must be ") + expected);
    return result;
  }
  result.reserve(value_->size());
  for (std::size_t i = 0; i < value_->size(); ++i)
    result.emplace_back((*value_)[i], child_path(path_, std::to_string(i)), *problems_);
  return result;
}

std::vector<std::pair<std::string, JsonNode>> JsonNode::members() const {
  std::vector<std::pair<std::string, JsonNode>> result;
  if (!value_->is_object()) {
    problem("must be an object");
    return result;
  }
  for (const auto& [key, value] : value_->items())
    result.emplace_back(key, JsonNode(value, child_path(path_, key), *problems_));
  return result;
}

void JsonNode::not_a_choice(const std::vector<std::string>& names) const {
  const std::string given = value_->is_string() ? value_->get<std::string>() : "";
  const std::string known = known_names("must be one of ", names, given, names);
  problem(known.starts_with("; ") ? "is not known" + known : known);
}

std::string JsonNode::meant_choice(const std::vector<std::string>& names) const {
  return value_->is_string() ? name_here(value_->get_ref<const std::string&>(), names) : "";
}

JsonObject::JsonObject(const JsonNode& node) : node_(node), is_object_(node.json().is_object()) {
  if (!is_object_) node.problem("must be an object");
}

std::optional<JsonNode> JsonObject::find(JsonKey key) {
  known_.insert(key.name);
  const auto plain = at(key.name);
  if (!key.angle) return plain;
  const std::string other = std::string(key.name) + "_deg";
  known_.insert(other);
  in_degrees_.insert(other);
  const auto in_degrees = at(other);
  if (!in_degrees) return plain;
  if (plain && reported_.insert(other).second)
    in_degrees->problem(quoted_list({key.name}) + " is given as well");
  return JsonNode(in_degrees->json(), in_degrees->path(), node_.problems(), kDegree);
}

std::optional<JsonNode> JsonObject::at(const std::string& key) const {
  if (!is_object_) return std::nullopt;
  const auto found = node_.json().find(key);
  if (found == node_.json().end()) return std::nullopt;
  return JsonNode(*found, child_path(node_.path(), key), node_.problems());
}

std::optional<JsonNode> JsonObject::required(JsonKey key) {
  auto found = find(key);
  if (!found) missing({key.name}, quoted_list({key.name}) + " is missing");
  return found;
}

/// A problem of what is not there; or of what is there in its place, under the name that others have for it.
void JsonObject::missing(const std::vector<std::string>& names, const std::string& message) {
  if (!is_object_) return;
  for (const auto& [key, value] : node_.json().items())
    if (const std::string other = called_here(key, names, value.is_array());
        !other.empty() && !known_.contains(key)) {
      if (reported_.insert(key).second)
        JsonNode(value, child_path(node_.path(), key), node_.problems()).problem("unknown key" + other);
      return;
    }
  node_.problem(message, "");
}

std::optional<JsonNode> JsonObject::one_of(std::initializer_list<JsonKey> keys,
                                           std::initializer_list<const char*> or_else) {
  std::optional<JsonNode> first;
  std::vector<std::string> names;
  for (const JsonKey& key : keys) names.emplace_back(key.name);
  for (const JsonKey& key : keys) {
    auto found = find(key);
    if (!found) continue;
    if (first)
      found->problem("only one of " + quoted_list(names) + " may be given");
    else
      first = found;
  }
  names.insert(names.end(), or_else.begin(), or_else.end());
  if (!first) missing(names, "one of " + quoted_list(names) + " is missing");
  return first;
}

void JsonObject::needs_any_of(std::span<const JsonKey> keys) {
  if (!is_object_ || std::any_of(keys.begin(), keys.end(), [&](const JsonKey& key) { return find(key); }))
    return;
  for (const auto& [key, value] : node_.json().items())
    if (!known_.contains(key)) return;  // a wrong name of one of them
  std::vector<std::string> names;
  for (const JsonKey& key : keys) names.emplace_back(key.name);
  node_.problem("at least one of " + quoted_list(names) + " is missing", "");
}

void JsonObject::reject_unknown_keys() const {
  if (!is_object_ || accepts_all_) return;
  const std::vector<std::string> known(known_.begin(), known_.end());
  std::vector<std::string> shown_names;  // without those of the same angles in degrees
  for (const std::string& name : known)
    if (!in_degrees_.contains(name)) shown_names.push_back(name);
  for (const auto& [key, value] : node_.json().items())
    if (!known_.contains(key) && !reported_.contains(key))
      JsonNode(value, child_path(node_.path(), key), node_.problems())
          .problem("unknown key" +
                   known_names("; known here are ", shown_names, key, known, value.is_array()));
}

}  // namespace taut
