#include "solvers/system_matrix.h"

#include <algorithm>
#include <cmath>

namespace taut {
namespace {

/// Calls visit(side_i, side_j) for every ordered pair of sides that meet at a moving body, a side with itself
/// included.
template <typename Visit>
void for_each_meeting(const Rows& rows, const MassMatrix& mass, int side, Visit visit) {
  const int body = rows.sides()[side].body;
  if (mass[body].fixed) return;
  for (int other : rows.sides_of(body)) visit(other);
}

/// C (+)= W_i W_jᵀ for blocks of a size known to the compiler or not (0).
template <int RowsI, int RowsJ>
inline void multiply(const double* W_i, const double* W_j, int rows_i, int rows_j, double* C, int stride,
                     bool overwrite) {
  using Row = Eigen::Map<const Eigen::Matrix<double, 6, 1>>;
  const int ni = RowsI ? RowsI : rows_i, nj = RowsJ ? RowsJ : rows_j;
  for (int c = 0; c < nj; ++c) {
    const Row b(W_j + 6 * c);
    for (int r = 0; r < ni; ++r) {
      const double sum = Row(W_i + 6 * r).cwiseProduct(b).sum();
      double& entry = C[c * stride + r];
      entry = overwrite ? sum : entry + sum;
    }
  }
}

}  // namespace

BlockGraph joint_graph(const Rows& rows, const MassMatrix& mass) {
  BlockGraph graph;
  for (const Rows::JointRows& joint : rows.joints()) {
    const int j = graph.size();
    const auto begin = graph.neighbour.size();
    for (int s = joint.first_side; s < joint.first_side + joint.side_count; ++s)
      for_each_meeting(rows, mass, s, [&](int other) {
        if (rows.sides()[other].joint != j) graph.neighbour.push_back(rows.sides()[other].joint);
      });
    std::sort(graph.neighbour.begin() + begin, graph.neighbour.end());
    graph.neighbour.erase(std::unique(graph.neighbour.begin() + begin, graph.neighbour.end()),
                          graph.neighbour.end());
    graph.block_size.push_back(joint.row_count);
    graph.start.push_back(static_cast<int>(graph.neighbour.size()));
  }
  return graph;
}

SystemMatrix::SystemMatrix(const Rows& rows, const MassMatrix& mass, const BlockOrdering& ordering,
                           SymmetricMatrix::Triangle triangle) {
  matrix_.triangle = triangle;
  build_pattern(rows, mass, ordering);
}

void SystemMatrix::build_pattern(const Rows& rows, const MassMatrix& mass, const BlockOrdering& ordering) {
  std::vector<int> node_at;  // joints without rows, as detached ones, have no block
  for (int j : ordering.node_at)
    if (rows.joints()[j].row_count > 0) node_at.push_back(j);
  const int joints = static_cast<int>(node_at.size());
  std::vector<int> position(rows.joints().size(), -1);
  for (int k = 0; k < joints; ++k) position[node_at[k]] = k;
  for (int k = 0; k < joints; ++k)
    matrix_.block_start.push_back(matrix_.block_start.back() + rows.joints()[node_at[k]].row_count);
  position_of_row_.resize(rows.row_count());
  for (int j : node_at)
    for (int i = 0; i < rows.joints()[j].row_count; ++i)
      position_of_row_[rows.joints()[j].first_row + i] = matrix_.block_start[position[j]] + i;

  const bool lower = matrix_.triangle == SymmetricMatrix::Triangle::kLower;
  struct Meeting {
    int block_row, side_i, side_j;
  };
  std::vector<Meeting> meetings;
  diagonal_.reserve(rows.row_count());
  for (int k = 0; k < joints; ++k) {  // block column k: which blocks, and what is summed into each
    const Rows::JointRows& joint = rows.joints()[node_at[k]];
    meetings.clear();
    for (int s = joint.first_side; s < joint.first_side + joint.side_count; ++s)
      for_each_meeting(rows, mass, s, [&](int other) {
        const int block_row = position[rows.sides()[other].joint];
        if (lower ? block_row >= k : block_row <= k) meetings.push_back({block_row, other, s});
      });
    std::stable_sort(meetings.begin(), meetings.end(),
                     [](const Meeting& a, const Meeting& b) { return a.block_row < b.block_row; });
    const int first_value = static_cast<int>(matrix_.row_index.size());
    int column_length = 0;
    for (std::size_t m = 0; m < meetings.size(); ++m)
      if (m == 0 || meetings[m].block_row != meetings[m - 1].block_row)
        column_length +=
            matrix_.block_start[meetings[m].block_row + 1] - matrix_.block_start[meetings[m].block_row];

    int offset = 0;
    for (std::size_t m = 0; m < meetings.size(); ++m) {
      const bool first = m == 0 || meetings[m].block_row != meetings[m - 1].block_row;
      const int height =
          matrix_.block_start[meetings[m].block_row + 1] - matrix_.block_start[meetings[m].block_row];
      const Rows::Side &i = rows.sides()[meetings[m].side_i], &j = rows.sides()[meetings[m].side_j];
      if (first && m > 0)
        offset += matrix_.block_start[meetings[m - 1].block_row + 1] -
                  matrix_.block_start[meetings[m - 1].block_row];
      products_.push_back({first_value + offset, column_length, i.offset, j.offset,
                           static_cast<std::int8_t>(height), static_cast<std::int8_t>(joint.row_count),
                           first});
      if (first && meetings[m].block_row == k)
        for (int c = 0; c < height; ++c) diagonal_.push_back(first_value + offset + c * column_length + c);
    }
    for (int c = 0; c < joint.row_count; ++c) {
      for (std::size_t m = 0; m < meetings.size(); ++m)
        if (m == 0 || meetings[m].block_row != meetings[m - 1].block_row)
          for (int r = matrix_.block_start[meetings[m].block_row];
               r < matrix_.block_start[meetings[m].block_row + 1]; ++r)
            matrix_.row_index.push_back(r);
      matrix_.column_start.push_back(static_cast<int>(matrix_.row_index.size()));
    }
  }
  matrix_.values.assign(matrix_.row_index.size(), 0.0);
}

void SystemMatrix::weight(const Rows& rows, std::span<const double> jacobian,
                          std::span<const InverseMassRoot> roots, std::span<double> weighted) {
  for (const Rows::Side& side : rows.sides()) {
    const InverseMassRoot& A = roots[side.body];
    const double* J = jacobian.data() + side.offset;
    double* W = weighted.data() + side.offset;
    for (int i = 0; i < side.row_count; ++i, J += 6, W += 6) {
      for (int k = 0; k < 3; ++k)
        W[k] = J[0] * A.rotation(0, k) + J[1] * A.rotation(1, k) + J[2] * A.rotation(2, k);
      for (int k = 0; k < 3; ++k)
        W[3 + k] = A.isotropic
                       ? A.translation(0, 0) * J[3 + k]
                       : J[3] * A.translation(0, k) + J[4] * A.translation(1, k) + J[5] * A.translation(2, k);
    }
  }
}

void SystemMatrix::assemble(std::span<const double> weighted, double shift,
                            std::span<const double> row_states) {
  for (const Product& p : products_) {
    const double *W_i = weighted.data() + p.offset_i, *W_j = weighted.data() + p.offset_j;
    double* C = matrix_.values.data() + p.slot;
    if (p.rows_i == 3 && p.rows_j == 3)
      multiply<3, 3>(W_i, W_j, 3, 3, C, p.stride, p.first);
    else if (p.rows_i == 5 && p.rows_j == 5)
      multiply<5, 5>(W_i, W_j, 5, 5, C, p.stride, p.first);
    else
      multiply<0, 0>(W_i, W_j, p.rows_i, p.rows_j, C, p.stride, p.first);
  }
  for (std::size_t r = 0; r < row_states.size(); ++r)
    matrix_.values[diagonal_[position_of_row_[r]]] += std::isinf(row_states[r]) ? 1 : row_states[r];
  if (shift != 0)
    for (int i : diagonal_) matrix_.values[i] *= 1 + shift;
}

}  // namespace taut
