#pragma once

#include <limits>

namespace taut {

/// The sub-steps of a step of dt: equal ones as long as all goes well, shorter ones after one that failed,
/// and one that ends at an impact.  (solvers/simulator, "Sub-steps")
class Substeps {
 public:
  Substeps() = default;  ///< none
  /// As many as `count` of equal length, none shorter than dt / `most`.
  Substeps(double dt, double count, double most)
      : remaining_(dt), even_length_(dt / count), smallest_(dt / most) {}

  bool done() const { return !(remaining_ > 0); }
  double remaining() const { return remaining_; }  ///< [s]
  /// The length of the next one, if the scheme allows no more than `step_limit`.
  double next(double step_limit);

  // What became of it.
  void accept();
  /// Something happens within it at that time [s], where the next one must end, which may be as short as it
  /// likes.
  void end_next_at(double time) { event_ = time; }
  /// The scheme allows no more than `step_limit` by now.
  void shorten(double step_limit = std::numeric_limits<double>::infinity());

  /// They are shorter than this part of what they were to be.
  bool below(double part) const { return limit_ < part * even_length_; }
  /// They would have to be shorter than allowed.
  bool exhausted() const { return limit_ < smallest_; }

 private:
  double remaining_ = 0, even_length_ = 0, smallest_ = 0;
  double limit_ = std::numeric_limits<double>::infinity(), event_ = 0;
  double count_ = 1, even_ = 0, h_ = 0;  // of the present one: those left, their equal length, and its own
};

}  // namespace taut
