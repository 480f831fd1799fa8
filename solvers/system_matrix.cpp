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

inline void weigh_translation(const double* v, double root, double* out) {
  for (int k = 0; k < 3; ++k) out[k] = root * v[k];
}
inline void weigh_translation(const double* v, const Mat3& root, double* out) {
  for (int k = 0; k < 3; ++k) out[k] = v[0] * root(0, k) + v[1] * root(1, k) + v[2] * root(2, k);
}

/// W of one side.
template <typename Root>
inline void weigh(const Rows::Side& side, const double* J, const Root& A, double* W) {
  for (int i = 0; i < side.row_count; ++i, J += 6, W += 6) {
    for (int k = 0; k < 3; ++k)
      W[k] = J[0] * A.rotation(0, k) + J[1] * A.rotation(1, k) + J[2] * A.rotation(2, k);
    weigh_translation(J + 3, A.translation, W + 3);
  }
}

/// C (+)= W_i W_jᵀ for blocks of a size known to the compiler or not (0): the six products of an entry in
/// three pairs, and two entries at a time, whose pairs are then added across.
template <int RowsI, int RowsJ, bool Overwrite>
inline void multiply(const double* W_i, const double* W_j, int rows_i, int rows_j, double* C, int stride) {
  using Pair = Eigen::Array2d;
  const auto pair = [](const double* at) { return Pair(Eigen::Map<const Pair>(at)); };
  const int ni = RowsI ? RowsI : rows_i, nj = RowsJ ? RowsJ : rows_j;
  for (int c = 0; c < nj; ++c, W_j += 6, C += stride) {
    const Pair b0 = pair(W_j), b1 = pair(W_j + 2), b2 = pair(W_j + 4);
    const auto products = [&](int r) {
      const double* a = W_i + 6 * r;
      return Pair(pair(a) * b0 + pair(a + 2) * b1 + pair(a + 4) * b2);
    };
    for (int r = 0; r + 1 < ni; r += 2) {
      const Pair s = products(r), t = products(r + 1), sum = Pair(s[0], t[0]) + Pair(s[1], t[1]);
      Eigen::Map<Pair> entries(C + r);
      entries = Overwrite ? sum : Pair(entries + sum);
    }
    if (ni % 2 == 0) continue;
    const double sum = products(ni - 1).sum();
    C[ni - 1] = Overwrite ? sum : C[ni - 1] + sum;
  }
}

/// The same for the sizes that are common, and for all others.
template <bool Overwrite>
inline void multiply(const double* W_i, const double* W_j, int rows_i, int rows_j, double* C, int stride) {
  if (rows_i == 3 && rows_j == 3)
    multiply<3, 3, Overwrite>(W_i, W_j, 3, 3, C, stride);
  else if (rows_i == 5 && rows_j == 5)
    multiply<5, 5, Overwrite>(W_i, W_j, 5, 5, C, stride);
  else
    multiply<0, 0, Overwrite>(W_i, W_j, rows_i, rows_j, C, stride);
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
  const auto height = [&](int block) { return rows.joints()[node_at[block]].row_count; };
  for (int k = 0; k < joints; ++k) matrix_.block_start.push_back(matrix_.block_start.back() + height(k));
  position_of_row_.resize(rows.row_count());
  for (int k = 0; k < joints; ++k)
    for (int i = 0; i < height(k); ++i)
      position_of_row_[rows.joints()[node_at[k]].first_row + i] = matrix_.block_start[k] + i;
  std::vector<int> place(rows.sides().size());  // of a side among those of its body
  for (int b = 0; b < rows.body_count(); ++b)
    for (std::size_t k = 0; k < rows.sides_of(b).size(); ++k)
      place[rows.sides_of(b)[k]] = static_cast<int>(k);

  const bool lower = matrix_.triangle == SymmetricMatrix::Triangle::kLower;
  struct Meeting {
    int block_row, body, i, j;
  };
  std::vector<Meeting> meetings;
  std::vector<std::pair<int, Product>> products;  // with their bodies
  diagonal_.reserve(rows.row_count());
  for (int k = 0; k < joints; ++k) {  // block column k: which blocks, and what is summed into each
    const Rows::JointRows& joint = rows.joints()[node_at[k]];
    meetings.clear();
    for (int s = joint.first_side; s < joint.first_side + joint.side_count; ++s)
      for_each_meeting(rows, mass, s, [&](int other) {
        const int block_row = position[rows.sides()[other].joint];
        if (lower ? block_row >= k : block_row <= k)
          meetings.push_back({block_row, rows.sides()[s].body, place[other], place[s]});
      });
    std::stable_sort(meetings.begin(), meetings.end(),
                     [](const Meeting& a, const Meeting& b) { return a.block_row < b.block_row; });
    int column_length = 0;
    const auto opens_block = [&](std::size_t m) {
      return m == 0 || meetings[m].block_row != meetings[m - 1].block_row;
    };
    for (std::size_t m = 0; m < meetings.size(); ++m)
      if (opens_block(m)) column_length += height(meetings[m].block_row);

    int slot = static_cast<int>(matrix_.row_index.size());
    for (std::size_t m = 0; m < meetings.size(); ++m) {
      if (m > 0 && opens_block(m)) slot += height(meetings[m - 1].block_row);
      products.push_back({meetings[m].body, {slot, column_length, meetings[m].i, meetings[m].j, false}});
      if (opens_block(m) && meetings[m].block_row == k)
        for (int c = 0; c < joint.row_count; ++c) diagonal_.push_back(slot + c * column_length + c);
    }
    for (int c = 0; c < joint.row_count; ++c) {
      for (std::size_t m = 0; m < meetings.size(); ++m)
        if (opens_block(m))
          for (int r = 0; r < height(meetings[m].block_row); ++r)
            matrix_.row_index.push_back(matrix_.block_start[meetings[m].block_row] + r);
      matrix_.column_start.push_back(static_cast<int>(matrix_.row_index.size()));
    }
  }
  matrix_.values.assign(matrix_.row_index.size(), 0.0);
  sort_products(rows, products);
}

