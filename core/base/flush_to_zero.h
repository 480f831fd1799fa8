#pragma once

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace taut::detail {

/// While it lives, results and operands of this thread below the smallest normal number, 2e-308, count as 0;
/// the caller's mode comes back at its end.  What moves one end of a chain fades along it by a factor a body,
/// and with denormal numbers, which processors take some hundred cycles for, a step of 1000 rods takes 1.4
/// times as long.  Without SSE it does nothing.
class FlushToZero {
 public:
#if defined(__SSE__)
  FlushToZero() : before_(_mm_getcsr()) { _mm_setcsr(before_ | kFlushToZero | kDenormalsAreZero); }
  ~FlushToZero() { _mm_setcsr(before_); }
#else
  FlushToZero() {}
  ~FlushToZero() {}
#endif
  FlushToZero(const FlushToZero&) = delete;
  FlushToZero& operator=(const FlushToZero&) = delete;

 private:
#if defined(__SSE__)
  static constexpr unsigned kFlushToZero = 0x8000, kDenormalsAreZero = 0x0040;
  unsigned before_;
#endif
};

/// How this thread rounds and treats the smallest numbers, for AsElsewhere.
inline unsigned rounding_mode() {
#if defined(__SSE__)
  return _mm_getcsr();
#else
  return 0;
#endif
}

/// While it lives, this thread rounds as another one does, whose rounding_mode() is given.
class AsElsewhere {
 public:
#if defined(__SSE__)
  explicit AsElsewhere(unsigned mode) : before_(_mm_getcsr()) { _mm_setcsr(mode); }
  ~AsElsewhere() { _mm_setcsr(before_); }
#else
  explicit AsElsewhere(unsigned) {}
  ~AsElsewhere() {}
#endif
  AsElsewhere(const AsElsewhere&) = delete;
  AsElsewhere& operator=(const AsElsewhere&) = delete;

 private:
#if defined(__SSE__)
  unsigned before_;
#endif
};

}  // namespace taut::detail
