#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/axes/axis.h"
#include "scenes/files/scene_file.h"
#include "tests/scenes/files/scene_bad_cases.h"
#include "tests/source_dir.h"

/// Properties of axes by their fields: what scene files have of them, and what is written of them.
namespace taut::axis_fields_test {
namespace {

using namespace scene_file_cases;
using Json = nlohmann::json;

std::string text_of_file(const std::string& name) {
  std::ifstream file(testing::source_dir() + "/" + name);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

template <typename Property>
Json sample(const AxisField<Property, double>&) {
  return 0.5;
}
template <typename Property>
Json sample(const AxisField<Property, bool>&) {
  return true;
}
template <typename Property>
Json sample(const AxisField<Property, std::optional<Curve>>&) {
  return {{0, 0}, {1, 1}};
}

/// The property of a hinge's angle in a scene file, and the problems of the file.
template <typename Property>
std::pair<std::optional<Property>, std::vector<SceneFileProblem>> read(const Json& keys) {
  const std::string text = with_axes(Json{{"angle", {{Property::kFacts.key, keys}}}}.dump());
  try {
    const World world = parse_scene(text, "a.json").world;
    return {world.axis_properties(world.axis(world.joint("h"), "angle")).template get<Property>(), {}};
  } catch (const SceneFileError& error) {
    return {std::nullopt, error.problems()};
  }
}

/// Those with their law in their header need no reader of their own: each field is read by its key, an
/// angle's also in degrees, and a number that is not in its range is refused where it is.
TEST(AxisFields, AreTheKeysOfSceneFiles) {
  for_axis_types([&]<typename Property>() {
    if constexpr (PlainAxisProperty<Property>) {
      Json all = Json::object(), in_degrees = Json::object();
      each_axis_field<Property>([&](const auto& field) {
        const bool number = std::is_same_v<typename std::decay_t<decltype(field)>::Type, double>;
        all[field.key] = sample(field);
        in_degrees[field.key + std::string(number && field.notes.angular ? "_deg" : "")] = sample(field);
      });
      const auto whole = read<Property>(all), with_degrees = read<Property>(in_degrees);
      ASSERT_TRUE(whole.first) << Property::kFacts.key << ": "
                               << (whole.second.empty() ? "" : whole.second[0].message);
      ASSERT_TRUE(with_degrees.first) << Property::kFacts.key;
      each_axis_field<Property>([&](const auto& field) {
        if constexpr (std::is_same_v<typename std::decay_t<decltype(field)>::Type, double>) {
          EXPECT_EQ((*whole.first).*field.member, 0.5) << field.key;
          EXPECT_EQ((*with_degrees.first).*field.member,
                    0.5 * (field.notes.angular ? std::numbers::pi / 180 : 1));
          if (field.range == AxisRange::kFinite) return;
          Json wrong = all;
          wrong[field.key] = -2;
          const auto found = read<Property>(wrong).second;
          ASSERT_EQ(found.size(), 1u) << field.key;
          EXPECT_EQ(found[0].path,
                    std::string("/joints/0/axes/angle/") + Property::kFacts.key + "/" + field.key);
        }
      });
      const auto none = read<Property>(Json::object()).second;
      EXPECT_EQ(none.size(), 1u) << "nothing acts: " << Property::kFacts.key;
    }
  });
}

/// The table of FORMAT.md has a row for each, with all of its keys.
TEST(AxisFields, AreOnThePageOfTheFormat) {
  const std::string page = text_of_file("scenes/files/FORMAT.md");
  for_axis_types([&]<typename Property>() {
    const std::string head = std::string("\n| `") + Property::kFacts.key + "` | ";
    const std::size_t at = page.find(head);
    ASSERT_NE(at, std::string::npos) << "no row of " << Property::kFacts.key << "; it "
                                     << Property::kFacts.text;
    const std::string row = page.substr(at, page.find('\n', at + 1) - at);
    each_axis_field<Property>([&](const auto& field) {
      if (!field.key) return;
      EXPECT_NE(row.find(std::string("`") + field.key + "`"), std::string::npos)
          << "the row of " << Property::kFacts.key << " lacks `" << field.key << "` " << field.notes.text;
    });
  });
}

}  // namespace
}  // namespace taut::axis_fields_test
