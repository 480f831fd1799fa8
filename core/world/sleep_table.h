#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace taut::detail {

/// Which bodies of a World rest at no cost, and how often each was woken.
class SleepTable {
 public:
  int asleep_count() const { return asleep_count_; }
  bool is_asleep(int body) const { return asleep_[body]; }
  int wake_count(int body) const { return wake_counts_[body]; }         ///< how often, asleep or not
  const std::vector<int>& wake_counts() const { return wake_counts_; }  ///< of all bodies
  std::int64_t wake_version() const { return wake_version_; }           ///< changes with any of these

  void add_body() {
    asleep_.push_back(false);
    wake_counts_.push_back(0);
  }
  void set_asleep(int body, bool asleep) {
    asleep_count_ += static_cast<int>(asleep) - static_cast<int>(is_asleep(body));
    asleep_[body] = asleep;
  }
  /// True if it was asleep.
  bool wake(int body) {
    ++wake_counts_[body];
    ++wake_version_;
    const bool slept = is_asleep(body);
    set_asleep(body, false);
    return slept;
  }

 private:
  std::vector<char> asleep_;
  std::vector<int> wake_counts_;
  std::int64_t wake_version_ = 0;
  int asleep_count_ = 0;
};

}  // namespace taut::detail
