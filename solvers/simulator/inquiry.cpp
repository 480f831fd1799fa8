#include "solvers/simulator/inquiry.h"

#include <sstream>

#include "solvers/common/report_names.h"

namespace taut {

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
    message = text.str();
  }
  report.message = std::move(message);
}

}  // namespace taut
