#include "solvers/linear/multifrontal_factor.h"

#include <cholmod.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <atomic>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/allocation_counter.h"
#include "tests/solvers/linear/block_matrices.h"

namespace taut::multifrontal_factor_test {
namespace {

using namespace block_matrices;

Eigen::MatrixXd dense(const SymmetricMatrix& A) {
  Eigen::MatrixXd D = Eigen::MatrixXd::Zero(A.size(), A.size());
  for (int c = 0; c < A.size(); ++c)
    for (int t = A.column_start[c]; t < A.column_start[c + 1]; ++t)
      if (A.row_index[t] >= c) D(A.row_index[t], c) = D(c, A.row_index[t]) = A.values[t];
  return D;
}

Eigen::VectorXd random_vector(int size, std::mt19937& random) {
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  Eigen::VectorXd x(size);
  for (double& v : x) v = value(random);
  return x;
}

// The same matrix, factored by CHOLMOD in the same order.
class Reference {
 public:
  explicit Reference(const SymmetricMatrix& A) {
    cholmod_start(&common_);
    common_.print = 0;
    common_.nmethods = 1;
    common_.method[0].ordering = CHOLMOD_NATURAL;
    common_.postorder = 0;
    common_.supernodal = CHOLMOD_SIMPLICIAL;
    common_.final_ll = 1;
    cholmod_triplet* T =
        cholmod_allocate_triplet(A.size(), A.size(), A.values.size(), -1, CHOLMOD_REAL, &common_);
    for (int c = 0; c < A.size(); ++c) {
      for (int t = A.column_start[c]; t < A.column_start[c + 1]; ++t) {
        if (A.row_index[t] < c) continue;
        static_cast<int*>(T->i)[T->nnz] = A.row_index[t];
        static_cast<int*>(T->j)[T->nnz] = c;
        static_cast<double*>(T->x)[T->nnz++] = A.values[t];
      }
    }
    cholmod_sparse* S = cholmod_triplet_to_sparse(T, 0, &common_);
    L_ = cholmod_analyze(S, &common_);
    cholmod_factorize(S, L_, &common_);
    cholmod_free_sparse(&S, &common_);
    cholmod_free_triplet(&T, &common_);
  }
  ~Reference() {
    cholmod_free_factor(&L_, &common_);
    cholmod_finish(&common_);
  }
  Eigen::VectorXd solve(const Eigen::VectorXd& b) {
    cholmod_dense* B = cholmod_zeros(b.size(), 1, CHOLMOD_REAL, &common_);
    std::copy(b.begin(), b.end(), static_cast<double*>(B->x));
    cholmod_dense* X = cholmod_solve(CHOLMOD_A, L_, B, &common_);
    Eigen::VectorXd x = Eigen::Map<Eigen::VectorXd>(static_cast<double*>(X->x), b.size());
    cholmod_free_dense(&X, &common_);
    cholmod_free_dense(&B, &common_);
    return x;
  }
  Eigen::VectorXd pivots() const {
    Eigen::VectorXd d(static_cast<Eigen::Index>(L_->n));
    for (Eigen::Index j = 0; j < d.size(); ++j) {
      const double l = static_cast<double*>(L_->x)[static_cast<int*>(L_->p)[j]];
      d[j] = l * l;
    }
    return d;
  }
  int first_failure() const { return static_cast<int>(L_->minor); }

