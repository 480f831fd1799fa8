#include "scenes/files/scene_schema.h"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "core/axes/axis.h"
#include "scenes/files/scene_texts.h"

namespace taut {
namespace {

using SchemaJson = nlohmann::ordered_json;

/// What fits into this many columns is one line.
constexpr std::size_t kSchemaColumns = 118;

SchemaJson reference(const char* definition) {
  return {{"$ref", std::string("#/definitions/") + definition}};
}

SchemaJson on_one_line(const char* key, SchemaJson value) { return {{key, std::move(value)}}; }

/// As hand-written: an object or array on one line where that fits behind `used` columns.
std::string laid_out(const SchemaJson& value, std::size_t indent, std::size_t used) {
  if (!value.is_structured()) return value.dump();
  const auto with_all = [&](const std::string& between, const auto& text_of_item) {
    std::string text;
    for (const auto& [key, item] : value.items()) {
      const std::string name = value.is_object() ? nlohmann::json(key).dump() + ": " : "";
      text += (text.empty() ? "" : between) + name + text_of_item(item, name.size());
    }
    return text;
  };
  const std::string open = value.is_object() ? "{" : "[", close = value.is_object() ? "}" : "]";
  const std::string line =
      open + with_all(", ", [](const SchemaJson& item, std::size_t) { return laid_out(item, 0, 0); }) + close;
  if (used == 0 || used + line.size() <= kSchemaColumns) return line;
  const std::string margin(indent + 2, ' ');
  return open + "\n" + margin +
         with_all(",\n" + margin,
                  [&](const SchemaJson& item, std::size_t name) {
                    return laid_out(item, indent + 2, indent + 2 + name + 1);
                  }) +
         "\n" + std::string(indent, ' ') + close;
}

SchemaJson described(SchemaJson schema, const char* text) {
  if (!*text) return schema;
  SchemaJson with_text{{"description", text}};
  if (schema.contains("$ref"))
    with_text["allOf"] = SchemaJson::array({std::move(schema)});
  else
    with_text.update(schema);
  return with_text;
}

SchemaJson number_schema(AxisRange range) {
  switch (range) {
    case AxisRange::kNotNegative:
    case AxisRange::kBound:
      return reference("not_negative");
    case AxisRange::kSpeed:
      return reference("positive");
    case AxisRange::kFromZeroToOne:
      return {{"type", "number"}, {"minimum", 0}, {"maximum", 1}};
    case AxisRange::kFinite:
    case AxisRange::kLowest:
    case AxisRange::kHighest:
      break;
  }
  return {{"type", "number"}};
}
template <typename Property>
SchemaJson value_schema(const AxisField<Property, double>& field) {
  return number_schema(field.range);
}
template <typename Property>
SchemaJson value_schema(const AxisField<Property, bool>&) {
  return {{"type", "boolean"}};
}
template <typename Property>
SchemaJson value_schema(const AxisField<Property, std::optional<Curve>>&) {
  return reference("curve");
}

/// The keys of a property, and which of them must be there.
struct PropertySchema {
  SchemaJson keys = SchemaJson::object(), one_of = SchemaJson::array(), any_of = SchemaJson::array(),
             not_both = SchemaJson::array();

  static SchemaJson needs(const std::string& key) { return {{"required", SchemaJson::array({key})}}; }
  void add(const std::string& key, const SchemaJson& schema, const AxisFieldNotes& notes) {
    keys[key] = described(schema, notes.text);
    if (notes.acts) any_of.push_back(needs(key));
    if (!notes.angular) return;
    const std::string in_degrees = key + "_deg";
    keys[in_degrees] = schema == number_schema(AxisRange::kFinite) ? reference("degrees") : schema;
    if (notes.acts) any_of.push_back(needs(in_degrees));
    not_both.push_back(on_one_line("not", SchemaJson{{"required", SchemaJson::array({key, in_degrees})}}));
  }
  SchemaJson whole(const char* text) const {
    SchemaJson schema{{"description", text}, {"type", "object"}, {"additionalProperties", false}};
    schema["properties"] = keys;
    if (!one_of.empty()) schema["oneOf"] = one_of;
    if (any_of.size() == 1) schema.update(any_of[0]);
    if (any_of.size() > 1) schema["anyOf"] = any_of;
    if (!not_both.empty()) schema["allOf"] = not_both;
    return schema;
  }
};

/// Keys that are no fields.
template <typename Property>
void add_first(PropertySchema&) {}
template <>
void add_first<AxisMotor>(PropertySchema& schema) {
  for (const char* key : {"velocity", "position"}) {
    schema.add(key, number_schema(AxisRange::kFinite), {});
    schema.add(std::string(key) + "_deg", reference("degrees"), {});
  }
  schema.add("trajectory", reference("motion"), {});
  for (const auto& [key, value] : schema.keys.items()) schema.one_of.push_back(PropertySchema::needs(key));
}

SchemaJson axis_schema() {
  SchemaJson properties = SchemaJson::object();
  for_axis_types_backward([&]<typename Property>() {
    PropertySchema schema;
    add_first<Property>(schema);
    each_axis_field<Property>([&](const auto& field) {
      if (field.key) schema.add(field.key, value_schema(field), field.notes);
    });
    properties[Property::kFacts.key] = schema.whole(Property::kFacts.text);
  });
  properties["value"] = {{"type", "number"}, {"description", "an angle at the start with its turns [rad]"}};
  properties["value_deg"] = reference("degrees");
  return {{"type", "object"},
          {"additionalProperties", false},
          {"properties", properties},
          {"not", {{"required", {"value", "value_deg"}}}}};
}

}  // namespace

std::string scene_schema() {
  std::string schema(text_of(scene_texts(), kSceneSchema));
  const std::string head = "\n    \"axis_properties\": ";
  const std::size_t begin = schema.find(head), end = schema.find("\n    }", begin);
  if (begin == std::string::npos || end == std::string::npos)
    throw std::logic_error("the schema of scene files has no axis_properties");
  const std::size_t from = begin + head.size();
  return schema.replace(from, end + 6 - from, laid_out(axis_schema(), 4, head.size()));
}

}  // namespace taut
