#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "scenes/files/scene_file.h"
#include "tests/scenes/files/scene_file_cases.h"
#include "tests/source_dir.h"

/// Damaged scene files must be read or refused with SceneFileError: anything else escapes and fails the test.
namespace taut::scene_file_fuzz_test {
namespace {

using Json = nlohmann::json;
using Random = std::mt19937;

int below(Random& random, std::size_t count) { return static_cast<int>(random() % count); }

std::vector<std::string> originals() {
  std::vector<std::string> texts{scene_file_cases::kEverything};
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(testing::source_dir()) /
                                                               "scenes" / "examples")) {
    const std::string name = entry.path().filename().string();
    if (!name.ends_with(".json") || name.ends_with(".schema.json")) continue;
    std::ifstream file(entry.path());
    texts.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  std::sort(texts.begin(), texts.end());
  return texts;
}

/// True if the text was read, false if it was refused properly.
bool is_read(const std::string& text) {
  try {
    parse_scene(text, testing::source_dir() + "/scenes/examples/fuzz.json");  // where the mesh files are
    return true;
  } catch (const SceneFileError& error) {
    EXPECT_FALSE(error.problems().empty());
    for (const SceneFileProblem& problem : error.problems()) {
      // What has no path is a matter of syntax.
      EXPECT_TRUE(!problem.path.empty() || problem.message.starts_with("syntax error") ||
                  problem.message == "must be finite")
          << problem.message;
      EXPECT_GT(problem.line, 0) << problem.path;
      EXPECT_FALSE(problem.message.empty());
    }
    return false;
  }
}

/// Truncates, flips bits, repeats or removes pieces, or writes a piece of JSON over it.
std::string damage_text(std::string text, Random& random) {
  static const std::vector<std::string> pieces = {"1e999",   "-",  "NaN",  "{",      "}",     "[",    "]",
                                                  "\"",      "/*", "null", "\"\"",   "-1",    "0",    "//",
                                                  "\\u0000", ",",  ":",    "1e-320", "1e308", "true", "\xff"};
  const int count = 1 + below(random, 3);
  for (int i = 0; i < count && !text.empty(); ++i) {
    const std::size_t at = random() % text.size();
    const std::size_t length = std::min<std::size_t>(random() % 30, text.size() - at);
    switch (below(random, 5)) {
      case 0:
        text.resize(at);
        break;
      case 1:
        text[at] = static_cast<char>(text[at] ^ (1 << below(random, 8)));
        break;
      case 2:
        text.erase(at, length);
        break;
      case 3:
        text.insert(at, text.substr(at, length));
        break;
      default:
        text.replace(at, std::min<std::size_t>(length, 4), pieces[below(random, pieces.size())]);
    }
  }
  return text;
}

/// All values of a document below the root.
void collect(Json& value, std::vector<Json*>& all) {
  if (!value.is_structured()) return;
  for (Json& child : value) {
    all.push_back(&child);
    collect(child, all);
  }
}

/// Replaces a value by one of another type or size, removes a member, or copies a value over another.
Json damage_document(Json document, Random& random) {
  static const std::vector<Json> others = {
      nullptr,
      true,
      0,
      -1,
      1e308,
      -1e308,
      1e-320,
      5e-324,
      "",
      "ground",
      "rod",
      Json::array(),
      Json::object(),
      Json::array({1, 2, 3}),
      Json::array({0, 0, 0}),
      Json::array({1e200, 1e200, 1e200}),
      Json::array({Json::array({1, 2, 3}), Json::array({1, 2, 3}), Json::array({1, 2, 3})}),
      18446744073709551615ULL,
      Json::array({0, 0, 1}),
      "body",
      "world",
      "marble_funnel.obj",
      "net.json",
      31,
      Json::array({0, 31}),
      Json::array({Json::array({0, 1, 2}), Json::array({0, 2, 1})})};
  const int count = 1 + below(random, 3);
  for (int i = 0; i < count; ++i) {
    std::vector<Json*> all;
    collect(document, all);
    if (all.empty()) return document;
    Json& value = *all[below(random, all.size())];
    const int kind = below(random, 3);
    if (kind == 0) {
      value = others[below(random, others.size())];
    } else if (kind == 1) {
      const Json copy = *all[below(random, all.size())];
      value = copy;
    } else if (value.is_structured() && !value.empty()) {
      auto member = value.begin();
      std::advance(member, below(random, value.size()));
      value.erase(member);
    }
  }
  return document;
}

/// 4000 texts and 4000 documents; a fixed seed, so that a failure comes back.
constexpr int kTrials = 4000;

TEST(SceneFileFuzz, DamagedTextsAreReadOrRefused) {
  Random random(1);
  const auto texts = originals();
  int read = 0;
  for (int trial = 0; trial < kTrials; ++trial)
    read += is_read(damage_text(texts[below(random, texts.size())], random));
  // Damage within comments and names is harmless, most other is not.
  EXPECT_GT(read, kTrials / 100);
  EXPECT_LT(read, kTrials / 2);
}

TEST(SceneFileFuzz, DamagedDocumentsAreReadOrRefused) {
  Random random(2);
  std::vector<Json> documents;
  for (const std::string& text : originals()) documents.push_back(Json::parse(text, nullptr, true, true));
  int read = 0;
  for (int trial = 0; trial < kTrials; ++trial)
    read += is_read(damage_document(documents[below(random, documents.size())], random).dump());
  EXPECT_GT(read, kTrials / 100);
  EXPECT_LT(read, kTrials / 2);
}

}  // namespace
}  // namespace taut::scene_file_fuzz_test
