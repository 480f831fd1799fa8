#include "scenes/files/json_positions.h"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "scenes/files/json_document.h"
#include "scenes/files/state_file.h"
#include "tests/scenes/files/scene_file_cases.h"

/// Lines and columns of what is wrong in a scene file.
namespace taut::json_positions_test {
namespace {

using Json = nlohmann::json;

std::string place_of(const std::string& text, const std::string& path) {
  std::vector<SceneFileProblem> problems(1);
  problems[0].path = path;
  locate(text, problems);
  return std::to_string(problems[0].line) + ":" + std::to_string(problems[0].column);
}

TEST(JsonPositions, AreThoseOfValues) {
  const std::string text =
      "{\n  \"a\": [1, {\"b\": \"]\"}, \"\\\"x\"],\n  \"c/~\": {\"d\\u0065\": null},\n\"e\":-1.5e3}";
  const std::map<std::string, std::string> expected{
      {"/", "1:1"},       {"/a", "2:8"},    {"/a/0", "2:9"},       {"/a/1", "2:12"},
      {"/a/1/b", "2:18"}, {"/a/2", "2:24"}, {"/c~1~0", "3:10"},    {"/c~1~0/de", "3:22"},
      {"/e", "4:5"},      {"/a/3", "0:0"},  {"/nowhere/a", "0:0"}, {"/a/0/b", "0:0"}};
  for (const auto& [path, place] : expected) EXPECT_EQ(place_of(text, path), place) << path;
}

TEST(JsonPositions, AreRightBehindCommentsAndAnyLineEnd) {
  const std::string unix_text =
      "// \"a\": [\n{ /* { \n */ \"a\": 1, // }\n\n  \"b\" /* : 2 */ : /**/ [\n    true\n  ] }\n// end";
  for (const char* path : {"/a", "/b", "/b/0"}) {
    std::string dos_text;
    for (char c : unix_text) dos_text += c == '\n' ? std::string("\r\n") : std::string(1, c);
    EXPECT_EQ(place_of(dos_text, path), place_of(unix_text, path)) << path;
    EXPECT_EQ(place_of("\xEF\xBB\xBF" + unix_text, path), place_of(unix_text, path)) << path;
  }
  EXPECT_EQ(place_of(unix_text, "/a"), "3:10");
  EXPECT_EQ(place_of(unix_text, "/b"), "5:24");
  EXPECT_EQ(place_of(unix_text, "/b/0"), "6:5");
  EXPECT_EQ(place_of("\xEF\xBB\xBF{\"a\": 1}", "/a"), "1:7");
  // The parser ends a comment with either of these, too.
  EXPECT_EQ(place_of("//x\r{\"a\": 1}", "/a"), "1:11");
  EXPECT_EQ(place_of(std::string("//x\0{\"a\": 1}", 12), "/a"), "1:11");
}

TEST(JsonPositions, CountCharactersNotBytes) { EXPECT_EQ(place_of("{\"größe\": 1}", "/größe"), "1:11"); }

/// The comma is pointed at, not the bracket that shows it to be one too many; messages are not cut off.
TEST(JsonPositions, OfASyntaxErrorAreThoseOfWhatIsWrong) {
  const std::string expected_value = "syntax error while parsing value - unexpected ";
  const std::string rest = "; expected '[', '{', or a literal";
  const std::vector<std::array<std::string, 3>> cases{
      {"[1,2,]", "1:5", "syntax error: trailing comma before ']'"},
      {"{\"a\": [1, \"ö,\", ]}", "1:15", "syntax error: trailing comma before ']'"},
      {"{\"a\": 1,}", "1:8", "syntax error: trailing comma before '}'"},
      {"\xEF\xBB\xBF{\"a\": {}\n, // , }\n /* ] */ }", "2:1", "syntax error: trailing comma before '}'"},
      {"[,]", "1:2", expected_value + "','" + rest},
      {"[1,,]", "1:4", expected_value + "','" + rest},
      {"{\"a\": ]}", "1:7", expected_value + "']'" + rest},
      {"[1,2,", "1:6", expected_value + "end of input" + rest},
      {"]", "1:1", expected_value + "']'" + rest},
  };
  for (const auto& [text, place, message] : cases) {
    Problems problems;
    EXPECT_FALSE(parse_json(text, problems)) << text;
    ASSERT_EQ(problems.size(), 1u) << text;
    EXPECT_EQ(std::to_string(problems[0].line) + ":" + std::to_string(problems[0].column), place) << text;
    EXPECT_EQ(problems[0].message, message) << text;
  }
}

/// Where a key stands twice, the reader has the value of the last one.
TEST(JsonPositions, OfAKeyGivenTwiceAreThoseOfTheLast) {
  EXPECT_EQ(place_of("{\"a\": 1,\n\"a\": 2}", "/a"), "2:6");
}

void collect(const Json& value, const std::string& path, std::vector<std::string>& paths) {
  paths.push_back(path);
  if (value.is_object())
    for (const auto& [key, member] : value.items()) collect(member, child_path(path, key), paths);
  if (value.is_array())
    for (std::size_t i = 0; i < value.size(); ++i)
      collect(value[i], child_path(path, std::to_string(i)), paths);
}

/// The text from each place on begins with the value of that path, in a file of every key.
TEST(JsonPositions, OfEveryValueOfALargeFile) {
  const std::string text = scene_file_cases::kEverything;
  const Json document = Json::parse(text, nullptr, true, true);
  std::vector<std::string> paths;
  collect(document, "/", paths);
  std::vector<SceneFileProblem> problems(paths.size());
  for (std::size_t i = 0; i < paths.size(); ++i) problems[i].path = paths[i];
  locate(text, problems);
  std::vector<std::size_t> starts{0};
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] == '\n') starts.push_back(i + 1);
  for (const SceneFileProblem& problem : problems) {
    ASSERT_GT(problem.line, 0) << problem.path;
    const std::string rest = text.substr(starts[problem.line - 1] + problem.column - 1);
    const Json& value = problem.path == "/" ? document : document[Json::json_pointer(problem.path)];
    const std::string begins = value.is_object()   ? "{"
                               : value.is_array()  ? "["
                               : value.is_string() ? value.dump()
                                                   : "";
    EXPECT_TRUE(rest.starts_with(begins)) << problem.path << ": " << rest.substr(0, 20);
    if (value.is_number()) {
      EXPECT_EQ(std::stod(rest), value.get<double>()) << problem.path << ": " << rest.substr(0, 20);
    }
  }
}

