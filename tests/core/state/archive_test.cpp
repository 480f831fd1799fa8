#include "core/state/archive.h"

#include <gtest/gtest.h>

#include <limits>

namespace taut::archive_test {
namespace {

template <typename Value>
std::string bytes_of(Value value) {
  Archive archive;
  archive(value);
  return archive.bytes();
}

/// What a simulation remembers may be infinite, as the bound of a new contact, or of any size, as a friction
/// per slip of 1e178.  NaN is no memory.
TEST(RobustArchive, NaNIsNeitherReadNorSound) {
  for (const double good : {0.0, -1e300, 1e-320, std::numeric_limits<double>::infinity()}) {
    const std::string bytes = bytes_of(good);
    Archive archive(bytes);
    double read = 1;
    archive(read);
    EXPECT_EQ(read, good);
    EXPECT_TRUE(archive.at_end());
  }
  {
    const double bad = std::numeric_limits<double>::quiet_NaN();
    double number = bad;
    Vec3 vector(1, bad, 2);
    std::vector<double> numbers{1, 2, bad};
    Pose pose;
    pose.q.w() = bad;
    const auto refused = [](auto& value) {
      Archive out;
      out(value);
      EXPECT_FALSE(out.is_sound());
      Archive in(out.bytes());
      EXPECT_THROW(in(value), std::invalid_argument);
    };
    refused(number), refused(vector), refused(numbers), refused(pose);
  }
}

}  // namespace
}  // namespace taut::archive_test