/// By body, by counting sort; the first product of a block in that order overwrites it.
void SystemMatrix::sort_products(const Rows& rows, std::span<const std::pair<int, Product>> products) {
  first_product_.assign(rows.body_count() + 1, 0);
  for (const auto& [body, product] : products) ++first_product_[body + 1];
  for (int b = 0; b < rows.body_count(); ++b) first_product_[b + 1] += first_product_[b];
  std::vector<int> next(first_product_.begin(), first_product_.end() - 1);
  products_.resize(products.size());
  for (const auto& [body, product] : products) products_[next[body]++] = product;
  std::vector<char> written(matrix_.values.size(), 0);
  for (Product& product : products_) {
    product.first = !written[product.slot];
    written[product.slot] = 1;
  }
  std::size_t most_sides = 0;
  int most_values = 0;
  for (int b = 0; b < rows.body_count(); ++b) {
    int values = 0;
    for (int s : rows.sides_of(b)) values += 6 * rows.sides()[s].row_count;
    most_values = std::max(most_values, values);
    most_sides = std::max(most_sides, rows.sides_of(b).size());
  }
  own_weighted_.resize(most_values);
  own_.resize(most_sides);
}

template <typename Root>
void SystemMatrix::weight(const Rows& rows, std::span<const double> jacobian, std::span<const Root> roots,
                          std::span<double> weighted) {
  for (const Rows::Side& side : rows.sides())
    weigh(side, jacobian.data() + side.offset, roots[side.body], weighted.data() + side.offset);
}

/// All products of a body, with the W of its sides at own_.
void SystemMatrix::add_products(const Rows& rows, int body) {
  const std::span<const int> sides = rows.sides_of(body);
  for (int k = first_product_[body]; k < first_product_[body + 1]; ++k) {
    const Product& p = products_[k];
    const int rows_i = rows.sides()[sides[p.i]].row_count, rows_j = rows.sides()[sides[p.j]].row_count;
    double* C = matrix_.values.data() + p.slot;
    if (p.first)
      multiply<true>(own_[p.i], own_[p.j], rows_i, rows_j, C, p.stride);
    else
      multiply<false>(own_[p.i], own_[p.j], rows_i, rows_j, C, p.stride);
  }
}

template <typename Root>
void SystemMatrix::assemble(const Rows& rows, std::span<const double> jacobian, std::span<const Root> roots) {
  for (int b = 0; b < rows.body_count(); ++b) {
    if (first_product_[b] == first_product_[b + 1]) continue;
    double* W = own_weighted_.data();
    for (std::size_t k = 0; k < rows.sides_of(b).size(); ++k) {
      const Rows::Side& side = rows.sides()[rows.sides_of(b)[k]];
      weigh(side, jacobian.data() + side.offset, roots[b], W);
      own_[k] = W;
      W += 6 * side.row_count;
    }
    add_products(rows, b);
  }
}

template void SystemMatrix::weight<InverseMassRoot>(const Rows&, std::span<const double>,
                                                    std::span<const InverseMassRoot>, std::span<double>);
template void SystemMatrix::weight<FullMassRoot>(const Rows&, std::span<const double>,
                                                 std::span<const FullMassRoot>, std::span<double>);
template void SystemMatrix::assemble<InverseMassRoot>(const Rows&, std::span<const double>,
                                                      std::span<const InverseMassRoot>);
template void SystemMatrix::assemble<FullMassRoot>(const Rows&, std::span<const double>,
                                                   std::span<const FullMassRoot>);

void SystemMatrix::assemble(const Rows& rows, std::span<const double> weighted, double shift,
                            std::span<const double> row_states) {
  for (int b = 0; b < rows.body_count(); ++b) {
    if (first_product_[b] == first_product_[b + 1]) continue;
    for (std::size_t k = 0; k < rows.sides_of(b).size(); ++k)
      own_[k] = weighted.data() + rows.sides()[rows.sides_of(b)[k]].offset;
    add_products(rows, b);
  }
  for (std::size_t r = 0; r < row_states.size(); ++r)
    matrix_.values[diagonal_[position_of_row_[r]]] += std::isinf(row_states[r]) ? 1 : row_states[r];
  if (shift != 0)
    for (int i : diagonal_) matrix_.values[i] *= 1 + shift;
}

}  // namespace taut
