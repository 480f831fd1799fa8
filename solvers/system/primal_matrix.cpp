#include "solvers/system/primal_matrix.h"

#include <algorithm>

namespace taut {
namespace {

constexpr int kSix = 6;

/// Calls visit(side_i, side_j) for every ordered pair of sides on moving bodies of one joint, a side with
/// itself included.
template <typename Visit>
void for_each_pair(const Rows& rows, const MassMatrix& mass, const Rows::JointRows& joint, Visit visit) {
  if (joint.row_count == 0) return;
  for (int i = joint.first_side; i < joint.first_side + joint.side_count; ++i)
    for (int j = joint.first_side; j < joint.first_side + joint.side_count; ++j)
      if (!mass[rows.sides()[i].body].fixed && !mass[rows.sides()[j].body].fixed)
        visit(rows.sides()[i], rows.sides()[j]);
}

using Six = Eigen::Matrix<double, kSix, 1>;
using SixAt = Eigen::Map<const Six>;

/// Three rows at most of one joint that are not left out.
struct WeightedRows {
  static constexpr int kMost = 3;
  Six scaled[kMost];           // Σ⁻¹ W_i
  const double* other[kMost];  // W_j
};

/// Block += Σ_r scaled_r other_rᵀ, column by column, each with all rows: it is read and written once.
template <int kCount>
void add_rows(const WeightedRows& rows, double* block, int stride) {
  for (int c = 0; c < kSix; ++c, block += stride) {
    Eigen::Map<Six> column(block);
    Six sum = column;
    for (int r = 0; r < kCount; ++r) sum += rows.scaled[r] * rows.other[r][c];
    column = sum;
  }
}

void add_rows(const WeightedRows& rows, int count, double* block, int stride) {
  switch (count) {
    case 1:
      return add_rows<1>(rows, block, stride);
    case 2:
      return add_rows<2>(rows, block, stride);
    case 3:
      return add_rows<3>(rows, block, stride);
    default:
      return;
  }
}

}  // namespace

BlockGraph body_graph(const Rows& rows, const MassMatrix& mass, std::vector<int>& body_of_node) {
  std::vector<std::vector<int>> neighbours(rows.body_count());
  for (const Rows::JointRows& joint : rows.joints())
    for_each_pair(rows, mass, joint,
                  [&](const auto& i, const auto& j) { neighbours[i.body].push_back(j.body); });
  std::vector<int> node_of_body(rows.body_count(), -1);
  body_of_node.clear();
  for (int b = 0; b < rows.body_count(); ++b) {
    if (neighbours[b].empty()) continue;
    node_of_body[b] = static_cast<int>(body_of_node.size());
    body_of_node.push_back(b);
  }
  BlockGraph graph;
  for (int b : body_of_node) {
    std::vector<int>& others = neighbours[b];
    std::sort(others.begin(), others.end());
    others.erase(std::unique(others.begin(), others.end()), others.end());
    for (int other : others)
      if (other != b) graph.neighbour.push_back(node_of_body[other]);
    graph.block_size.push_back(kSix);
    graph.start.push_back(static_cast<int>(graph.neighbour.size()));
  }
  return graph;
}

PrimalMatrix::PrimalMatrix(const Rows& rows, const MassMatrix& mass, SymmetricMatrix::Triangle triangle,
                           const BlockOrdering& ordering, std::span<const int> body_of_node) {
  matrix_.triangle = triangle;
  position_.assign(rows.body_count(), -1);
  std::vector<int> place(rows.body_count(), -1);
  for (std::size_t k = 0; k < ordering.node_at.size(); ++k) {
    place[body_of_node[ordering.node_at[k]]] = static_cast<int>(k);
    position_[body_of_node[ordering.node_at[k]]] = kSix * static_cast<int>(k);
  }
  const bool lower = triangle == SymmetricMatrix::Triangle::kLower;
  std::vector<std::vector<int>> columns(ordering.node_at.size());  // rows of each block column
  const auto stored = [&](int i, int j) { return lower ? i >= j : i <= j; };
  for (const Rows::JointRows& joint : rows.joints())
    for_each_pair(rows, mass, joint, [&](const auto& i, const auto& j) {
      if (stored(place[i.body], place[j.body])) columns[place[j.body]].push_back(place[i.body]);
    });
  for (std::vector<int>& column : columns) {
    std::sort(column.begin(), column.end());
    column.erase(std::unique(column.begin(), column.end()), column.end());
    const int first = static_cast<int>(matrix_.row_index.size());
    const int length = kSix * static_cast<int>(column.size());
    const int own_block = static_cast<int>(matrix_.block_start.size()) - 1;
    for (int c = 0; c < kSix; ++c) {
      for (int row : column) {
        if (row == own_block) diagonal_.push_back(static_cast<int>(matrix_.row_index.size()) + c);
        for (int r = 0; r < kSix; ++r) matrix_.row_index.push_back(kSix * row + r);
      }
      matrix_.column_start.push_back(first + (c + 1) * length);
    }
    matrix_.block_start.push_back(matrix_.block_start.back() + kSix);
  }
  matrix_.values.assign(matrix_.row_index.size(), 0.0);
  for (const Rows::JointRows& joint : rows.joints())
    for_each_pair(rows, mass, joint, [&](const auto& i, const auto& j) {
      const int row = place[i.body], column = place[j.body];
      if (!stored(row, column)) return;
      const auto at = std::lower_bound(columns[column].begin(), columns[column].end(), row);
      products_.push_back(
          {matrix_.column_start[kSix * column] + kSix * static_cast<int>(at - columns[column].begin()),
           kSix * static_cast<int>(columns[column].size()), i.whole, j.whole, joint.first_row,
           joint.row_count});
    });
}

void PrimalMatrix::assemble(std::span<const double> weighted, std::span<const double> inverse_compliance) {
  std::fill(matrix_.values.begin(), matrix_.values.end(), 0.0);
  for (int entry : diagonal_) matrix_.values[entry] = 1;
  for (const Product& p : products_) {
    double* block = matrix_.values.data() + p.slot;
    const double* of_i = weighted.data() + p.offset_i;
    const double* of_j = weighted.data() + p.offset_j;
    WeightedRows rows;
    int count = 0;
    for (int r = 0; r < p.row_count; ++r, of_i += kSix, of_j += kSix) {
      const double d = inverse_compliance[p.first_row + r];
      if (d == 0) continue;
      rows.scaled[count] = d * SixAt(of_i);
      rows.other[count++] = of_j;
      if (count < WeightedRows::kMost) continue;
      add_rows(rows, count, block, p.stride);
      count = 0;
    }
    add_rows(rows, count, block, p.stride);
  }
}

}  // namespace taut
