#pragma once

#include <cstdint>

namespace taut::detail {

/// Which world a World is, and whether it may be changed.  A copy is another world, and one that is assigned
/// to becomes another: whoever works on it must not take it for the one that it was, however alike they
/// count.
class WorldIdentity {
 public:
  WorldIdentity() : value_(next()) {}
  WorldIdentity(const WorldIdentity&) : WorldIdentity() {}
  /// @throws std::logic_error while it is held.
  WorldIdentity& operator=(const WorldIdentity&) {
    require_free();
    value_ = next();
    return *this;
  }

  std::uint64_t value() const { return value_; }
  /// @throws std::logic_error while it is held.
  void require_free() const {
    if (holds_ > 0) refuse();
  }

  /// Held once more, or once less: for the time of a call of a force law, which may reach the world that is
  /// being simulated.  @{
  void hold() const { ++holds_; }
  void release() const { --holds_; }  /// @}

 private:
  static std::uint64_t next();
  [[noreturn]] static void refuse();

  std::uint64_t value_;
  mutable int holds_ = 0;
};

}  // namespace taut::detail
