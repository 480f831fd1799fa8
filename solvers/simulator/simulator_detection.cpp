#include <algorithm>
#include <sstream>

#include "solvers/simulator/simulator_impl.h"

// What looking for contacts came to in a step.
namespace taut {

void Simulator::Impl::note_detection() {
  constexpr std::size_t kNamed = 8;
  if (!scheme_) return;
  report_.missing_threads =
      std::max(scheme_->contacts().set().detection().missing_threads, scheme_->stages().missing_threads());
  if (scheme_->contacts().empty()) return;
  const auto& unsupported = scheme_->contacts().set().detection().unsupported;
  report_.unsupported_pairs = static_cast<int>(unsupported.size());
  report_.unsupported.assign(unsupported.begin(), unsupported.begin() + std::min(kNamed, unsupported.size()));
}

void Simulator::Impl::fail_blind() {
  state_version_ = -1;  // what was begun knows of no contacts
  const DetectionReport& found = scheme_->contacts().set().detection();
  if (found.crowd.empty()) {
    const BodyId body = source_.shape(found.out_of_reach).body;
    std::ostringstream message;
    message << "body " << source_.name(body) << ", now " << source_.pose(body).p.norm()
            << " m from the origin at " << source_.twist(body).v.norm()
            << " m/s, comes to no finite place or beyond 1e70 m";
    return set_failure(Status::kNotFinite, message.str());
  }
  report_.crowd = found.crowd;
  set_failure(Status::kCrowded, text_of(found.crowd, source_));
}

}  // namespace taut
