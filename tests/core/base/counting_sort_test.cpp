#include "core/base/counting_sort.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>

namespace taut::counting_sort_test {
namespace {

/// Against std::stable_sort, in vectors that hold something already.
TEST(CountingSort, KeepsTheOrderOfEqualKeysAndLeavesOutNegativeOnes) {
  std::mt19937 random(72);
  std::vector<int> start{5, 5, 5}, sorted(300, -1);
  for (const auto& [count, keys] : {std::pair(200, 7), std::pair(3, 50), std::pair(0, 4), std::pair(0, 0)}) {
    std::vector<int> key(count), expected;
    for (int& k : key) k = std::uniform_int_distribution<int>(-1, keys - 1)(random);
    for (int i = 0; i < count; ++i)
      if (key[i] >= 0) expected.push_back(i);
    std::stable_sort(expected.begin(), expected.end(), [&](int a, int b) { return key[a] < key[b]; });
    const auto value = [](std::size_t i) { return 1000 + static_cast<int>(i); };
    counting_sort(
        key.size(), keys, [&](std::size_t i) { return key[i]; }, value, start, sorted);
    ASSERT_EQ(start.size(), static_cast<std::size_t>(keys) + 1);
    EXPECT_EQ(start.front(), 0);
    EXPECT_EQ(start.back(), static_cast<int>(expected.size()));
    ASSERT_EQ(sorted.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(sorted[i], value(expected[i])) << i;
    for (int k = 0; k < keys; ++k)
      EXPECT_EQ(start[k + 1] - start[k], std::count(key.begin(), key.end(), k)) << k;
  }
}

}  // namespace
}  // namespace taut::counting_sort_test
