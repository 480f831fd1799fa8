#pragma once

#include <set>
#include <vector>

#include "scenes/accuracy/reference_probes.h"
#include "scenes/accuracy/reference_run.h"

namespace taut::reference {

/// One run of a case: the simulator, the probes on it, and the measurements so far.
class Session {
 public:
  /// Impulses at t = 0 have acted when it returns.
  Session(Case& reference, const RunPlan& plan, CaseRun& result);

  void run();

 private:
  /// A quantity that can be measured, and where its result is.
  struct Pending {
    const Quantity* quantity;
    Measurement* result;
    bool about_the_run = false;
  };

  void list_quantities();
  void apply_impulses();
  std::set<double> instants(std::set<double> times) const;
  bool is_due(const Pending& pending, double t, double end) const;
  void run_motion();
  void run_static();
  void relax();
  bool accelerates();
  /// Steps of the case, or a little less, up to time t.  @returns false if one failed.
  bool advance(double t);
  bool step(double dt);
  void wait_for_events(double end);
  void measure(const Pending& pending);
  double dt() const { return plan_.step * case_.dt; }

  Case& case_;
  const RunPlan& plan_;
  CaseRun& result_;
  Simulator simulator_;
  std::vector<Pending> pending_;
  std::optional<Probes> probes_;
};

/// Keeps the worst of what was measured of a quantity so far.
void compare(const Quantity& quantity, const std::vector<double>& measured, double allowed,
             Measurement& result);

/// Measures the frequencies and mode shapes of a case.
void run_frequency(const Case& reference, const RunPlan& plan, CaseRun& result);

}  // namespace taut::reference
