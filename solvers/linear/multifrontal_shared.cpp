// The calls of MultifrontalFactor that threads share, and their plan.
#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <utility>

#include "core/base/interruption.h"
#include "solvers/linear/multifrontal_factor.h"

namespace taut {
namespace {

using Fronts = std::span<const MultifrontalFactor::Front>;

std::vector<int> parents_of(Fronts fronts) {
  std::vector<int> parent;
  for (const MultifrontalFactor::Front& front : fronts) parent.push_back(front.parent);
  return parent;
}

/// Time of each front in a factorisation [ns].
std::vector<double> factor_costs(Fronts fronts) {
  std::vector<double> costs;
  for (const MultifrontalFactor::Front& front : fronts)
    costs.push_back(front_cost(front.pivots, front.rows - front.pivots));
  return costs;
}

/// Bytes of each panel: passes stream them.
std::vector<double> pass_costs(Fronts fronts) {
  std::vector<double> costs;
  for (const MultifrontalFactor::Front& front : fronts)
    costs.push_back(sizeof(double) * static_cast<double>(front.leading) * front.pivots);
  return costs;
}

double sum_of(std::span<const double> costs) {
  double sum = 0;
  for (double cost : costs) sum += cost;
  return sum;
}

/// As many threads as have enough to do, of those that there are; `from`: what two need.
int threads_for(double work, double from, int wanted) {
  if (work < from) return 1;
  return from > 0 ? static_cast<int>(std::min<double>(wanted, 2 * work / from)) : wanted;
}

void plan_factorization(SharedFactorization& shared, Fronts fronts, std::span<const int> parent, int wanted,
                        const Sharing& sharing) {
  const std::vector<double> costs = factor_costs(fronts);
  const double total = sum_of(costs);
  shared.threads = threads_for(total, sharing.factor_from, wanted);
  if (shared.threads < 2 || longest_path(parent, costs) > sharing.longest_path * total) return;
  shared.cut = cut_below(parent, costs, total / (sharing.subtrees_a_thread * shared.threads));
}

void plan_passes(SharedPasses& shared, Fronts fronts, std::span<const int> parent, int wanted,
                 const Sharing& sharing) {
  const std::vector<double> costs = pass_costs(fronts);
  shared.threads = threads_for(sum_of(costs), sharing.solve_from, wanted);
  if (shared.threads > 1) shared.cut = cut_for_passes(parent, costs, shared.threads);
}

/// Room between what two threads work on: kernels read, and write back, up to three numbers behind a matrix.
std::int64_t with_gap(std::int64_t area) { return area == 0 ? 0 : (area + 11) & ~std::int64_t{7}; }

}  // namespace

double MultifrontalFactor::modelled_gain(int threads) const {
  const std::vector<double> costs = factor_costs(fronts_);
  const double time = listed_time(parents_of(fronts_), costs, threads);
  return time > 0 ? sum_of(costs) / time : 1;
}

// Threads are started only where there is work for them; where none could be, one does all as ever.
void MultifrontalFactor::plan_sharing() {
  shared_.reset();
  if (threads_ == nullptr || threads_->wanted() < 2) return;
  const std::vector<int> parent = parents_of(fronts_);
  auto shared = std::make_unique<SharedFronts>();
  SharedFactorization& factorization = shared->factorization;
  plan_factorization(factorization, fronts_, parent, threads_->wanted(), sharing_);
  plan_passes(shared->passes, fronts_, parent, threads_->wanted(), sharing_);
  if (factorization.cut.subtrees.empty() && shared->passes.cut.subtrees.empty()) return;
  shared->pool = &threads_->get();
  if (shared->pool->size() < 2) return;
  factorization.waiting = std::vector<std::atomic<int>>(fronts_.size());
  const int workers = std::min(std::max(factorization.threads, shared->passes.threads), shared->pool->size());
  shared->scratch.resize(static_cast<std::size_t>(workers));
  shared_ = std::move(shared);
}

// Contributions of fronts within subtrees are on stacks of the worker, those of the subtrees' roots and of
// fronts above in `contributions_`.  There, too, fronts of even and of odd depth are apart.  Brothers may
// live at the same time, whatever the order in which they are done; but what is below a front's children is
// used up before the front is begun, and its place may be the front's.
void MultifrontalFactor::plan_shared_contributions() {
  SharedFronts& shared = *shared_;
  const TreeCut& cut = shared.factorization.cut;
  std::int64_t stack = 0;
  for (const TreeCut::Subtree& subtree : cut.subtrees)
    stack = std::max(stack, stack_contributions(subtree.begin, subtree.root()));
  for (FrontScratch& scratch : shared.scratch)
    scratch.contributions.assign(static_cast<std::size_t>(stack) + 4, 0.0);

  std::vector<int> tops = cut.above;  // all but the fronts within subtrees
  for (const TreeCut::Subtree& subtree : cut.subtrees) tops.push_back(subtree.root());
  std::sort(tops.begin(), tops.end());
  std::vector<char> odd(fronts_.size(), 0);
  for (auto f = tops.rbegin(); f != tops.rend(); ++f)
    if (fronts_[*f].parent >= 0) odd[*f] = !odd[fronts_[*f].parent];
  using Sides = std::array<std::int64_t, 2>;
  std::vector<Sides> room(fronts_.size(), Sides{});  // of the front and all below
  Sides height{};
  const auto sum_above = [&](int f) -> Sides& {
    return fronts_[f].parent >= 0 ? room[fronts_[f].parent] : height;
  };
  std::vector<Sides> place(fronts_.size(), Sides{});  // among the brothers, then in all
  for (int f : tops) {
    std::int64_t& own = room[f][odd[f]];
    own = std::max(own, with_gap(contribution_area(fronts_[f])));
    place[f] = sum_above(f);
    for (int side : {0, 1}) sum_above(f)[side] += room[f][side];
  }
  for (auto f = tops.rbegin(); f != tops.rend(); ++f) {
    if (const int parent = fronts_[*f].parent; parent >= 0)
      for (int side : {0, 1}) place[*f][side] += place[parent][side];
    fronts_[*f].contribution = place[*f][odd[*f]] + (odd[*f] ? height[0] : 0);
  }
  contributions_.assign(static_cast<std::size_t>(height[0] + height[1]) + 4, 0.0);
}

// Rows are in the order of elimination: those outside the subtree are a front's last.
void MultifrontalFactor::plan_outside() {
  if (!shared_ || shared_->passes.cut.subtrees.empty()) return;
  SharedPasses& passes = shared_->passes;
  std::vector<int> front_of(static_cast<std::size_t>(size_));
  for (int f = 0; f < static_cast<int>(fronts_.size()); ++f)
    for (int k = 0; k < fronts_[f].pivots; ++k) front_of[rows_[fronts_[f].row_begin + k]] = f;
  std::int64_t place = 0;
  passes.first_outside.resize(fronts_.size());
  for (const TreeCut::Subtree& subtree : passes.cut.subtrees) {
    passes.begin.push_back(static_cast<int>(passes.outside.size()));
    for (int f = subtree.begin; f < subtree.end; ++f) {
      int first = fronts_[f].rows;
      while (front_of[rows_[fronts_[f].row_begin + first - 1]] > subtree.root()) --first;
      passes.first_outside[f] = first;
      if (first == fronts_[f].rows) continue;
      passes.outside.push_back({f, first, place});
      place += fronts_[f].rows - first;
    }
  }
  passes.begin.push_back(static_cast<int>(passes.outside.size()));
  passes.values.assign(static_cast<std::size_t>(place), 0.0);
}

void MultifrontalFactor::make_scratch(int most_rows) {
  const bool shares_factorization = shared_ && !shared_->factorization.cut.subtrees.empty();
  const auto make = [&](FrontScratch& scratch, bool factors) {
    scratch.pack.assign(factors ? packed_size(most_rows) : 0, 0.0);
    scratch.y.assign(static_cast<std::size_t>(most_rows), 0.0);
  };
  make(scratch_, !shares_factorization);
  if (shared_)
    for (FrontScratch& scratch : shared_->scratch) make(scratch, shares_factorization);
}

// Where there are very many subtrees, a task is every so many-th of them.
template <typename Work>
void MultifrontalFactor::share(const TreeCut& cut, int threads, const Work& work) {
  const int subtrees = static_cast<int>(cut.subtrees.size());
  const int tasks = std::min(subtrees, sharing_.tasks_a_thread * threads);
  const auto task = [&](int first, int worker) {
    for (int k = first; k < subtrees; k += tasks) work(cut.by_cost[k], shared_->scratch[worker]);
  };
  shared_->pool->run(tasks, std::ref(task), threads);
}

int MultifrontalFactor::factorize_shared(const SymmetricMatrix& A) {
  SharedFactorization& shared = shared_->factorization;
  const int none = std::numeric_limits<int>::max();
  shared.failed = none;
  for (int f : shared.cut.above) shared.waiting[f] = fronts_[f].child_end - fronts_[f].child_begin;
  share(shared.cut, shared.threads,
        [&](int subtree, FrontScratch& scratch) { factorize_subtree(A, subtree, scratch); });
  return shared.failed == none ? -1 : shared.failed.load();
}

// A subtree, and the fronts above whose last child this thread has finished.  As by one thread, fronts are
// skipped whose columns come after one that has failed.
void MultifrontalFactor::factorize_subtree(const SymmetricMatrix& A, int number, FrontScratch& scratch) {
  SharedFactorization& shared = shared_->factorization;
  double *stack = scratch.contributions.data(), *common = contributions_.data(), *pack = scratch.pack.data();
  const auto factorize = [&](int f, const Places& places) {
    if (fronts_[f].first_column > shared.failed) return;
    const int column = factorize_front(fronts_[f], A, places);
    if (column < 0) return;
    for (int first = shared.failed; column < first && !shared.failed.compare_exchange_weak(first, column);) {
    }
  };
  const TreeCut::Subtree subtree = shared.cut.subtrees[number];
  for (int f = subtree.begin; f < subtree.root(); ++f) factorize(f, {stack, stack, pack});
  factorize(subtree.root(), {stack, common, pack});
  int f = fronts_[subtree.root()].parent;
  for (; f >= 0 && --shared.waiting[f] == 0; f = fronts_[f].parent) factorize(f, {common, common, pack});
}

// Not to be interrupted: a solve is short.
void MultifrontalFactor::solve_shared(std::span<double> values) {
  const detail::InterruptScope scope(nullptr);
  const SharedPasses& passes = shared_->passes;
  double *x = values.data(), *own_y = scratch_.y.data();
  share(passes.cut, passes.threads,
        [&](int subtree, FrontScratch& scratch) { forward_subtree(subtree, x, scratch.y.data()); });
  forward_above(x, own_y);
  for (auto f = passes.cut.above.rbegin(); f != passes.cut.above.rend(); ++f) backward(fronts_[*f], x, own_y);
  share(passes.cut, passes.threads, [&](int subtree, FrontScratch& scratch) {
    const TreeCut::Subtree& fronts = passes.cut.subtrees[subtree];
    for (int f = fronts.end; f-- > fronts.begin;) backward(fronts_[f], x, scratch.y.data());
  });
}

void MultifrontalFactor::forward_subtree(int subtree, double* x, double* y) {
  SharedPasses& passes = shared_->passes;
  int next = passes.begin[subtree];
  for (int f = passes.cut.subtrees[subtree].begin; f < passes.cut.subtrees[subtree].end; ++f) {
    forward(fronts_[f], passes.first_outside[f], x, y);
    if (passes.first_outside[f] == fronts_[f].rows) continue;
    std::copy(y + passes.first_outside[f], y + fronts_[f].rows,
              passes.values.data() + passes.outside[next++].place);
  }
}

// In the fronts' postorder: of a subtree, what it adds to rows outside it; of a front above, all.
void MultifrontalFactor::forward_above(double* x, double* y) {
  const SharedPasses& passes = shared_->passes;
  const auto add_outside = [&](int subtree) {
    for (int k = passes.begin[subtree]; k < passes.begin[subtree + 1]; ++k) {
      const SharedPasses::Outside& outside = passes.outside[k];
      const Front& front = fronts_[outside.front];
      const double* value = passes.values.data() + outside.place;
      for (int i = outside.first; i < front.rows; ++i) x[rows_[front.row_begin + i]] += *value++;
    }
  };
  int subtree = 0;
  const int subtrees = static_cast<int>(passes.cut.subtrees.size());
  for (int f : passes.cut.above) {
    for (; subtree < subtrees && passes.cut.subtrees[subtree].root() < f; ++subtree) add_outside(subtree);
    forward(fronts_[f], fronts_[f].rows, x, y);
  }
}

}  // namespace taut
