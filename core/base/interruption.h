#pragma once

#include <functional>

namespace taut::detail {

/// Thrown out of long work that is to end early; never leaves the library.
struct Interrupted {};

/// While one lives, work on this thread asks its question now and then, and ends early if the answer is yes.
/// A question that is null or empty is never asked.
class InterruptScope {
 public:
  using Question = std::function<bool()>;

  explicit InterruptScope(const Question* question);
  ~InterruptScope();
  InterruptScope(const InterruptScope&) = delete;
  InterruptScope& operator=(const InterruptScope&) = delete;

  /// That of this thread, or null: what a thread that helps it takes over.
  static const Question* current();

 private:
  const Question* outer_;
};

/// The answer of this thread's question; false if there is none.
bool interrupted();
/// @throws Interrupted if that is yes.
inline void poll_interrupt() {
  if (interrupted()) throw Interrupted{};
}

}  // namespace taut::detail
