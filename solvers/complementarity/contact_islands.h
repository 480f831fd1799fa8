#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/base/union_find.h"
#include "solvers/complementarity/contact_solver.h"
#include "solvers/laws/contact_forces.h"

namespace taut {

class Archive;

/// The islands of a system with contacts: bodies that joints and slots of contacts connect, not by way of
/// fixed ones, have nothing to do with others in a stage.  Each is a system of its own with its own order,
/// factor, Newton's method and end; they are solved in parallel.  (solvers/complementarity, "Islands")
///
/// An island whose joints and slots are the same as before the pattern changed is kept, with its analysis.
/// What one comes to depends on nothing but itself: the same bits with any number of threads.
class ContactIslands {
 public:
  /// @param threads 0: as many as the machine has.
  ContactIslands(ConstraintSystem& system, ContactForces& contacts, int threads);

  /// Threads that could not be started.
  int missing_threads() const { return pool_ ? pool_->missing() : 0; }
  /// The system has other rows.
  void forget_pattern() { known_ = false; }
  /// All is one island, which is best solved as it is.
  bool is_one() { return find(), islands_.size() <= 1; }
  /// Solves all, each with its part of the problem, and with a warm start.  False if one could not be solved.
  bool solve(const StageProblem& problem, ContactLimits limits, StageRecord& record);

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive);

 private:
  /// One of them, with its own copy of all that it works on.
  struct Island {
    Island(ContactForces& all, SystemPart part);
    /// Whether the other has the same bodies, joints and pairs in contact.
    bool is_like(const Island& other) const;

    SystemPart part;
    int first_body = -1;                       // that moves
    std::vector<Rows::ContactSlot> pairs;      // of the slots
    std::unique_ptr<ConstraintSystem> system;  // made when it is first solved
    ContactLaws contacts;
    std::optional<ContactSolver> solver;
    long weight_version = -1;  // of the whole, whose values `system` has
    std::vector<RowLaw> laws;
    std::vector<double> b, effective_mass, lambda, w;
    StageRecord record;
    bool done = false;
  };

  /// Of the present rows, if they are known; else none.
  std::span<const std::unique_ptr<Island>> known() const;
  /// None are kept; those of the present rows are found if they were known.
  void restore();
  void find();
  void plan();
  std::vector<SystemPart> partition();
  void make(Island& island, std::vector<int>& scratch);
  StageProblem gather(Island& island, const StageProblem& whole, std::vector<int>& scratch);

  ConstraintSystem& system_;
  ContactForces& contacts_;
  int threads_;
  std::unique_ptr<detail::ThreadPool> pool_;  // made when there is work for it
  bool known_ = false, parallel_ = false;
  UnionFind connected_;  // bodies
  std::vector<std::unique_ptr<Island>> islands_;
  std::vector<int> order_;                 // of tasks
  std::vector<std::vector<int>> scratch_;  // of each worker
};

}  // namespace taut
