#pragma once

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace taut::detail {

/// How this thread rounds and treats the smallest numbers.  Without SSE always 0.
inline unsigned rounding_mode() {
#if defined(__SSE__)
  return _mm_getcsr();
#else
  return 0;
#endif
}

/// While it lives, this thread works in a rounding_mode(), for instance another thread's; the mode of before
/// comes back at its end.  Without SSE it does nothing.
class RoundingScope {
 public:
#if defined(__SSE__)
  explicit RoundingScope(unsigned mode) : before_(rounding_mode()) { _mm_setcsr(mode); }
  ~RoundingScope() { _mm_setcsr(before_); }
#else
  explicit RoundingScope(unsigned) {}
  ~RoundingScope() {}
#endif
  RoundingScope(const RoundingScope&) = delete;
  RoundingScope& operator=(const RoundingScope&) = delete;

 private:
#if defined(__SSE__)
  unsigned before_;
#endif
};

/// While it lives, results and operands of this thread below the smallest normal number, 2e-308, count as 0.
/// What moves one end of a chain fades along it by a factor a body, and with denormal numbers, which
/// processors take some hundred cycles for, a step of 1000 rods takes 1.4 times as long.
class FlushToZero : RoundingScope {
 public:
  FlushToZero() : RoundingScope(rounding_mode() | kFlushToZero | kDenormalsAreZero) {}

 private:
  static constexpr unsigned kFlushToZero = 0x8000, kDenormalsAreZero = 0x0040;
};

}  // namespace taut::detail
