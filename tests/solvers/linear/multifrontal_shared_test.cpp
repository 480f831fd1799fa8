#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <limits>
#include <memory>
#include <random>
#include <system_error>
#include <vector>

#include "core/base/interruption.h"
#include "solvers/linear/block_ordering.h"
#include "solvers/linear/multifrontal_factor.h"
#include "tests/allocation_counter.h"
#include "tests/solvers/linear/block_matrices.h"

namespace taut::multifrontal_shared_test {
namespace {

using namespace block_matrices;

/// All that can be cut is shared, however small.
constexpr Sharing kAll{
    .factor_from = 0, .solve_from = 0, .subtrees_a_thread = 2, .longest_path = 1, .tasks_a_thread = 3};

/// Edges between places of the postordered minimum degree order.
Edges ordered(int blocks, const Edges& edges) {
  std::vector<std::set<int>> neighbours(static_cast<std::size_t>(blocks));
  for (auto [i, j] : edges)
    if (i != j) neighbours[i].insert(j), neighbours[j].insert(i);
  BlockGraph graph;
  for (const std::set<int>& of_block : neighbours) {
    graph.block_size.push_back(3);
    graph.neighbour.insert(graph.neighbour.end(), of_block.begin(), of_block.end());
    graph.start.push_back(static_cast<int>(graph.neighbour.size()));
  }
  const BlockOrdering ordering = order_blocks(graph);
  std::vector<int> place(static_cast<std::size_t>(blocks));
  for (int k = 0; k < blocks; ++k) place[ordering.node_at[k]] = k;
  Edges result;
  for (auto [i, j] : edges) result.emplace_back(place[i], place[j]);
  return result;
}

SymmetricMatrix grid(int width, std::mt19937& random) {
  return block_matrix(std::vector<int>(static_cast<std::size_t>(width * width), 3),
                      ordered(width * width, grid_edges(width, width)), random);
}

/// Several trees of a few and of many blocks.
SymmetricMatrix random_matrix(int trial, std::mt19937& random) {
  std::uniform_int_distribution<int> count(2, 200), size(1, 6);
  std::vector<int> sizes(static_cast<std::size_t>(count(random)));
  for (int& s : sizes) s = size(random);
  const int blocks = static_cast<int>(sizes.size());
  std::uniform_int_distribution<int> block(0, blocks - 1);
  Edges edges;
  for (int e = (1 + trial % 5) * blocks / 3; e > 0; --e) {
    const int i = block(random), j = block(random);
    edges.emplace_back(i, j);
  }
  return block_matrix(sizes, ordered(blocks, edges), random);
}

void expect_same_numbers(std::span<const double> a, std::span<const double> b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size_bytes()), 0);
}

void expect_same_panels(const MultifrontalFactor& a, const MultifrontalFactor& b) {
  ASSERT_EQ(a.fronts().size(), b.fronts().size());
  for (std::size_t f = 0; f < a.fronts().size(); ++f) {
    const MultifrontalFactor::Front& front = a.fronts()[f];
    const std::size_t numbers = static_cast<std::size_t>(front.leading) * front.pivots;
    expect_same_numbers(a.panels().subspan(front.panel, numbers),
                        b.panels().subspan(b.fronts()[f].panel, numbers));
  }
}

std::vector<double> solution(MultifrontalFactor& factor, int size) {
  std::vector<double> x(static_cast<std::size_t>(size));
  for (int i = 0; i < size; ++i) x[i] = std::sin(1.0 + i);
  factor.solve(x);
  return x;
}

class SharedFactorTest : public ::testing::TestWithParam<int> {
 protected:
  /// The same matrix, by one thread and by many.
  void expect_same(const SymmetricMatrix& A) {
    MultifrontalFactor alone(front_kernels()), shared(front_kernels(), &threads_, kAll);
    alone.analyze(A);
    shared.analyze(A);
    for (int again = 0; again < 2; ++again) {
      ASSERT_EQ(alone.factorize(A), -1);
      ASSERT_EQ(shared.factorize(A), -1);
      expect_same_panels(alone, shared);
      expect_same_numbers(alone.relative_pivots(), shared.relative_pivots());
      expect_same_numbers(solution(alone, A.size()), solution(shared, A.size()));
    }
  }
  /// Some diagonal entry is this.
  void make_bad(SymmetricMatrix& A, double value) {
    const int c = std::uniform_int_distribution<int>(0, A.size() - 1)(random_);
    int t = A.column_start[c];
    while (A.row_index[t] != c) ++t;
    A.values[t] = value;
  }
  detail::LazyPool threads_{GetParam()};
  std::mt19937 random_{11};
};

