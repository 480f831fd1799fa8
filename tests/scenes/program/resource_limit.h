#pragma once

#include <sys/resource.h>

#include <csignal>

namespace taut::testing {

/// Lets this process, and those that it starts, have at most so much of something while it lives:
/// RLIMIT_AS bytes of addresses, RLIMIT_FSIZE bytes in a file.
class ResourceLimit {
 public:
  ResourceLimit(decltype(RLIMIT_AS) resource, rlim_t most) : resource_(resource) {
    getrlimit(resource_, &before_);
    const rlimit limit{most, before_.rlim_max};
    setrlimit(resource_, &limit);
  }
  ~ResourceLimit() { setrlimit(resource_, &before_); }
  ResourceLimit(const ResourceLimit&) = delete;
  ResourceLimit& operator=(const ResourceLimit&) = delete;

 private:
  decltype(RLIMIT_AS) resource_;
  rlimit before_{};
};

/// Lets this process write files of at most so many bytes while it lives: what fills up here fills up as a
/// disk does, in the middle of a chunk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : limit_(RLIMIT_FSIZE, bytes) { std::signal(SIGXFSZ, SIG_IGN); }
  ~FileSizeLimit() { std::signal(SIGXFSZ, SIG_DFL); }

 private:
  ResourceLimit limit_;
};

}  // namespace taut::testing