/// Whatever the text, the scan ends.
TEST(JsonPositions, EndInAnyText) {
  std::mt19937 random(1);
  const std::string letters = "{}[]\",:/\\*1a \n";
  for (int run = 0; run < 20000; ++run) {
    std::string text;
    for (int i = 0; i < 12; ++i) text += letters[random() % letters.size()];
    for (const char* path : {"/1", "/a/1", "/1/1"}) (void)place_of(text, path);
  }
}

std::string message_of(const std::string& text) {
  try {
    parse_scene(text, "arm.json");
  } catch (const SceneFileError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(SceneFile, SaysTheLineAndTheNameOfWhatIsWrong) {
  EXPECT_EQ(message_of("{\"format\": \"taut-scene/1\",\n \"bodies\": [\n  {\"name\": \"arm\",\n   \"mass\": "
                       "-1,\n   \"inertia\": [1, 1, 1]}]}"),
            "arm.json:4:12: /bodies/0/mass of \"arm\": must be finite and positive (value: -1)");
  EXPECT_EQ(message_of("{\"format\": \"taut-scene/1\", \"bodies\": [{\"fixed\": true, \"position\": 1}]}"),
            "arm.json:1:67: /bodies/0/position: must be an array of 3 numbers (value: 1)");
  EXPECT_EQ(message_of("{\n\"format\": \"taut-scene/1\",\n\"dt\": NaN}").substr(0, 15), "arm.json:3:7: s");
  // A name that would break the line, or fill it, is left out.
  for (const std::string& name : {std::string("a\\nb"), std::string(1000, 'x')})
    EXPECT_EQ(message_of(R"({"format": "taut-scene/1", "bodies": [{"name": ")" + name + R"(", "fixed": true,
"position": 1}]})"),
              "arm.json:2:13: /bodies/0/position: must be an array of 3 numbers (value: 1)");
  // A name that the message has already.
  const std::string open = message_of(
      R"({"format": "taut-scene/1", "bodies": [{"name": "arm", "mass": 1, "inertia": [1, 1, 1]}], "joints": [
    {"name": "elbow", "type": "ball", "a": "ground", "b": "arm", "frame": "body", "anchor_a": [0, 0, 1], "anchor_b": [0, 0, 0]}]})");
  EXPECT_EQ(open.substr(0, 70), "arm.json:2:5: /joints/0: ball \"elbow\" must be closed at the start to 1");
}

TEST(StateFile, SaysTheLineOfWhatIsWrong) {
  World world;
  try {
    apply_state(world, "{\"format\": \"taut-state/1\",\n\"time\": 0,\n\"bodies\": 7}", "state.json");
    FAIL();
  } catch (const SceneFileError& error) {
    EXPECT_STREQ(error.what(), "state.json:3:11: /bodies: must be an array of bodies (value: 7)");
  }
}

}  // namespace
}  // namespace taut::json_positions_test
