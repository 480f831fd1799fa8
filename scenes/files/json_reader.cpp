#include "scenes/files/json_reader.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/base/check.h"
#include "scenes/files/synonyms.h"

namespace taut {
namespace {

constexpr std::size_t kShownLength = 60;

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

/// What a name of the format may stand for: the one of something that others call so, or one spelt alike.
std::string meant_name(const std::string& given, const std::vector<std::string>& known) {
  const std::string other = called_here(given, known);
  return other.empty() ? did_you_mean(given, known) : other;
}

}  // namespace

void JsonNode::problem(std::string message) const { problem(std::move(message), shown(*value_)); }

void JsonNode::problem(std::string message, std::string value) const {
  problems_->push_back({path_, std::move(message), std::move(value)});
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
  const double number = value_->get<double>();
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
    result[i] = JsonNode((*value_)[i], child_path(path_, std::to_string(i)), *problems_).number();
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

Vec3 JsonNode::unit_vector() const {
  const std::size_t before = problems_->size();
  const Vec3 v = vector();
  if (std::abs(v.norm() - 1) <= kUnitTolerance) return v;
  if (problems_->size() == before) {
    std::ostringstream message;
    message.precision(10);
    message << "must have length 1 to " << kUnitTolerance << ", its length is " << v.norm();
    problem(message.str());
  }
  return Vec3::UnitZ();
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
  problem("must be one of " + quoted_list(names) +
          (value_->is_string() ? meant_name(value_->get_ref<const std::string&>(), names) : ""));
}

JsonObject::JsonObject(const JsonNode& node) : node_(node), is_object_(node.json().is_object()) {
  if (!is_object_) node.problem("must be an object");
}

std::optional<JsonNode> JsonObject::find(const char* key) {
  known_.insert(key);
  if (!is_object_) return std::nullopt;
  const auto found = node_.json().find(key);
  if (found == node_.json().end()) return std::nullopt;
  return JsonNode(*found, child_path(node_.path(), key), node_.problems());
}

std::optional<JsonNode> JsonObject::required(const char* key) {
  auto member = find(key);
  if (!member && is_object_) node_.problem(quoted_list({key}) + " is missing", "");
  return member;
}

std::optional<JsonNode> JsonObject::one_of(std::initializer_list<const char*> keys,
                                           std::initializer_list<const char*> or_else) {
  std::optional<JsonNode> first;
  std::vector<std::string> names(keys.begin(), keys.end());
  for (const char* key : keys) {
    auto member = find(key);
    if (!member) continue;
    if (first)
      member->problem("only one of " + quoted_list(names) + " may be given");
    else
      first = member;
  }
  names.insert(names.end(), or_else.begin(), or_else.end());
  if (!first && is_object_) node_.problem("one of " + quoted_list(names) + " is missing", "");
  return first;
}

void JsonObject::needs_any_of(std::initializer_list<const char*> keys) {
  if (!is_object_ || std::any_of(keys.begin(), keys.end(), [&](const char* key) { return find(key); }))
    return;
  for (const auto& [key, value] : node_.json().items())
    if (!known_.contains(key)) return;  // a wrong name of one of them
  node_.problem("at least one of " + quoted_list({keys.begin(), keys.end()}) + " is missing", "");
}

void JsonObject::reject_unknown_keys() const {
  if (!is_object_ || accepts_all_) return;
  const std::vector<std::string> known(known_.begin(), known_.end());
  for (const auto& [key, value] : node_.json().items())
    if (!known_.contains(key))
      JsonNode(value, child_path(node_.path(), key), node_.problems())
          .problem("unknown key; known here are " + quoted_list(known) + meant_name(key, known));
}

}  // namespace taut