 private:
  cholmod_common common_;
  cholmod_factor* L_ = nullptr;
};

std::span<double> span_of(Eigen::VectorXd& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }

Eigen::VectorXd pivots_of(const Factor& factor, const SymmetricMatrix& A) {
  const std::span<const double> relative = factor.relative_pivots();
  return Eigen::Map<const Eigen::VectorXd>(relative.data(), A.size()).cwiseProduct(dense(A).diagonal());
}

// Diagonally dominant matrices have condition numbers of a few hundred; 1e-12 is far above their round-off.
constexpr double kTolerance = 1e-12;

void expect_factor(MultifrontalFactor& factor, const SymmetricMatrix& A, std::mt19937& random) {
  ASSERT_EQ(factor.factorize(A), -1);
  const Eigen::MatrixXd D = dense(A);
  const Eigen::LLT<Eigen::MatrixXd> llt(D);
  const Eigen::VectorXd b = random_vector(A.size(), random);
  Eigen::VectorXd x = b;
  factor.solve(span_of(x));
  const Eigen::VectorXd expected = llt.solve(b), d = pivots_of(factor, A);
  EXPECT_LE((x - expected).lpNorm<Eigen::Infinity>(), kTolerance * expected.lpNorm<Eigen::Infinity>());
  const Eigen::MatrixXd L = llt.matrixL();
  for (int j = 0; j < A.size(); ++j) EXPECT_NEAR(d[j], L(j, j) * L(j, j), kTolerance * d[j]) << "pivot " << j;
}

class MultifrontalFactorTest : public ::testing::TestWithParam<const FrontKernels*> {
 protected:
  void SetUp() override {
    if (GetParam() == nullptr) GTEST_SKIP() << "kernels not built, or not for this processor";
  }
  void expect_factor_of(const std::vector<int>& sizes, const Edges& edges) {
    const SymmetricMatrix A = block_matrix(sizes, edges, random_);
    MultifrontalFactor factor(*GetParam());
    factor.analyze(A);
    expect_factor(factor, A, random_);
  }
  std::mt19937 random_{7};
};

TEST_P(MultifrontalFactorTest, SolvesRandomBlockMatrices) {
  std::uniform_int_distribution<int> count(1, 60), size(1, 6);
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<int> sizes(static_cast<std::size_t>(count(random_)));
    for (int& s : sizes) s = size(random_);
    const int blocks = static_cast<int>(sizes.size());
    std::uniform_int_distribution<int> block(0, blocks - 1);
    Edges edges;
    for (int e = trial % 5 * blocks / 2; e > 0; --e) edges.emplace_back(block(random_), block(random_));
    SCOPED_TRACE(trial);
    expect_factor_of(sizes, edges);
    if (HasFatalFailure()) return;
  }
}

TEST_P(MultifrontalFactorTest, SolvesChains) {
  for (int links : {2, 3, 10, 100, 300}) {
    Edges edges;
    for (int i = 0; i + 1 < links; ++i) edges.emplace_back(i, i + 1);
    for (int size : {1, 3, 5, 6})
      expect_factor_of(std::vector<int>(static_cast<std::size_t>(links), size), edges);
  }
}

TEST_P(MultifrontalFactorTest, SolvesHubsBeforeAndAfterTheirSpokes) {
  Edges first, last;
  for (int i = 1; i < 100; ++i) {
    first.emplace_back(0, i);
    last.emplace_back(i - 1, 99);
  }
  expect_factor_of(std::vector<int>(100, 3), first);
  expect_factor_of(std::vector<int>(100, 3), last);
}

TEST_P(MultifrontalFactorTest, SolvesGrids) {
  for (int width : {2, 5, 9, 16})
    expect_factor_of(std::vector<int>(static_cast<std::size_t>(width * width), 3), grid_edges(width, width));
}

TEST_P(MultifrontalFactorTest, SolvesDenseMatricesOfAllSizesOfPanel) {
  for (int blocks : {1, 2, 5, 11, 21, 22, 43, 44, 64, 65, 100, 150}) {
    Edges edges;
    for (int i = 0; i < blocks; ++i)
      for (int j = 0; j < i; ++j) edges.emplace_back(i, j);
    expect_factor_of(std::vector<int>(static_cast<std::size_t>(blocks), 3), edges);
  }
}

// Few pivots above many rows, with more pivots than one panel or one packed strip of them holds.
TEST_P(MultifrontalFactorTest, SolvesLargeFrontsWithContributions) {
  for (int pivots : {3, 50, 66, 131, 200}) {
    const int blocks = 2 * pivots + 60;
    Edges edges;
    for (int half = 0; half < 2; ++half)
      for (int i = 0; i < pivots + 60; ++i)
        for (int j = 0; j < i; ++j) {
          const auto name = [&](int k) { return k < pivots ? half * pivots + k : k + pivots; };
          edges.emplace_back(name(i), name(j));
        }
    expect_factor_of(std::vector<int>(static_cast<std::size_t>(blocks), 1), edges);
  }
}

TEST_P(MultifrontalFactorTest, SolvesOneByOneEmptyAndDisconnectedMatrices) {
  expect_factor_of({1}, {});
  expect_factor_of({}, {});
  expect_factor_of({3, 1, 6, 2}, {});
  expect_factor_of({3, 1, 6, 2, 3, 3}, {{0, 3}, {1, 4}, {2, 5}});
}

TEST_P(MultifrontalFactorTest, AgreesWithCholmod) {
  Edges edges = grid_edges(24, 24);
  for (int i = 0; i + 30 < 576; i += 7) edges.emplace_back(i, i + 30);
  const SymmetricMatrix A = block_matrix(std::vector<int>(576, 3), edges, random_);
  Reference reference(A);
  MultifrontalFactor factor(*GetParam());
  factor.analyze(A);
  ASSERT_EQ(factor.factorize(A), -1);
  const Eigen::VectorXd b = random_vector(A.size(), random_), expected = reference.solve(b);
  Eigen::VectorXd x = b;
  const Eigen::VectorXd d = pivots_of(factor, A);
  factor.solve(span_of(x));
  EXPECT_LE((x - expected).lpNorm<Eigen::Infinity>(), kTolerance * expected.lpNorm<Eigen::Infinity>());
  EXPECT_LE((d - reference.pivots()).cwiseQuotient(d).lpNorm<Eigen::Infinity>(), kTolerance);
}

TEST_P(MultifrontalFactorTest, NamesTheFirstBadPivotAndRecovers) {
  std::uniform_int_distribution<int> column(0, 3 * 64 - 1);
  const SymmetricMatrix good = block_matrix(std::vector<int>(64, 3), grid_edges(8, 8), random_);
  MultifrontalFactor factor(*GetParam());
  factor.analyze(good);
  for (int trial = 0; trial < 200; ++trial) {
    SymmetricMatrix bad = good;
    for (int k = 0; k <= trial % 3; ++k) {
      const int c = column(random_);
      int t = bad.column_start[c];
      while (bad.row_index[t] != c) ++t;
      bad.values[t] = trial % 4 == 3 ? -std::numeric_limits<double>::infinity() : -1.0;
    }
    EXPECT_EQ(factor.factorize(bad), Reference(bad).first_failure());
    if (trial % 20 == 0) expect_factor(factor, good, random_);
  }
  for (const double poison :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 0.0}) {
    SymmetricMatrix bad = good;
    bad.values[0] = poison;
    EXPECT_EQ(factor.factorize(bad), 0);
  }
  expect_factor(factor, good, random_);
}

