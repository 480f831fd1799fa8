#pragma once

#include <optional>
#include <string>

#include "solvers/common/settings.h"

namespace taut {

/// What `taut accuracy` was asked for.
struct AccuracyOptions {
  std::string references;                ///< folder; empty: tests/references above the program
  std::string only;                      ///< cases with this in their id
  std::optional<Integrator> integrator;  ///< none: chosen by case (reference::integrator_for)
  std::optional<FactorChoice> factor;
  int jobs = 0;           ///< cases that run at the same time; 0: as many as the machine has cores
  bool summary = false;   ///< a line per case in place of one per quantity
  bool contacts = false;  ///< worlds with contact against closed forms and laws, in place of the cases
  std::string study;      ///< folder for the comparison of methods and the convergence study; empty: cases
  /// Files for JSON and CSV; "-" is the standard output, in place of the table; none: not written.
  std::optional<std::string> json, csv;
};

/// `taut accuracy`: runs every case of a folder at the step of its tolerances and at half of it, and
/// compares; or, with `contacts`, the worlds of reference::contact_cases().
/// @returns kExitSuccess, or kExitFailure if a quantity missed its tolerance, a file could not be read or
/// nothing was measured.
int accuracy_command(const AccuracyOptions& options);

}  // namespace taut
