#include "solvers/step_report.h"

namespace taut {

std::string_view to_string(Status status) {
  switch (status) {
    case Status::kSuccess:
      return "success";
    case Status::kInexact:
      return "inexact";
    case Status::kNotConverged:
      return "not converged";
    case Status::kContradiction:
      return "contradiction";
    case Status::kNotFinite:
      return "not finite";
  }
  return "unknown";
}

}  // namespace taut