// Two leaves of the tree fail, and the fronts' order is not the matrix's: the earlier column counts.
TEST_P(MultifrontalFactorTest, NamesTheFirstBadPivotOfAMatrixThatIsNotPostordered) {
  Edges edges;
  for (int i = 0; i < 20; ++i) edges.emplace_back(i, i + 20);
  for (int i = 20; i < 40; ++i) edges.emplace_back(i, 40);
  SymmetricMatrix A = block_matrix(std::vector<int>(41, 2), edges, random_);
  MultifrontalFactor factor(*GetParam());
  factor.analyze(A);
  expect_factor(factor, A, random_);
  for (const int block : {25, 12, 3}) {
    A.values[A.column_start[A.block_start[block]]] = -1.0;
    EXPECT_EQ(factor.factorize(A), A.block_start[block]);
  }
}

TEST_P(MultifrontalFactorTest, RefactorsChangedValuesWithTheSameBitsAndWithoutAllocations) {
  const SymmetricMatrix A = block_matrix(std::vector<int>(400, 3), grid_edges(20, 20), random_);
  SymmetricMatrix B = A;
  for (double& v : B.values) v *= 1.5;
  MultifrontalFactor factor(*GetParam());
  factor.analyze(A);
  const Eigen::VectorXd b = random_vector(A.size(), random_);
  Eigen::VectorXd x = b, again = b, scaled = b;
  const long before = allocation_count();
  int failures = 0;
  failures += factor.factorize(A) != -1;
  factor.solve(span_of(x));
  failures += factor.factorize(B) != -1;
  factor.solve(span_of(scaled));
  failures += factor.factorize(A) != -1;
  factor.solve(span_of(again));
  EXPECT_EQ(allocation_count() - before, 0);
  EXPECT_EQ(failures, 0);
  EXPECT_EQ(x, again);
  EXPECT_LE((x - 1.5 * scaled).norm(), kTolerance * x.norm());
}

