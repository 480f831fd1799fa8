#pragma once

#include <cholmod.h>

#include <algorithm>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "solvers/linear/factor.h"

namespace taut::benchmarks {

/// Which blocks of a system matrix couple; each edge once.
struct BlockEdges {
  int blocks = 0;
  std::vector<std::pair<int, int>> edges;
};

/// Joints of a chain of rods: each shares a rod with the next.
inline BlockEdges chain_graph(int links) {
  BlockEdges graph{links, {}};
  for (int i = 0; i + 1 < links; ++i) graph.edges.emplace_back(i, i + 1);
  return graph;
}

/// Joints of an N × N net of rods along the grid's edges, pinned at its corners.  At a node the first rod end
/// is the hub, which a ball joint connects with each of the others.  Joints couple where they share a rod.
inline BlockEdges net_graph(int N) {
  std::vector<std::vector<int>> joints_of_rod(2 * static_cast<std::size_t>(N) * (N - 1));
  int joints = 0;
  for (int j = 0; j < N; ++j) {
    for (int i = 0; i < N; ++i) {
      std::vector<int> rods;
      if (i > 0) rods.push_back(j * (N - 1) + i - 1);
      if (i < N - 1) rods.push_back(j * (N - 1) + i);
      if (j > 0) rods.push_back(N * (N - 1) + i * (N - 1) + j - 1);
      if (j < N - 1) rods.push_back(N * (N - 1) + i * (N - 1) + j);
      if (i % (N - 1) == 0 && j % (N - 1) == 0) joints_of_rod[rods[0]].push_back(joints++);
      for (std::size_t k = 1; k < rods.size(); ++k) {
        joints_of_rod[rods[0]].push_back(joints);
        joints_of_rod[rods[k]].push_back(joints++);
      }
    }
  }
  BlockEdges graph{joints, {}};
  for (const auto& of_rod : joints_of_rod)
    for (std::size_t a = 0; a < of_rod.size(); ++a)
      for (std::size_t b = 0; b < a; ++b) graph.edges.emplace_back(of_rod[a], of_rod[b]);
  return graph;
}

/// Place of each block in the order of elimination: AMD on the block graph, postordered.
inline std::vector<int> amd_places(const BlockEdges& graph) {
  cholmod_common common;
  cholmod_start(&common);
  common.nmethods = 1;
  common.method[0].ordering = CHOLMOD_AMD;
  common.supernodal = CHOLMOD_SIMPLICIAL;
  cholmod_triplet* T = cholmod_allocate_triplet(graph.blocks, graph.blocks, graph.blocks + graph.edges.size(),
                                                -1, CHOLMOD_PATTERN, &common);
  const auto insert = [T](int i, int j) {
    static_cast<int*>(T->i)[T->nnz] = std::max(i, j);
    static_cast<int*>(T->j)[T->nnz++] = std::min(i, j);
  };
  for (int i = 0; i < graph.blocks; ++i) insert(i, i);
  for (auto [i, j] : graph.edges) insert(i, j);
  cholmod_sparse* S = cholmod_triplet_to_sparse(T, 0, &common);
  cholmod_factor* L = cholmod_analyze(S, &common);
  std::vector<int> places(static_cast<std::size_t>(graph.blocks));
  for (int k = 0; k < graph.blocks; ++k) places[static_cast<int*>(L->Perm)[k]] = k;
  cholmod_free_factor(&L, &common);
  cholmod_free_sparse(&S, &common);
  cholmod_free_triplet(&T, &common);
  cholmod_finish(&common);
  return places;
}

/// A positive definite matrix of 3 × 3 blocks on the graph, in the order of elimination, lower triangle.
inline SymmetricMatrix block_matrix(const BlockEdges& graph, const std::vector<int>& places) {
  constexpr int kWidth = 3;
  SymmetricMatrix A;
  std::vector<std::set<int>> below(static_cast<std::size_t>(graph.blocks));
  for (int b = 0; b < graph.blocks; ++b) below[b].insert(b);
  for (auto [i, j] : graph.edges)
    below[std::min(places[i], places[j])].insert(std::max(places[i], places[j]));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  std::vector<double> sums(static_cast<std::size_t>(graph.blocks) * kWidth, 0.01);
  for (int b = 0; b < graph.blocks; ++b) {
    A.block_start.push_back(A.block_start.back() + kWidth);
    for (int c = A.block_start[b]; c < A.block_start[b + 1]; ++c) {
      for (int i : below[b]) {
        for (int r = kWidth * i; r < kWidth * (i + 1); ++r) {
          A.row_index.push_back(r);
          A.values.push_back(r < c ? 0.0 : value(random));
          if (r <= c) continue;
          sums[r] += std::abs(A.values.back());
          sums[c] += std::abs(A.values.back());
        }
      }
      A.column_start.push_back(static_cast<int>(A.values.size()));
    }
  }
  for (int c = 0; c < A.size(); ++c)
    for (int t = A.column_start[c]; t < A.column_start[c + 1]; ++t)
      if (A.row_index[t] == c) A.values[t] = sums[c];
  return A;
}

/// Bare CHOLMOD on a matrix in elimination order.  Each path gets the triangle that it does not have to
/// transpose.
class BareCholmod {
 public:
  BareCholmod(const SymmetricMatrix& A, bool supernodal) {
    cholmod_start(&common_);
    common_.nmethods = 1;
    common_.method[0].ordering = CHOLMOD_NATURAL;
    common_.postorder = 0;
    common_.supernodal = supernodal ? CHOLMOD_SUPERNODAL : CHOLMOD_SIMPLICIAL;
    cholmod_triplet* T = cholmod_allocate_triplet(A.size(), A.size(), A.values.size(), supernodal ? -1 : 1,
                                                  CHOLMOD_REAL, &common_);
    for (int c = 0; c < A.size(); ++c) {
      for (int t = A.column_start[c]; t < A.column_start[c + 1]; ++t) {
        if (A.row_index[t] < c) continue;
        static_cast<int*>(T->i)[T->nnz] = supernodal ? A.row_index[t] : c;
        static_cast<int*>(T->j)[T->nnz] = supernodal ? c : A.row_index[t];
        static_cast<double*>(T->x)[T->nnz++] = A.values[t];
      }
    }
    A_ = cholmod_triplet_to_sparse(T, 0, &common_);
    cholmod_free_triplet(&T, &common_);
    L_ = cholmod_analyze(A_, &common_);
    flops_ = common_.fl;
    b_ = cholmod_ones(A_->nrow, 1, CHOLMOD_REAL, &common_);
  }
  BareCholmod(const BareCholmod&) = delete;
  BareCholmod& operator=(const BareCholmod&) = delete;
  ~BareCholmod() {
    cholmod_free_dense(&b_, &common_);
    cholmod_free_dense(&x_, &common_);
    cholmod_free_dense(&y_, &common_);
    cholmod_free_dense(&e_, &common_);
    cholmod_free_factor(&L_, &common_);
    cholmod_free_sparse(&A_, &common_);
    cholmod_finish(&common_);
  }
  void factorize() { cholmod_factorize(A_, L_, &common_); }
  void solve() { cholmod_solve2(CHOLMOD_A, L_, b_, nullptr, &x_, nullptr, &y_, &e_, &common_); }
  double flops() const { return flops_; }

 private:
  cholmod_common common_;
  cholmod_sparse* A_ = nullptr;
  cholmod_factor* L_ = nullptr;
  cholmod_dense *b_ = nullptr, *x_ = nullptr, *y_ = nullptr, *e_ = nullptr;
  double flops_ = 0.0;
};

}  // namespace taut::benchmarks
