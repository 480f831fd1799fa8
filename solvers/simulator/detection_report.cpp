#include "solvers/simulator/detection_report.h"

#include <algorithm>
#include <sstream>

namespace taut {

void report_detection(const Stepper& stepper, StepReport& report) {
  const Scheme& scheme = stepper.scheme();
  constexpr std::size_t kNamed = 8;
  report.missing_threads = std::max({scheme.contacts().cache().detection().missing_threads,
                                     scheme.missing_threads(), stepper.missing_threads()});
  if (scheme.contacts().empty()) return;
  const auto& unsupported = scheme.contacts().cache().detection().unsupported;
  report.unsupported_pairs = static_cast<int>(unsupported.size());
  report.unsupported.assign(unsupported.begin(), unsupported.begin() + std::min(kNamed, unsupported.size()));
}

void end_blind(const Inquiry& asked) {
  asked.stepper.forget_state();  // what was begun knows of no contacts
  const DetectionReport& found = asked.stepper.scheme().contacts().cache().detection();
  if (!found.crowd.empty()) {
    asked.report.crowd = found.crowd;
    return asked.end_step(Status::kCrowded, text_of(found.crowd, asked.source));
  }
  const BodyId body = asked.source.shape(found.out_of_reach).body;
  std::ostringstream message;
  message << "body " << asked.source.name(body) << ", now " << asked.source.pose(body).p.norm()
          << " m from the origin at " << asked.source.twist(body).v.norm()
          << " m/s, comes to no finite place or beyond 1e70 m";
  asked.end_step(Status::kNotFinite, message.str());
}

}  // namespace taut
