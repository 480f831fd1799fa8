#include "scenes/import/xml_values.h"

#include <algorithm>
#include <sstream>

#include "scenes/files/synonyms.h"

namespace taut::model {

std::optional<double> find_number(XmlFiles& files, const pugi::xml_node& node, const char* attribute) {
  const char* text = files.find(node, attribute);
  if (!text) return {};
  return exactly(files, node, attribute, text, 1)[0];
}

double number(XmlFiles& files, const pugi::xml_node& node, const char* attribute, double fallback) {
  return find_number(files, node, attribute).value_or(fallback);
}

double required_number(XmlFiles& files, const pugi::xml_node& node, const char* attribute) {
  return exactly(files, node, attribute, files.required(node, attribute), 1)[0];
}

Vec3 vector(XmlFiles& files, const pugi::xml_node& node, const char* attribute, const Vec3& fallback) {
  const char* text = files.find(node, attribute);
  if (!text) return fallback;
  const std::vector<double> v = exactly(files, node, attribute, text, 3);
  return {v[0], v[1], v[2]};
}

std::vector<double> exactly(XmlFiles& files, const pugi::xml_node& node, const char* attribute,
                            std::string_view text, std::size_t count) {
  std::vector<double> values = numbers(files, node, attribute, text);
  if (values.size() != count)
    files.fail(node, std::string("<") + node.name() + "> \"" + attribute + "\" must have " +
                         std::to_string(count) + " number(s) (value: " + std::string(text.substr(0, 60)) +
                         ")");
  return values;
}

namespace {

[[noreturn]] void refuse(XmlFiles& files, const pugi::xml_node& node, const char* name, const char* problem,
                         double value) {
  std::ostringstream message;
  message << '<' << node.name() << "> \"" << name << "\" " << problem << " (value: " << value << ")";
  files.fail(node, message.str());
}

}  // namespace

double not_negative(XmlFiles& files, const pugi::xml_node& node, const char* name, double value) {
  if (value < 0) refuse(files, node, name, "must not be negative", value);
  return value;
}

double positive(XmlFiles& files, const pugi::xml_node& node, const char* name, double value) {
  if (!(value > 0)) refuse(files, node, name, "must be positive", value);
  return value;
}

Vec3 direction(XmlFiles& files, const pugi::xml_node& node, const char* name, const Vec3& value) {
  const double length = value.norm();
  if (!(length > 1e-12)) refuse(files, node, name, "must be a direction, its length is too small", length);
  return value / length;
}

Quat from_rpy(const Vec3& rpy) {
  return exp_so3(rpy.z() * Vec3::UnitZ()) * exp_so3(rpy.y() * Vec3::UnitY()) *
         exp_so3(rpy.x() * Vec3::UnitX());
}

std::string meant_type(const std::string& given, const std::vector<std::string>& types) {
  if (std::string meant = did_you_mean(given, types); !meant.empty()) return meant;
  const auto same =
      std::ranges::find_if(types, [&](const std::string& type) { return are_synonyms(given, type); });
  return same == types.end() ? "" : "; did you mean \"" + *same + "\"?";
}

std::string_view text_of(const pugi::xml_node& node) {
  std::string_view text = node.child_value();
  const char* space = " \t\n\r";
  text.remove_prefix(std::min(text.find_first_not_of(space), text.size()));
  return text.substr(0, text.find_last_not_of(space) + 1);
}

}  // namespace taut::model
