#include "core/base/flush_to_zero.h"

#include <gtest/gtest.h>

#include <limits>

#if defined(__SSE__)
namespace taut::flush_to_zero_test {
namespace {

double half_of_the_smallest() {
  volatile double smallest = std::numeric_limits<double>::min();
  return smallest / 2;
}

TEST(FlushToZero, LastsAsLongAsItLives) {
  {
    const detail::FlushToZero outer;
    {
      const detail::FlushToZero inner;
      EXPECT_EQ(half_of_the_smallest(), 0);
    }
    EXPECT_EQ(half_of_the_smallest(), 0);
  }
  EXPECT_GT(half_of_the_smallest(), 0);
}

}  // namespace
}  // namespace taut::flush_to_zero_test
#endif
