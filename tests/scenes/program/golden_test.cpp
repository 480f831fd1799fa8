#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "tests/run_program.h"
#include "tests/source_dir.h"
#include "tests/temporary.h"

// Runs whose bits are the same on every processor that was tried, against what they were
// (tests/golden/README.md).
namespace taut::golden_test {
namespace {

/// "name: the rest" of each line that is no remark.
std::map<std::string, std::string> lines_of(const std::string& name) {
  std::ifstream file(testing::source_dir() + "/tests/golden/" + name);
  if (!file) throw std::runtime_error(name + " is missing");
  std::map<std::string, std::string> lines;
  for (std::string line; std::getline(file, line);)
    if (const std::size_t colon = line.find(": "); !line.empty() && line[0] != '#' && colon != line.npos)
      lines[line.substr(0, colon)] = line.substr(colon + 2);
  return lines;
}

/// Those of a report that stand in a line of fingerprints.txt, in the same order.
std::string counters(const nlohmann::json& run) {
  std::string text;
  for (const char* counter : {"substeps", "newton_iterations", "factorizations", "refactorizations",
                              "backsolves", "contact_iterations", "pivots", "inexact_steps"})
    text += (text.empty() ? "" : "/") + std::to_string(run.at(counter).get<long long>());
  return text;
}

class Golden : public ::testing::TestWithParam<std::pair<const std::string, std::string>> {};

TEST_P(Golden, HasTheBitsOfBefore) {
  const std::string& name = GetParam().first;
  std::string state, reactions, axes, counts, processor;
  std::istringstream(GetParam().second) >> state >> reactions >> axes >> counts >> processor;
#if defined(__x86_64__)
  const bool has_fma = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
  const bool has_fma = false;
#endif
  if (processor == "fma" && !has_fma) GTEST_SKIP() << "kernels round differently without AVX2 and FMA";
  const std::string report = testing::temporary("golden.json");
  std::vector<std::string> arguments = {"run"};
  std::istringstream words(lines_of("cases.txt").at(name));
  for (std::string word; words >> word;)
    arguments.push_back(word.ends_with(".json") ? testing::source_dir() + "/" + word : word);
  arguments.insert(arguments.end(), {"--threads", "1", "--quiet", "--report", report});
  const testing::Outcome outcome = testing::run_program(arguments);
  ASSERT_LE(outcome.exit_status, 1) << outcome.err;
  const nlohmann::json run = nlohmann::json::parse(std::ifstream(report));
  EXPECT_EQ(run["final_state_fingerprint"].get<std::string>(), state);
  EXPECT_EQ(run["reactions_fingerprint"].get<std::string>(), reactions);
  EXPECT_EQ(run["axis_forces_fingerprint"].get<std::string>(), axes);
  EXPECT_EQ(counters(run), counts);
}

std::string case_name(const ::testing::TestParamInfo<std::pair<const std::string, std::string>>& of) {
  std::string name = of.param.first;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Cases, Golden, ::testing::ValuesIn(lines_of("fingerprints.txt")), case_name);

}  // namespace
}  // namespace taut::golden_test
