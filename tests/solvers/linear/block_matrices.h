#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "solvers/linear/factor.h"

/// Matrices of blocks, to be factored.
namespace taut::block_matrices {

using Edges = std::vector<std::pair<int, int>>;

// A symmetric matrix whose blocks couple along the edges, with random values in [−1, 1] off the diagonal,
// made positive definite by diagonal dominance.  The upper triangles of the diagonal blocks hold NaN: nobody
// may read them.
inline SymmetricMatrix block_matrix(const std::vector<int>& sizes, const Edges& edges, std::mt19937& random) {
  SymmetricMatrix A;
  for (int s : sizes) A.block_start.push_back(A.block_start.back() + s);
  std::vector<std::set<int>> below(sizes.size());
  for (auto [i, j] : edges)
    if (i != j) below[std::min(i, j)].insert(std::max(i, j));
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  std::vector<double> sums(A.size(), 0.0);
  for (int b = 0; b < A.block_count(); ++b) {
    below[b].insert(b);
    for (int c = A.block_start[b]; c < A.block_start[b + 1]; ++c) {
      for (int i : below[b]) {
        for (int r = A.block_start[i]; r < A.block_start[i + 1]; ++r) {
          A.row_index.push_back(r);
          A.values.push_back(r < c ? std::numeric_limits<double>::quiet_NaN() : value(random));
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
      if (A.row_index[t] == c) A.values[t] = 0.1 + sums[c];
  return A;
}

inline Edges grid_edges(int width, int height) {
  Edges edges;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (x + 1 < width) edges.emplace_back(y * width + x, y * width + x + 1);
      if (y + 1 < height) edges.emplace_back(y * width + x, (y + 1) * width + x);
    }
  }
  return edges;
}

}  // namespace taut::block_matrices