TEST_P(MultifrontalFactorTest, AnalysesAnotherPatternAfterwards) {
  MultifrontalFactor factor(*GetParam());
  for (int width : {9, 3, 12}) {
    const SymmetricMatrix A = block_matrix(std::vector<int>(static_cast<std::size_t>(width * width), 2),
                                           grid_edges(width, width), random_);
    factor.analyze(A);
    expect_factor(factor, A, random_);
  }
}

TEST_P(MultifrontalFactorTest, RejectsUpperTriangles) {
  SymmetricMatrix A = block_matrix({3, 3}, {{0, 1}}, random_);
  A.triangle = SymmetricMatrix::Triangle::kUpper;
  MultifrontalFactor factor(*GetParam());
  EXPECT_THROW(factor.analyze(A), std::invalid_argument);
}

TEST(AssemblyTree, HasItsFrontsInPostorderAndEveryBlockOnce) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> block(0, 79);
  for (int trial = 0; trial < 50; ++trial) {
    Edges edges;
    for (int e = 0; e < 120; ++e) edges.emplace_back(block(random), block(random));
    const SymmetricMatrix A = block_matrix(std::vector<int>(80, 2), edges, random);
    const AssemblyTree tree = build_assembly_tree(A);
    std::vector<int> front_of(80, -1), size(tree.parent.size(), 1);
    for (int f = 0; f < tree.size(); ++f) {
      for (int t = tree.pivot_start[f]; t < tree.pivot_start[f + 1]; ++t) {
        EXPECT_EQ(front_of[tree.pivots[t]], -1);
        front_of[tree.pivots[t]] = f;
      }
      if (tree.parent[f] == -1) continue;
      ASSERT_GT(tree.parent[f], f);
      size[tree.parent[f]] += size[f];
    }
    for (int f = 0; f < tree.size(); ++f) {
      int descendants = 1;  // of f in a postorder: the size[f] fronts up to f
      for (int g = f - 1; g > f - size[f]; --g) {
        EXPECT_LE(tree.parent[g], f);
        ++descendants;
      }
      EXPECT_EQ(descendants, size[f]);
      for (int t = tree.row_start[f]; t < tree.row_start[f + 1]; ++t) EXPECT_GT(front_of[tree.rows[t]], f);
    }
  }
}

const FrontKernels* fast_kernels() {
  const FrontKernels& kernels = front_kernels();
  return &kernels == &portable_front_kernels() ? nullptr : &kernels;
}

INSTANTIATE_TEST_SUITE_P(Kernels, MultifrontalFactorTest,
                         ::testing::Values(&portable_front_kernels(), fast_kernels()),
                         [](const auto& test) { return std::string(test.index == 0 ? "Portable" : "Fast"); });

}  // namespace
}  // namespace taut::multifrontal_factor_test