TEST_P(SharedFactorTest, HasTheSameBitsOnRandomMatrices) {
  for (int trial = 0; trial < 100; ++trial) {
    SCOPED_TRACE(trial);
    expect_same(random_matrix(trial, random_));
    if (HasFailure()) return;
  }
}

TEST_P(SharedFactorTest, HasTheSameBitsOnGrids) {
  for (const int width : {3, 10, 25, 40}) expect_same(grid(width, random_));
}

TEST_P(SharedFactorTest, IsSharedWhereThereAreThreads) {
  const SymmetricMatrix A = grid(25, random_);
  MultifrontalFactor shared(front_kernels(), &threads_, kAll), unshared(front_kernels(), &threads_);
  shared.analyze(A);
  unshared.analyze(A);
  EXPECT_EQ(unshared.shared(), nullptr);  // too small
  EXPECT_EQ(shared.shared() != nullptr, GetParam() > 1);
  if (GetParam() == 1) return;
  EXPECT_GE(static_cast<int>(shared.shared()->factorization.cut.subtrees.size()), GetParam());
  EXPECT_GE(shared.shared()->passes.cut.subtrees.size(), 2u);
  EXPECT_FALSE(shared.shared()->passes.outside.empty());
}

/// Earlier and later columns fail, in one subtree or in several, or above.
TEST_P(SharedFactorTest, NamesTheSameFailedColumn) {
  const SymmetricMatrix good = grid(12, random_);
  MultifrontalFactor alone(front_kernels()), shared(front_kernels(), &threads_, kAll);
  alone.analyze(good);
  shared.analyze(good);
  for (int trial = 0; trial < 300; ++trial) {
    SymmetricMatrix bad = good;
    for (int k = 0; k <= trial % 4; ++k)
      make_bad(bad, trial % 5 == 4 ? std::numeric_limits<double>::quiet_NaN() : -1.0);
    const int failed = alone.factorize(bad);
    ASSERT_GE(failed, 0);
    ASSERT_EQ(shared.factorize(bad), failed) << trial;
    if (trial % 30 == 0) {
      ASSERT_EQ(shared.factorize(good), -1);
      ASSERT_EQ(alone.factorize(good), -1);
      expect_same_panels(alone, shared);
    }
  }
}

/// The same where the fronts' order is not the matrix's.
TEST_P(SharedFactorTest, NamesTheSameFailedColumnOfMatricesThatAreNotPostordered) {
  for (int trial = 0; trial < 300; ++trial) {
    std::uniform_int_distribution<int> count(20, 80);
    const int blocks = count(random_);
    std::uniform_int_distribution<int> block(0, blocks - 1);
    Edges edges;
    for (int e = (1 + trial % 3) * blocks / 2; e > 0; --e) {
      const int i = block(random_), j = block(random_);
      edges.emplace_back(i, j);
    }
    SymmetricMatrix A = block_matrix(std::vector<int>(static_cast<std::size_t>(blocks), 2), edges, random_);
    MultifrontalFactor alone(front_kernels()), shared(front_kernels(), &threads_, kAll);
    alone.analyze(A);
    shared.analyze(A);
    for (int k = 0; k <= trial % 4; ++k) make_bad(A, -1);
    ASSERT_EQ(shared.factorize(A), alone.factorize(A)) << trial;
  }
}

TEST_P(SharedFactorTest, EndsEarlyAndRecovers) {
  const SymmetricMatrix A = grid(25, random_);
  MultifrontalFactor alone(front_kernels()), shared(front_kernels(), &threads_, kAll);
  alone.analyze(A);
  shared.analyze(A);
  ASSERT_EQ(alone.factorize(A), -1);
  for (int patience = 0; patience < 4; ++patience) {
    std::atomic<int> asked = 0;
    const detail::InterruptScope::Question question = [&] { return ++asked > patience; };
    {
      const detail::InterruptScope scope(&question);
      if (shared.shared()) {
        EXPECT_THROW((void)shared.factorize(A), detail::Interrupted);
      }
    }
    ASSERT_EQ(shared.factorize(A), -1);
    expect_same_panels(alone, shared);
  }
  const detail::InterruptScope::Question at_once = [] { return true; };
  const detail::InterruptScope scope(&at_once);
  expect_same_numbers(solution(alone, A.size()), solution(shared, A.size()));  // solves are not asked
}

