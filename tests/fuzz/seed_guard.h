#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace taut::fuzz {

/// Seeds from `from` on, `count` of them or fewer if the time is up.
struct SeedRange {
  std::uint64_t from = 0, count = 1000;
  double seconds = 0;  ///< 0: until all seeds are done

  /// Takes --from, --count or --seconds with its value; false for any other option, whose value is not asked
  /// for.
  bool takes(const std::string& key, const std::function<std::string()>& value);
};

/// What is done with one seed, in a process of its own, and what is said of one that crashed or hung there:
/// the process is another one, so that only memory that both share comes back (shared_memory()).
struct SeedWork {
  std::function<void(std::uint64_t seed)> run;
  std::function<void(std::uint64_t seed, const std::string& how)> crashed;
};

/// Runs the seeds in processes that take a hundred each; after a crash, or a SIGALRM that says that it hangs,
/// with the next seed in another one.  Sets range.count to how many were run.
/// @return how many crashed
long run_guarded(SeedRange& range, const SeedWork& work);

/// Zeroed bytes that processes share which are forked from this one.
void* shared_memory(std::size_t bytes);

}  // namespace taut::fuzz
