#include "tests/fuzz/mutants.h"

#include <fcntl.h>
#include <sys/time.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>
#include <random>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace taut::fuzz {
namespace {

constexpr int kHang = 10;  // seconds of processor time

const std::string* under_test = nullptr;
std::string find_file;

/// Keeps the input, and lets the signal end the process as it would.
void keep(int signal) {
  const int file = open(find_file.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0644);
  if (file >= 0 && under_test) (void)!write(file, under_test->data(), under_test->size());
  std::signal(signal, SIG_DFL);
  raise(signal);
}

void watch(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  find_file = (folder / ("mutant-" + std::to_string(getpid()))).string();
  for (int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGPROF}) std::signal(signal, keep);
}

void restart_watch_of_time() {
  const itimerval limit{{0, 0}, {kHang, 0}};
  setitimer(ITIMER_PROF, &limit, nullptr);
}

/// "word" or name="word", with \xHH, \\ and \".
std::vector<std::string> words_of(const std::filesystem::path& dictionary) {
  std::vector<std::string> words;
  std::ifstream in(dictionary);
  for (std::string line; std::getline(in, line);) {
    const std::size_t begin = line.find('"'), end = line.rfind('"');
    if (line.starts_with('#') || begin == line.npos || end <= begin) continue;
    std::string word;
    for (std::size_t i = begin + 1; i < end; ++i)
      if (line[i] != '\\') {
        word += line[i];
      } else if (line[i + 1] == 'x') {
        word += static_cast<char>(std::stoi(line.substr(i + 2, 2), nullptr, 16)), i += 3;
      } else {
        word += line[++i];
      }
    words.push_back(word);
  }
  return words;
}

class Mutator {
 public:
  Mutator(const std::vector<std::string>& corpus, const MutantOptions& options)
      : corpus_(corpus),
        words_(words_of(options.dictionary)),
        longest_(options.longest),
        random_(options.seed) {
    words_.insert(words_.end(), {"0", "1", "-1", "1e-300", "1e30", "1e300", "1e400", "nan", "inf",
                                 "4294967296", "99999999999999999999", "1e-9", std::string(1, '\0'), "\xff"});
  }

  std::string next() {
    std::string bytes = one_of(corpus_);
    for (std::size_t left = 1 + below(4); left > 0; --left) change(bytes);
    if (bytes.size() > longest_) bytes.resize(longest_);
    return bytes;
  }

 private:
  std::size_t below(std::size_t n) { return n == 0 ? 0 : random_() % n; }
  const std::string& one_of(const std::vector<std::string>& all) { return all[below(all.size())]; }

  void change(std::string& bytes) {
    const std::size_t at = below(bytes.size() + 1), length = 1 + below(below(4) == 0 ? 200 : 8);
    const std::size_t taken = std::min(length, bytes.size() - at);
    switch (below(8)) {
      case 0:
        if (at < bytes.size()) bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        return;
      case 1:
        if (at < bytes.size()) bytes[at] = static_cast<char>(random_());
        return;
      case 2:
        bytes.erase(at, taken);
        return;
      case 3:
        bytes.insert(below(bytes.size() + 1), bytes.substr(at, taken));
        return;
      case 4:
        bytes.insert(at, one_of(words_));
        return;
      case 5: {  // a number becomes another
        const std::size_t begin = bytes.find_first_of("0123456789", at);
        if (begin == bytes.npos) return;
        const std::size_t end = std::min(bytes.find_first_not_of("0123456789.eE+-", begin), bytes.size());
        bytes.replace(begin, end - begin, one_of(words_));
        return;
      }
      case 6: {
        const std::string& other = one_of(corpus_);
        const std::size_t from = below(other.size() + 1);
        bytes.replace(at, taken, other, from, length);
        return;
      }
      default: {
        const std::string& other = one_of(corpus_);
        bytes = bytes.substr(0, at) + other.substr(below(other.size() + 1));
      }
    }
  }

  const std::vector<std::string>& corpus_;
  std::vector<std::string> words_;
  std::size_t longest_;
  std::mt19937 random_;
};

}  // namespace

long try_mutants(const std::vector<std::string>& corpus, const MutantOptions& options) {
  using Clock = std::chrono::steady_clock;
  if (corpus.empty()) return 0;
  watch(options.finds);
  Mutator mutator(corpus, options);
  const auto end = Clock::now() + std::chrono::duration<double>(options.seconds);
  long count = 0;
  for (std::string bytes; Clock::now() < end; ++count) {
    bytes = mutator.next();
    under_test = &bytes;
    restart_watch_of_time();
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    under_test = nullptr;
  }
  return count;
}

}  // namespace taut::fuzz
