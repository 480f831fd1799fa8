#include <Eigen/SparseCore>

#include "core/base/check.h"
#include "core/constraints/rows.h"
#include "core/world/diagnostics.h"
#include "scenes/accuracy/small_oscillations.h"
#include "scenes/python/access.h"
#include "scenes/python/arrays.h"
#include "scenes/python/parts.h"
#include "solvers/system/delassus_system.h"
#include "solvers/system/linearized_rows.h"

namespace taut::python {
namespace {

using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor, std::int64_t>;
using Entries = std::vector<Eigen::Triplet<double, std::int64_t>>;

/// scipy.sparse.csr_array.
nb::object to_scipy(std::int64_t rows, std::int64_t columns, const Entries& entries) {
  Sparse matrix(rows, columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const auto size = matrix.nonZeros();
  std::vector<double> values(matrix.valuePtr(), matrix.valuePtr() + size);
  std::vector<std::int64_t> indices(matrix.innerIndexPtr(), matrix.innerIndexPtr() + size),
      starts(matrix.outerIndexPtr(), matrix.outerIndexPtr() + rows + 1);
  return nb::module_::import_("scipy.sparse")
      .attr("csr_array")(
          nb::make_tuple(owning(std::move(values)), owning(std::move(indices)), owning(std::move(starts))),
          nb::arg("shape") = nb::make_tuple(rows, columns));
}

template <typename Block>
void add_block(Entries& entries, std::int64_t row, std::int64_t column, const Block& block) {
  for (int c = 0; c < block.cols(); ++c)
    for (int r = 0; r < block.rows(); ++r)
      if (block(r, c) != 0) entries.emplace_back(row + r, column + c, block(r, c));
}

nb::object jacobian(World& world) {
  const StepScope scope(world);
  const Rows rows(world);
  std::vector<double> values(rows.jacobian_size());
  rows.jacobian(world.state(), values);
  Entries entries;
  for (const Rows::Side& side : rows.sides())
    for (int r = 0; r < side.row_count; ++r)
      add_block(entries, side.first_row + r, 6L * side.body, Rows::block_row(side, values, r).transpose());
  return to_scipy(rows.row_count(), 6L * world.body_count(), entries);
}

/// M, or its inverse: I_W and m of each body that moves, nothing for others.
nb::object mass_matrix(const World& world, bool inverse) {
  require_askable(world);
  Entries entries;
  for (int b = 0; b < world.body_count(); ++b) {
    if (world.is_fixed({b})) continue;
    const MassProperties& mass = world.mass_properties({b});
    const Mat3 R = (world.pose({b}).q * mass.q_BP()).toRotationMatrix();
    const Vec3 moments = inverse ? Vec3(mass.principal_moments().cwiseInverse()) : mass.principal_moments();
    add_block(entries, 6L * b, 6L * b, Mat3(R * moments.asDiagonal() * R.transpose()));
    add_block(entries, 6L * b + 3, 6L * b + 3,
              Mat3((inverse ? 1 / mass.mass() : mass.mass()) * Mat3::Identity()));
  }
  return to_scipy(6L * world.body_count(), 6L * world.body_count(), entries);
}

/// As a step assembles it, in the order of the rows.
nb::object delassus_matrix(World& world) {
  const StepScope scope(world);
  LinearizedRows rows(world, Rows::AxisRows::kIncluded, Springs::kLeftOut);
  if (rows.row_count() == 0) return to_scipy(0, 0, {});
  rows.linearize(world.state());
  rows.set_mass(world.state().poses);
  DelassusSystem system(rows, FactorChoice::kAuto);
  system.assemble(rows, RowStates(), 0);
  const SymmetricMatrix& S = system.matrix();
  const std::span<const int> row_at = system.row_at_position();
  std::vector<int> block_of(S.size());
  for (int k = 0; k < S.block_count(); ++k)
    std::fill(block_of.begin() + S.block_start[k], block_of.begin() + S.block_start[k + 1], k);
  Entries entries;
  for (int c = 0; c < S.size(); ++c)
    for (int i = S.column_start[c]; i < S.column_start[c + 1]; ++i) {
      const int r = S.row_index[i];
      entries.emplace_back(row_at[r], row_at[c], S.values[i]);
      // Blocks on the diagonal are stored whole, of others there is one triangle.
      if (block_of[r] != block_of[c]) entries.emplace_back(row_at[c], row_at[r], S.values[i]);
    }
  return to_scipy(S.size(), S.size(), entries);
}

std::vector<std::tuple<JointId, std::string, bool>> row_list(World& world) {
  const StepScope scope(world);
  const Rows rows(world);
  std::vector<std::tuple<JointId, std::string, bool>> list;
  for (int r = 0; r < rows.row_count(); ++r)
    list.emplace_back(rows.joint_of(r).value_or(JointId{}), rows.row_name(r), rows.is_equality(r));
  return list;
}

/// One number a row.
Array row_values(World& world, auto fill) {
  const StepScope scope(world);
  const Rows rows(world);
  std::vector<double> values(rows.row_count());
  fill(rows, values);
  return owning(std::move(values));
}

Array gaps(World& world) {
  const StepScope scope(world);
  const Rows rows(world);
  std::vector<double> phi(rows.row_count()), gaps;
  rows.residual(world.state(), phi);
  for (const Gap& gap : joint_gaps(rows, phi)) gaps.insert(gaps.end(), {gap.metres, gap.radians});
  return owning(std::move(gaps), 2);
}

/// Its matrices are dense.
constexpr int kMostBodiesOfModes = 300;

std::vector<std::pair<double, nb::object>> modes(World& world) {
  const StepScope scope(world);
  if (world.moving_body_count() > kMostBodiesOfModes)
    fail("natural_modes", "takes at most 300 moving bodies", world.moving_body_count());
  if (Rows(world).row_count() == 0) fail("natural_modes", "needs a world with joints", world.joint_count());
  std::vector<std::pair<double, nb::object>> found;
  for (const Mode& mode : natural_modes(world))
    found.emplace_back(mode.omega, nb::cast(twist_array(mode.shape)));
  return found;
}

}  // namespace

void bind_matrices(nb::module_& m) {
  m.def("jacobian", &jacobian, nb::arg("world"),
        "J of all rows, sparse, rows × 6n: φ̇ = J V with V the twists of all n bodies one behind the other "
        "(angular velocity, "
        "then velocity of the centre of mass, world axes), those of the ground first.",
        nb::sig("def jacobian(world: World) -> scipy.sparse.csr_array"));
  m.def("mass_matrix", &mass_matrix, nb::arg("world"), nb::arg("inverse") = false,
        "M of all bodies, sparse, 6n × 6n: I_W [kg m²] and m [kg] of each; nothing for fixed ones.  With "
        "`inverse` M⁻¹, where "
        "fixed ones have 0.",
        nb::sig("def mass_matrix(world: World, inverse: bool = False) -> scipy.sparse.csr_array"));
  m.def("delassus_matrix", &delassus_matrix, nb::arg("world"),
        "S = J M⁻¹ Jᵀ as a step assembles it, sparse, in the order of the rows.",
        nb::sig("def delassus_matrix(world: World) -> scipy.sparse.csr_array"));
  m.def("rows", &row_list, nb::arg("world"),
        "The constraint rows in their order: joint, the motion that the row holds, and whether it must hold; "
        "the others are rows "
        "of axes with properties and of soft joints.");
  m.def(
      "residual",
      [](World& world) {
        return row_values(world, [&](const Rows& rows, auto& phi) { rows.residual(world.state(), phi); });
      },
      nb::arg("world"), "φ(q) [m or rad] of each row; of rows of axes the coordinate θ.");
  m.def(
      "bias",
      [](World& world) {
        return row_values(world, [&](const Rows& rows, auto& gamma) {
          rows.bias(world.state(), world.state().twists, gamma);
        });
      },
      nb::arg("world"), "γ = φ̈ − J V̇ of each row [m/s² or rad/s²].");
  m.def("gaps", &gaps, nb::arg("world"), "How far each joint is open, n×2: metres, radians.");
  m.def("natural_modes", &modes, nb::arg("world"),
        "Natural motions about an equilibrium with ω > 0, slowest first: pairs of ω [rad/s] and an n×6 array "
        "of twists with xᵀ M x "
        "= 1.  The world must be at rest in equilibrium.  Dense, for at most 300 moving bodies.");
}

}  // namespace taut::python
