#pragma once

#include <optional>

#include "core/state/state.h"
#include "scenes/import/xml_files.h"
#include "scenes/support/suggestion.h"

/// Values of attributes.  @throws ImportError naming element, attribute and text if one is not as expected.
namespace taut::model {

std::optional<double> find_number(XmlFiles& files, const pugi::xml_node& node, const char* attribute);
double number(XmlFiles& files, const pugi::xml_node& node, const char* attribute, double fallback);
double required_number(XmlFiles& files, const pugi::xml_node& node, const char* attribute);
Vec3 vector(XmlFiles& files, const pugi::xml_node& node, const char* attribute, const Vec3& fallback);
/// Exactly `count` numbers of a text.
std::vector<double> exactly(XmlFiles& files, const pugi::xml_node& node, const char* attribute,
                            std::string_view text, std::size_t count);
/// Refuses what is below 0.
double not_negative(XmlFiles& files, const pugi::xml_node& node, const char* name, double value);
double positive(XmlFiles& files, const pugi::xml_node& node, const char* name, double value);
/// Of unit length.
Vec3 direction(XmlFiles& files, const pugi::xml_node& node, const char* name, const Vec3& value);
/// About x, then y, then z of the fixed frame [rad].
Quat from_rpy(const Vec3& rpy);
/// `; did you mean "hinge"?` where one of the types is near, or what the given one is called in another
/// format; else nothing.
std::string meant_type(const std::string& given, const std::vector<std::string>& types);
/// The same for names of what there is.
template <typename Value>
std::string near_name(const std::string& given, const std::map<std::string, Value>& entries) {
  std::vector<std::string> names;
  for (const auto& [name, value] : entries) names.push_back(name);
  return did_you_mean(given, names);
}
/// The text between the tags, without white space around it.
std::string_view text_of(const pugi::xml_node& node);

}  // namespace taut::model
