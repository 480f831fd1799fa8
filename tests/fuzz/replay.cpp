#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "tests/fuzz/mutants.h"

// In place of libFuzzer, for compilers without it: gives the harness each file of the command line, and all
// files of each folder.  Options of libFuzzer are passed over, but for these, with which it tries mutations
// of the files as well:
//   -mutate=SECONDS -seed=N -max_len=BYTES -dict=FILE -artifact_prefix=FOLDER

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

/// What stands behind `-name=`.
const char* value_of(std::string_view argument, std::string_view name) {
  return argument.starts_with(name) ? argument.data() + name.size() : nullptr;
}

void read_option(std::string_view argument, taut::fuzz::MutantOptions& options) {
  if (const char* seconds = value_of(argument, "-mutate=")) options.seconds = std::stod(seconds);
  if (const char* seed = value_of(argument, "-seed="))
    options.seed = static_cast<std::uint32_t>(std::stoul(seed));
  if (const char* bytes = value_of(argument, "-max_len=")) options.longest = std::stoul(bytes);
  if (const char* file = value_of(argument, "-dict=")) options.dictionary = file;
  if (const char* folder = value_of(argument, "-artifact_prefix=")) options.finds = folder;
}

}  // namespace

int main(int argc, char** argv) {
  namespace fs = std::filesystem;
  std::vector<fs::path> files;
  taut::fuzz::MutantOptions mutants;
  for (int i = 1; i < argc; ++i) {
    if (argv[i][0] == '-') {
      read_option(argv[i], mutants);
      continue;
    }
    if (!fs::exists(argv[i])) {
      std::fprintf(stderr, "there is no %s\n", argv[i]);
      return 1;
    }
    if (!fs::is_directory(argv[i])) files.emplace_back(argv[i]);
    if (fs::is_directory(argv[i]))
      for (const auto& entry : fs::recursive_directory_iterator(argv[i]))
        if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<std::string> corpus;
  for (const fs::path& file : files) {
    std::ifstream in(file, std::ios::binary);
    corpus.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
    std::fprintf(stderr, "%s: %zu bytes\n", file.c_str(), corpus.back().size());
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(corpus.back().data()), corpus.back().size());
  }
  std::printf("%zu inputs replayed\n", files.size());
  if (mutants.seconds > 0) std::printf("%ld mutations tried\n", try_mutants(corpus, mutants));
  return files.empty();  // a corpus that is not found tests nothing
}
