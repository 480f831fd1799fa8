#include "solvers/complementarity/contact_islands.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <utility>

#include "solvers/complementarity/contact_solver_tuning.h"

namespace taut {
namespace {

template <typename Value>
void pick(std::span<const Value> whole, std::span<const int> rows, std::vector<Value>& part) {
  part.resize(rows.size());
  for (std::size_t r = 0; r < rows.size(); ++r) part[r] = whole[rows[r]];
}

void put(std::span<const double> part, std::span<const int> rows, std::span<double> whole) {
  for (std::size_t r = 0; r < rows.size(); ++r) whole[rows[r]] = part[r];
}

}  // namespace

ContactIslands::Island::Island(ContactForces& all, SystemPart p)
    : part(std::move(p)), contacts(all.table()) {}

ContactIslands::ContactIslands(ConstraintSystem& system, ContactForces& contacts, int threads)
    : system_(system), contacts_(contacts), threads_(detail::thread_count(threads)) {
  scratch_.resize(threads_);
}

std::span<const std::unique_ptr<ContactIslands::Island>> ContactIslands::known() const {
  return known_ ? std::span(islands_) : std::span<const std::unique_ptr<Island>>();
}

void ContactIslands::restore() {
  islands_.clear();
  if (std::exchange(known_, false)) find();
}

/// What connects moving bodies, in the order of their first bodies.
std::vector<SystemPart> ContactIslands::partition() {
  const Rows& rows = system_.rows();
  const auto moves = [&](int body) { return !system_.mass()[body].fixed; };
  const auto sides_of = [&](int j) {
    const Rows::JointRows& joint = rows.joints()[j];
    return std::span(rows.sides()).subspan(joint.first_side, joint.row_count > 0 ? joint.side_count : 0);
  };
  const int joints = static_cast<int>(rows.joints().size()), contacts = rows.contact_count();
  std::vector<int> first_body(joints, -1);
  connected_.reset(rows.body_count());
  for (int j = 0; j < joints; ++j)
    for (const Rows::Side& side : sides_of(j)) {
      if (!moves(side.body)) continue;
      if (first_body[j] < 0) first_body[j] = side.body;
      connected_.join(first_body[j], side.body);
    }
  std::vector<SystemPart> parts;
  std::vector<int> part_of(rows.body_count(), -1);
  for (int j = 0; j < joints; ++j) {
    if (first_body[j] < 0) continue;
    int& index = part_of[connected_.find(first_body[j])];
    if (index < 0) {
      index = static_cast<int>(parts.size());
      parts.emplace_back();
    }
    SystemPart& part = parts[index];
    part.joints.push_back(j);
    if (j >= joints - contacts) part.slots.push_back(j - (joints - contacts));
    const Rows::JointRows& joint = rows.joints()[j];
    for (int r = 0; r < joint.row_count; ++r) part.rows.push_back(joint.first_row + r);
    for (const Rows::Side& side : sides_of(j)) part.bodies.push_back(side.body);
  }
  for (SystemPart& part : parts) {
    std::sort(part.bodies.begin(), part.bodies.end());
    part.bodies.erase(std::unique(part.bodies.begin(), part.bodies.end()), part.bodies.end());
  }
  return parts;
}

/// The islands of the present rows.  Those of before that have the same bodies, joints and pairs in contact
/// only learn where their rows and slots are now.
void ContactIslands::find() {
  if (known_) return;
  known_ = true;
  std::vector<SystemPart> parts = partition();
  if (parts.size() <= 1) {
    islands_.clear();
    for (SystemPart& part : parts) islands_.push_back(std::make_unique<Island>(contacts_, std::move(part)));
    return;
  }
  std::vector<int> with_first_body(system_.rows().body_count(), -1);
  for (std::size_t i = 0; i < islands_.size(); ++i)
    if (islands_[i]->system) with_first_body[islands_[i]->first_body] = static_cast<int>(i);
  std::vector<std::unique_ptr<Island>> found;
  for (SystemPart& part : parts) {
    auto island = std::make_unique<Island>(contacts_, std::move(part));
    for (int k : island->part.slots) island->pairs.push_back(contacts_.cache().slots()[k].at);
    const std::vector<int>& bodies = island->part.bodies;
    island->first_body =
        *std::find_if(bodies.begin(), bodies.end(), [&](int b) { return !system_.mass()[b].fixed; });
    if (const int i = with_first_body[island->first_body]; i >= 0 && islands_[i]->is_like(*island)) {
      islands_[i]->part = std::move(island->part);
      island = std::move(islands_[i]);
      island->weight_version = -1;
      island->solver->forget_factor();  // so that what it comes to follows from the present pattern
    }
    found.push_back(std::move(island));
  }
  islands_ = std::move(found);
  plan();
}

/// Large ones first, in parallel if there is enough beside the largest one.
void ContactIslands::plan() {
  const auto rows_of = [&](int i) { return islands_[i]->part.rows.size(); };
  order_.resize(islands_.size());
  std::iota(order_.begin(), order_.end(), 0);
  std::stable_sort(order_.begin(), order_.end(), [&](int a, int b) { return rows_of(a) > rows_of(b); });
  std::size_t others = 0;
  for (std::size_t i = 1; i < order_.size(); ++i) others += rows_of(order_[i]);
  parallel_ = threads_ > 1 && others >= ContactSolverTuning::kRowsForThreads;
  if (parallel_ && !pool_) pool_ = std::make_unique<detail::ThreadPool>(threads_);
}

bool ContactIslands::Island::is_like(const Island& other) const {
  const auto joints_of = [](const SystemPart& p) {
    return std::span(p.joints).first(p.joints.size() - p.slots.size());
  };
  return part.bodies == other.part.bodies && pairs == other.pairs &&
         std::ranges::equal(joints_of(part), joints_of(other.part));
}

void ContactIslands::make(Island& island, std::vector<int>& scratch) {
  island.system = std::make_unique<ConstraintSystem>(system_, island.part, scratch);
  island.solver.emplace(*island.system, island.contacts);
}

/// Rows of the island from those of the whole.
StageProblem ContactIslands::gather(Island& island, const StageProblem& whole, std::vector<int>& scratch) {
  const SystemPart& part = island.part;
  if (!island.system) make(island, scratch);
  if (island.weight_version < 0) island.contacts.choose(part.slots, island.system->rows());
  if (island.weight_version != system_.weight_version()) island.system->take_values(system_, part);
  island.weight_version = system_.weight_version();
  pick(whole.laws, part.rows, island.laws);
  pick(whole.b, part.rows, island.b);
  pick(whole.effective_mass, part.rows, island.effective_mass);
  pick(std::span<const double>(whole.lambda), part.rows, island.lambda);
  island.w.resize(part.rows.size());
  island.contacts.set_effective_masses(island.effective_mass);
  island.record = {};
  return {island.laws, island.b, island.effective_mass, island.lambda, island.w};
}

bool ContactIslands::solve(const StageProblem& problem, ContactLimits limits, StageRecord& record) {
  limits.warm_start = true;
  (void)system_.weighted();  // made now, and not by each of the threads
  const auto work = [&](int task, int worker) {
    Island& island = *islands_[order_[task]];
    island.done = island.solver->solve(gather(island, problem, scratch_[worker]), limits, island.record);
  };
  const int tasks = static_cast<int>(order_.size());
  if (parallel_)
    pool_->run(tasks, std::ref(work));  // by reference, which allocates nothing
  else
    for (int task = 0; task < tasks; ++task) work(task, 0);
  bool done = true;
  for (const auto& island : islands_) {
    put(island->lambda, island->part.rows, problem.lambda);
    put(island->w, island->part.rows, problem.w);
    system_.take_counters(*island->system);
    record.add(island->record);
    done = done && island->done;
  }
  return done;
}

}  // namespace taut
