#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include "core/axes/axis.h"
#include "scenes/import/imported_model.h"
#include "tests/scenes/files/scene_bad_cases.h"
#include "tests/scenes/import/corpus_checker.h"
#include "tests/source_dir.h"

/// The schema says the same as the reader, as far as a schema can.
namespace taut::scene_schema_test {
namespace {

using Json = nlohmann::json;
using Adapter = valijson::adapters::NlohmannJsonAdapter;
const std::filesystem::path kScenes = std::filesystem::path(testing::source_dir()) / "scenes" / "examples";

Json parse(const std::string& text) { return Json::parse(text, nullptr, true, true); }

Json parse_file(const std::filesystem::path& path) {
  std::ifstream file(path);
  return parse({std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()});
}

const valijson::Schema& schema() {
  static const Json document = parse_file(kScenes / "taut-scene.schema.json");
  static valijson::Schema result;
  static const bool populated = [] {
    valijson::SchemaParser parser(valijson::SchemaParser::kDraft7);
    parser.populateSchema(Adapter(document), result);
    return true;
  }();
  EXPECT_TRUE(populated);
  return result;
}

/// A hinge of which this acts along the angle, as `key` says.
Json with_property(const char* key, Json property) {
  Json scene = parse(scene_file_cases::with_axes("{}"));
  scene["joints"][0]["axes"]["angle"][key] = std::move(property);
  return scene;
}

/// What the schema has against a document; empty if it accepts it.
std::string objections(const Json& document) {
  valijson::Validator validator(valijson::Validator::kStrongTypes);
  valijson::ValidationResults results;
  if (validator.validate(schema(), Adapter(document), &results)) return "";
  std::string text = "rejected";
  valijson::ValidationResults::Error error;
  while (results.popError(error)) {
    text += "\n";
    for (const std::string& part : error.context) text += part;
    text += ": " + error.description;
  }
  return text;
}

TEST(SceneSchema, AcceptsEveryKeyThatTheReaderKnows) {
  EXPECT_EQ(objections(parse(scene_file_cases::kEverything)), "");
  for (bool in_degrees : {false, true})
    EXPECT_EQ(objections(parse(scene_file_cases::every_angle(in_degrees))), "");
}

/// By which other schemas may refer to it, wherever it lies.
TEST(SceneSchema, HasANameOfTheFormatsVersion) {
  EXPECT_EQ(parse_file(kScenes / "taut-scene.schema.json")["$id"], "urn:taut:scene:1");
  EXPECT_EQ(parse(scene_file_cases::kEverything)["format"], "taut-scene/1");
}

TEST(SceneSchema, AcceptsTheShippedScenes) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kScenes)) {
    const std::string name = entry.path().filename().string();
    if (!name.ends_with(".json") || name.ends_with(".schema.json")) continue;
    EXPECT_EQ(objections(parse_file(entry.path())), "") << name;
    ++count;
  }
  EXPECT_GE(count, 6);
}

/// What acts along axes is known to the schema by the fields of each property.
TEST(SceneSchema, KnowsTheFieldsOfProperties) {
  for_axis_types([&]<typename Property>() {
    const char* property = Property::kFacts.key;
    each_axis_field<Property>([&](const auto& field) {
      if (!field.key) return;
      const Json text = with_property(property, {{field.key, "text"}}),
                 unknown = with_property(property, {{std::string(field.key) + "s", 1}});
      EXPECT_NE(objections(text), "") << property << "/" << field.key;
      EXPECT_NE(objections(unknown), "") << property << "/" << field.key;
      if constexpr (PlainAxisProperty<Property> &&
                    std::is_same_v<typename std::decay_t<decltype(field)>::Type, double>) {
        EXPECT_EQ(objections(with_property(property, {{field.key, 0.5}})), "")
            << property << "/" << field.key;
      }
    });
    EXPECT_NE(objections(with_property(property, 3)), "") << property;
  });
}

TEST(SceneSchema, AcceptsImportedModels) {
  for (const std::string& name : testing::model_files()) try {
      EXPECT_EQ(objections(import_model(testing::model_folder() / name).document), "") << name;
    } catch (const std::invalid_argument&) {  // refused
    }
}

TEST(SceneSchema, RejectsWhatASchemaCanSee) {
  int seen = 0;
  for (const auto& bad : scene_file_cases::bad_scenes()) {
    // The others (1e999, duplicate keys, references, geometry) are outside what a schema can say, and it must
    // not reject them for another reason.
    const Json document = Json::parse(bad.text, nullptr, false, true);
    if (document.is_discarded()) {
      EXPECT_FALSE(bad.schema_catches) << bad.text;
      continue;
    }
    EXPECT_EQ(objections(document).empty(), !bad.schema_catches) << bad.text << "\n" << objections(document);
    seen += bad.schema_catches;
  }
  EXPECT_GT(seen, 50);
}

}  // namespace
}  // namespace taut::scene_schema_test
