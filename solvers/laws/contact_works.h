#pragma once

#include <span>

#include "solvers/common/contact_report.h"
#include "solvers/laws/contact_rows.h"

namespace taut {

class Archive;

/// The account of contacts: works of their impulses [J] since clear(), each impulse at the mean rate of its
/// row in a kick.
class ContactWorks {
 public:
  explicit ContactWorks(const ContactRows& contacts) : contacts_(contacts) {}

  /// Impulses of a kick, during which the rows moved with `rates` on the mean: of what stops an approach and
  /// of what slips.  What presses or holds is an ideal constraint.
  void record_kick(std::span<const double> lambda, std::span<const double> rates);
  /// Impulses of a round of impacts, all of those that may strike: in it what holds takes part in what
  /// bounces.
  void record_impact(std::span<const double> impulses, std::span<const double> rates);
  /// What rigid contacts give by these impulses at these mean rates [J].
  double of_rigid(std::span<const double> impulses, std::span<const double> rates) const;
  const ContactWork& sum() const { return sum_; }

  /// A step begins.
  void keep() { before_ = sum_; }
  /// Back to its beginning.
  void roll_back() { sum_ = before_; }
  void clear() { sum_ = {}; }

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive);

 private:
  void record(int k, std::span<const double> lambda, std::span<const double> rates, bool all);

  const ContactRows& contacts_;
  ContactWork sum_, before_;
};

}  // namespace taut
