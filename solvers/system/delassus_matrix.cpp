#include "solvers/system/delassus_matrix.h"

#include <algorithm>
#include <cmath>

#include "core/base/counting_sort.h"

namespace taut {
namespace {

/// Joints that have a block, in the order of elimination: those without rows, as detached ones, have none.
std::vector<int> joints_with_rows(const Rows& rows, const BlockOrdering& ordering) {
  std::vector<int> joints;
  for (int j : ordering.node_at)
    if (rows.joints()[j].row_count > 0) joints.push_back(j);
  return joints;
}

/// Of each side, its place among those of its body.
std::vector<int> places_at_bodies(const Rows& rows) {
  std::vector<int> place(rows.sides().size());
  for (int b = 0; b < rows.body_count(); ++b)
    for (std::size_t k = 0; k < rows.sides_of(b).size(); ++k)
      place[rows.sides_of(b)[k]] = static_cast<int>(k);
  return place;
}

/// Calls visit(other) for every side that meets `side` at a moving body, itself included.
template <typename Visit>
void for_each_meeting(const Rows& rows, const MassMatrix& mass, int side, Visit visit) {
  const int body = rows.sides()[side].body;
  if (mass[body].fixed) return;
  for (int other : rows.sides_of(body)) visit(other);
}

/// Whether entry m is the first of its block; entries ascend by block row.
template <typename Meeting>
bool opens_block(std::span<const Meeting> meetings, std::size_t m) {
  return m == 0 || meetings[m].block_row != meetings[m - 1].block_row;
}

/// All rows of the blocks that meet, in ascending order.
template <typename Meeting>
std::vector<int> rows_of_blocks(std::span<const Meeting> meetings, std::span<const int> block_start) {
  std::vector<int> rows;
  for (std::size_t m = 0; m < meetings.size(); ++m)
    if (opens_block(meetings, m))
      for (int r = block_start[meetings[m].block_row]; r < block_start[meetings[m].block_row + 1]; ++r)
        rows.push_back(r);
  return rows;
}

/// How the kernels take a root of M⁻¹.
struct RootBlocks {
  const double *rotation, *translation;
  double scale;
};
inline RootBlocks blocks_of(const InverseMassRoot& A) { return {A.rotation.data(), nullptr, A.translation}; }
inline RootBlocks blocks_of(const FullMassRoot& A) { return {A.rotation.data(), A.translation.data(), 0}; }

}  // namespace

BlockGraph joint_graph(const Rows& rows, const MassMatrix& mass) {
  BlockGraph graph;
  for (const Rows::JointRows& joint : rows.joints()) {
    const int j = graph.size();
    const auto begin = graph.neighbour.size();
    for (int s = joint.first_side; s < joint.first_side + joint.side_count; ++s)
      for_each_meeting(rows, mass, s, [&](int other) {
        if (rows.sides()[other].block != j) graph.neighbour.push_back(rows.sides()[other].block);
      });
    std::sort(graph.neighbour.begin() + begin, graph.neighbour.end());
    graph.neighbour.erase(std::unique(graph.neighbour.begin() + begin, graph.neighbour.end()),
                          graph.neighbour.end());
    graph.block_size.push_back(joint.row_count);
    graph.start.push_back(static_cast<int>(graph.neighbour.size()));
  }
  return graph;
}

DelassusMatrix::DelassusMatrix(const Rows& rows, const MassMatrix& mass, const BlockOrdering& ordering,
                               SymmetricMatrix::Triangle triangle) {
  matrix_.triangle = triangle;
  build_pattern(rows, mass, ordering);
}

void DelassusMatrix::build_pattern(const Rows& rows, const MassMatrix& mass, const BlockOrdering& ordering) {
  const std::vector<int> joints = joints_with_rows(rows, ordering);
  place_rows(rows, joints);
  std::vector<int> block_of_joint(rows.joints().size(), -1);
  for (std::size_t k = 0; k < joints.size(); ++k) block_of_joint[joints[k]] = static_cast<int>(k);
  const std::vector<int> place = places_at_bodies(rows);

  std::vector<Meeting> meetings;
  std::vector<BodyProduct> products;
  for (int k = 0; k < matrix_.block_count(); ++k) {
    const Rows::JointRows& joint = rows.joints()[joints[k]];
    meetings.clear();
    for (int s = joint.first_side; s < joint.first_side + joint.side_count; ++s)
      for_each_meeting(rows, mass, s, [&](int other) {
        const int block_row = block_of_joint[rows.sides()[other].block];
        if (is_stored(block_row, k))
          meetings.push_back({block_row, rows.sides()[s].body, place[other], place[s]});
      });
    std::stable_sort(meetings.begin(), meetings.end(),
                     [](const Meeting& a, const Meeting& b) { return a.block_row < b.block_row; });
    append_block_column(k, meetings, products);
  }
  matrix_.values.assign(matrix_.row_index.size(), 0.0);
  sort_products(rows, products);
}

/// The rows of these joints, one block each, one behind the other.
void DelassusMatrix::place_rows(const Rows& rows, std::span<const int> joints) {
  position_of_row_.resize(rows.row_count());
  diagonal_.reserve(rows.row_count());
  for (int j : joints) {
    const Rows::JointRows& joint = rows.joints()[j];
    const int first = matrix_.block_start.back();
    for (int i = 0; i < joint.row_count; ++i) position_of_row_[joint.first_row + i] = first + i;
    matrix_.block_start.push_back(first + joint.row_count);
  }
}

/// Block column k: its pattern, and where the products of its meetings go.  `meetings` ascend by block row.
void DelassusMatrix::append_block_column(int k, std::span<const Meeting> meetings,
                                         std::vector<BodyProduct>& products) {
  const std::vector<int> rows = rows_of_blocks(meetings, matrix_.block_start);
  const int first = static_cast<int>(matrix_.row_index.size()), length = static_cast<int>(rows.size());
  int slot = first;
  for (std::size_t m = 0; m < meetings.size(); ++m) {
    if (opens_block(meetings, m) && m > 0) slot += height(meetings[m - 1].block_row);
    products.push_back({meetings[m].body, {slot, length, meetings[m].i, meetings[m].j, false}});
  }
  const auto own_block = std::find(rows.begin(), rows.end(), matrix_.block_start[k]);
  const int diagonal = first + static_cast<int>(own_block - rows.begin());
  for (int c = 0; c < height(k); ++c) {
    if (own_block != rows.end()) diagonal_.push_back(diagonal + c * length + c);
    matrix_.row_index.insert(matrix_.row_index.end(), rows.begin(), rows.end());
    matrix_.column_start.push_back(static_cast<int>(matrix_.row_index.size()));
  }
}

/// By body; the first product of a block in that order overwrites it.
void DelassusMatrix::sort_products(const Rows& rows, std::span<const BodyProduct> products) {
  counting_sort(
      products.size(), rows.body_count(), [&](std::size_t i) { return products[i].body; },
      [&](std::size_t i) { return products[i].product; }, first_product_, products_);
  std::vector<char> written(matrix_.values.size(), 0);
  for (Product& product : products_) {
    product.first = !written[product.slot];
    written[product.slot] = 1;
  }
  std::size_t most_sides = 0;
  int most_values = 0;
  for (int b = 0; b < rows.body_count(); ++b) {
    int values = 0;
    for (int s : rows.sides_of(b)) values += 6 * side_height(rows.sides()[s].row_count);
    most_values = std::max(most_values, values);
    most_sides = std::max(most_sides, rows.sides_of(b).size());
  }
  own_weighted_.resize(most_values);
  weighted_of_side_.resize(most_sides);
}

template <typename Root>
void DelassusMatrix::mass_weight(const Rows& rows, std::span<const double> jacobian,
                                 std::span<const Root> roots, std::span<double> weighted) {
  const FrontKernels& kernels = front_kernels();
  for (const Rows::Side& side : rows.sides()) {
    const RootBlocks A = blocks_of(roots[side.body]);
    const double* J = jacobian.data() + side.offset;
    double* W = weighted.data() + side.whole;
    if (side.arm != 0)
      kernels.weigh_arm_rows(J, side.arm, A.rotation, A.translation, A.scale, W);
    else
      kernels.weigh_rows(J, side.row_count, A.rotation, A.translation, A.scale, W);
  }
}

/// All products of a body, with the W of its sides at weighted_of_side_.
void DelassusMatrix::add_products(const Rows& rows, int body) {
  const std::span<const int> sides = rows.sides_of(body);
  for (int k = first_product_[body]; k < first_product_[body + 1]; ++k) {
    const Product& p = products_[k];
    kernels_.multiply_sides(weighted_of_side_[p.i], rows.sides()[sides[p.i]].row_count,
                            weighted_of_side_[p.j], rows.sides()[sides[p.j]].row_count,
                            matrix_.values.data() + p.slot, p.stride, p.first);
  }
}

/// S of what `weigh(side, W)` makes of each side of a body.
template <typename Weigh>
void DelassusMatrix::assemble_bodies(const Rows& rows, int begin, int end, Weigh weigh) {
  for (int b = begin; b < end; ++b) {
    if (first_product_[b] == first_product_[b + 1]) continue;
    double* W = own_weighted_.data();
    for (std::size_t k = 0; k < rows.sides_of(b).size(); ++k) {
      const Rows::Side& side = rows.sides()[rows.sides_of(b)[k]];
      weigh(side, W);
      weighted_of_side_[k] = W;
      W += 6 * side_height(side.row_count);
    }
    add_products(rows, b);
  }
}

void DelassusMatrix::shift_diagonal(double shift) {
  if (shift != 0)
    for (int i : diagonal_) matrix_.values[i] *= 1 + shift;
}

template <typename Root>
void DelassusMatrix::assemble_roots(const Rows& rows, std::span<const double> jacobian,
                                    std::span<const Root> roots, int begin, int end) {
  assemble_bodies(rows, begin, end, [&](const Rows::Side& side, double* W) {
    const RootBlocks A = blocks_of(roots[side.body]);
    const double* J = jacobian.data() + side.offset;
    if (side.arm != 0)
      kernels_.weigh_arm(J, side.arm, A.rotation, A.translation, A.scale, W);
    else
      kernels_.weigh(J, side.row_count, A.rotation, A.translation, A.scale, W);
  });
}

template <typename Root>
void DelassusMatrix::assemble(const Rows& rows, std::span<const double> jacobian, std::span<const Root> roots,
                              double shift) {
  assemble_roots(rows, jacobian, roots, 0, rows.body_count());
  shift_diagonal(shift);
}

void DelassusMatrix::assemble(const Rows& rows, std::span<const double> jacobian,
                              std::span<const InverseMassRoot> roots, int begin, int end) {
  assemble_roots(rows, jacobian, roots, begin, end);
}

template void DelassusMatrix::mass_weight<InverseMassRoot>(const Rows&, std::span<const double>,
                                                           std::span<const InverseMassRoot>,
                                                           std::span<double>);
template void DelassusMatrix::mass_weight<FullMassRoot>(const Rows&, std::span<const double>,
                                                        std::span<const FullMassRoot>, std::span<double>);
template void DelassusMatrix::assemble<InverseMassRoot>(const Rows&, std::span<const double>,
                                                        std::span<const InverseMassRoot>, double);
template void DelassusMatrix::assemble<FullMassRoot>(const Rows&, std::span<const double>,
                                                     std::span<const FullMassRoot>, double);

void DelassusMatrix::assemble(const Rows& rows, std::span<const double> weighted, double shift,
                              std::span<const double> row_states) {
  assemble_bodies(rows, 0, rows.body_count(), [&](const Rows::Side& side, double* W) {
    kernels_.weigh(weighted.data() + side.whole, side.row_count, nullptr, nullptr, 1, W);
  });
  for (std::size_t r = 0; r < row_states.size(); ++r)
    matrix_.values[diagonal_[position_of_row_[r]]] += std::isinf(row_states[r]) ? 1 : row_states[r];
  shift_diagonal(shift);
}

}  // namespace taut
