#pragma once

namespace taut {

/// While one of these lives, Ctrl-C (SIGINT) and SIGTERM are only noted, so that a run ends soon, with its
/// table and report.  A second signal of the same kind ends the program at once.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  /// The signal that came, or 0.
  static int signal();
  /// How long ago that was [s]; 0 without one.  From any thread.
  static double age();
};

}  // namespace taut
