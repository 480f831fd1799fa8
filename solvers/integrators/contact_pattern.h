#pragma once

#include <span>
#include <utility>
#include <vector>

#include "core/world/world.h"
#include "solvers/complementarity/stage_solver.h"
#include "solvers/integrators/multiplier_prediction.h"
#include "solvers/integrators/row_values.h"
#include "solvers/laws/contact_forces.h"
#include "solvers/system/constraint_system.h"

namespace taut {

class Archive;

/// Contacts come and go: found at the end of a drift, they join the rows of the system for the velocity stage
/// of that step and the position stage of the next, and everything that has a value for each row follows.
/// (solvers/integrators, "RATTLE")
class ContactPattern {
 public:
  /// All of them must outlive it.
  ContactPattern(const World& world, ConstraintSystem& system, ContactForces& contacts, StageSolver& stages,
                 RowValues& values, MultiplierPrediction& prediction);

  /// The longest step that may come [s]: contacts are found as far ahead as that.
  void set_horizon(double horizon) { horizon_ = horizon; }
  /// Contacts where a scheme starts.
  void start(const State& state);
  /// Contacts at the end of a drift; `state` has the velocities of the drift.
  void move_on(const State& state);
  /// The next start() finds contacts stretched so (ContactForces::recall()).
  void recall(std::vector<ContactStretch> stretches) { contacts_.recall(std::move(stretches)); }
  /// Takes over the contacts of the same world before its pattern changed, before start().
  void inherit(ContactPattern& old);
  /// The next guess has no impulses of contacts.
  void forget_impulses();
  /// The slots that contacts have now are rows of the system; what belonged to rows before is lost.
  void renew();

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive);

 private:
  void take_over_slots();
  void set_slots();
  void move_rows(std::span<const int> from);

  const World& world_;
  ConstraintSystem& system_;
  ContactForces& contacts_;
  StageSolver& stages_;
  RowValues& values_;
  MultiplierPrediction& prediction_;
  double horizon_ = 0;
};

}  // namespace taut
