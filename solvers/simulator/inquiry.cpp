#include "solvers/simulator/inquiry.h"

#include <sstream>

#include "solvers/common/report_names.h"

namespace taut {
namespace {

/// Chosen, where nothing else is said.
struct InquiryTuning {
  /// Joints that leave less [m or rad] do not contradict each other for good: their rows are dependent to
  /// first order where they are, and what is left would need moves of its square root.  Those are then 1 mm.
  static constexpr double kSingularGap = 1e-6;
};

}  // namespace

void Inquiry::end_step(Status status, std::string message) const {
  report.status = status;
  if (status == Status::kContradiction) {
    const Contradiction& found = report.contradiction;
    const std::vector<std::string> names = names_of(found, source);
    std::ostringstream text;
    text << message << (found.joints.size() == names.size() ? "; these joints" : "; these")
         << " cannot hold together";
    if (found.residual > 0) text << " (" << found.residual << " is left)";
    text << ": " << list_of(names);
    if (found.bounds.empty() && found.contacts.empty() && found.residual > 0 &&
        found.residual < InquiryTuning::kSingularGap)
      text << "; where so little is left their rows have become dependent (a singular configuration): a "
              "compliance of these joints, of 1e-9 m/N for instance, lets them pass";
    message = text.str();
  }
  report.message = std::move(message);
}

}  // namespace taut
