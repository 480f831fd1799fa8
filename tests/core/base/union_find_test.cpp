#include "core/base/union_find.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/allocation_counter.h"

namespace taut::union_find_test {
namespace {

/// Against labels that are rewritten one by one at each join.
TEST(UnionFind, NamesEachSetByItsLeastMember) {
  std::mt19937 random(71);
  UnionFind sets;
  for (int size : {1, 2, 40, 7, 40}) {  // smaller than before, too
    sets.reset(size);
    std::vector<int> least(size);
    for (int i = 0; i < size; ++i) least[i] = i;
    std::uniform_int_distribution<int> any(0, size - 1);
    for (int joins = 0; joins < size; ++joins) {
      const int a = any(random), b = any(random);
      sets.join(a, b);
      const int to = std::min(least[a], least[b]), from = std::max(least[a], least[b]);
      std::replace(least.begin(), least.end(), from, to);
      for (int i = 0; i < size; ++i) ASSERT_EQ(sets.find(i), least[i]) << size << " " << joins << " " << i;
    }
  }
}

TEST(UnionFind, ServesAgainWithoutAllocation) {
  UnionFind sets;
  sets.reset(100);
  const long before = allocation_count();
  sets.join(3, 99);
  sets.reset(100);
  const long count = allocation_count() - before;
  EXPECT_EQ(count, 0);
  EXPECT_EQ(sets.find(99), 99);
}

}  // namespace
}  // namespace taut::union_find_test