TEST_P(SharedFactorTest, AllocatesNothingInNumericCalls) {
  const SymmetricMatrix A = grid(25, random_);
  MultifrontalFactor shared(front_kernels(), &threads_, kAll);
  shared.analyze(A);
  std::vector<double> x(static_cast<std::size_t>(A.size()), 1.0);
  int failed = shared.factorize(A);
  shared.solve(x);
  const long before = allocation_count();
  failed = std::max(failed, shared.factorize(A));
  shared.solve(x);
  EXPECT_EQ(allocation_count(), before);
  EXPECT_EQ(failed, -1);
}

TEST_P(SharedFactorTest, AnalysesAnotherPatternAfterwards) {
  MultifrontalFactor shared(front_kernels(), &threads_, kAll);
  for (const int width : {20, 1, 8, 30}) {
    const SymmetricMatrix A = grid(width, random_);
    MultifrontalFactor alone(front_kernels());
    alone.analyze(A);
    shared.analyze(A);
    ASSERT_EQ(alone.factorize(A), -1);
    ASSERT_EQ(shared.factorize(A), -1);
    expect_same_numbers(solution(alone, A.size()), solution(shared, A.size()));
  }
}

INSTANTIATE_TEST_SUITE_P(Threads, SharedFactorTest, ::testing::Values(1, 2, 3, 8));

/// Of eight threads that are wanted, `possible` can be started.
TEST(SharedFactor, GoesOnWithTheThreadsThatCouldBeStarted) {
  std::mt19937 random(5);
  const SymmetricMatrix A = grid(20, random);
  MultifrontalFactor alone(front_kernels());
  alone.analyze(A);
  ASSERT_EQ(alone.factorize(A), -1);
  for (const int possible : {0, 1, 3}) {
    detail::LazyPool threads(8, [possible, started = std::make_shared<int>(0)](std::function<void()> work) {
      if (++*started > possible)
        throw std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again));
      return detail::start_thread(std::move(work));
    });
    MultifrontalFactor shared(front_kernels(), &threads, kAll);
    shared.analyze(A);
    EXPECT_EQ(shared.shared() != nullptr, possible > 0);
    EXPECT_EQ(threads.missing(), 7 - possible);
    ASSERT_EQ(shared.factorize(A), -1);
    expect_same_panels(alone, shared);
    expect_same_numbers(solution(alone, A.size()), solution(shared, A.size()));
  }
}

/// A chain has no branches to share, and one thread no one to share with.
TEST(SharedFactor, CostsNothingWhereThereIsNothingToShare) {
  std::mt19937 random(5);
  detail::LazyPool two(2), one(1);
  Edges chain;
  for (int i = 0; i + 1 < 300; ++i) chain.emplace_back(i, i + 1);
  Sharing tuning = kAll;
  tuning.longest_path = 0.8;
  const SymmetricMatrix A = block_matrix(std::vector<int>(300, 3), chain, random), B = grid(25, random);
  MultifrontalFactor in_a_row(front_kernels(), &two, tuning);
  in_a_row.analyze(A);
  EXPECT_EQ(in_a_row.shared(), nullptr);

  MultifrontalFactor alone(front_kernels()), unshared(front_kernels(), &one, kAll),
      shared(front_kernels(), &two, kAll);
  for (MultifrontalFactor* factor : {&alone, &unshared, &shared}) factor->analyze(B);
  EXPECT_EQ(unshared.shared(), nullptr);
  EXPECT_EQ(unshared.contribution_room(), alone.contribution_room());
  EXPECT_EQ(unshared.panels().size(), alone.panels().size());
  EXPECT_LT(shared.contribution_room(), 4 * alone.contribution_room());
}

}  // namespace
}  // namespace taut::multifrontal_shared_test
