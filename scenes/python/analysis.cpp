#include "collision/contact_finder.h"
#include "core/base/check.h"
#include "scenes/python/access.h"
#include "scenes/python/arrays.h"
#include "scenes/python/parts.h"
#include "solvers/friction/friction_solver.h"
#include "solvers/integrators/reduced/tree_dynamics.h"

// What answers questions beside a simulation: contacts, accelerations of trees, frictional contact by
// matrices.
namespace taut::python {
namespace {

void bind_contact_finder(nb::module_& m) {
  nb::class_<ContactFinder>(m, "ContactFinder", "Finds the contacts of a World; it changes nothing in it.")
      .def(
          "__init__",
          [](ContactFinder* it, double margin, int threads, int max_points, int max_contacts) {
            new (it) ContactFinder({margin, threads, max_points, max_contacts});
          },
          nb::arg("margin") = 0.005, nb::arg("threads") = 0, nb::arg("max_points") = 8,
          nb::arg("max_contacts") = 0)
      .def(
          "find",
          [](ContactFinder& finder, World& world, double horizon) {
            const StepScope scope(world);
            return std::vector<Contact>(finder.find(world, horizon));
          },
          nb::arg("world"), nb::arg("horizon") = 0,
          "All contacts at the present state with a gap up to the margin [m]; with a horizon [s] also those "
          "that would come "
          "together within it.");
}

Array tree_accelerations(World& world, bool lagrangian) {
  const StepScope scope(world);
  for (int j = 0; j < world.joint_count(); ++j) {
    if (world.has_axis_properties({j}))
      fail("joint", "must have nothing that acts along its axes in a tree", world.name(JointId{j}));
    if (world.compliance(JointId{j})) fail("joint", "must not be soft in a tree", world.name(JointId{j}));
  }
  TreeDynamics tree(world);
  tree.linearize(world.state());
  std::vector<Wrench> forces(world.body_count());
  std::vector<Twist> accelerations(world.body_count());
  world.forces(world.state(), forces);
  tree.accelerate(world.state(), forces,
                  lagrangian ? TreeDynamics::Method::kLagrangian : TreeDynamics::Method::kRecursive,
                  accelerations);
  return twist_array(accelerations);
}

/// Of anything that scipy.sparse.csr_array takes.
FrictionProblem::Matrix read_matrix(nb::handle source) {
  const nb::object csr = nb::module_::import_("scipy.sparse").attr("csr_array")(source);
  const auto [rows, columns] = nb::cast<std::pair<std::int64_t, std::int64_t>>(csr.attr("shape"));
  const auto values = nb::cast<std::vector<double>>(csr.attr("data").attr("tolist")());
  const auto indices = nb::cast<std::vector<std::int64_t>>(csr.attr("indices").attr("tolist")());
  const auto starts = nb::cast<std::vector<std::int64_t>>(csr.attr("indptr").attr("tolist")());
  std::vector<Eigen::Triplet<double>> entries;
  if (std::ssize(starts) != rows + 1 || rows > INT_MAX || columns > INT_MAX) fail("W", "is no matrix", rows);
  for (std::int64_t r = 0; r < rows; ++r)
    for (std::int64_t i = starts[r]; i < starts[r + 1]; ++i) {
      if (i < 0 || i >= std::ssize(values) || i >= std::ssize(indices) || indices[i] < 0 ||
          indices[i] >= columns)
        fail("W", "has an entry outside", i);
      entries.emplace_back(static_cast<int>(r), static_cast<int>(indices[i]), values[i]);
    }
  FrictionProblem::Matrix matrix(rows, columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

Eigen::VectorXd to_eigen(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), std::ssize(values));
}

Array to_array(const Eigen::VectorXd& v) { return owning(std::vector<double>(v.begin(), v.end())); }

void bind_friction(nb::module_& m) {
  nb::enum_<FrictionStatus>(m, "FrictionStatus", "How a problem of friction ended.")
      .value("SOLVED", FrictionStatus::kSolved, "To the accuracy.")
      .value("NO_SOLUTION", FrictionStatus::kNoSolution, "None exists: the certificate shows it.")
      .value("INEXACT", FrictionStatus::kInexact);
  nb::class_<FrictionResult>(m, "FrictionResult", "What solve_friction() has found.")
      .def_ro("status", &FrictionResult::status)
      .def_prop_ro(
          "r", [](const FrictionResult& it) { return to_array(it.r); }, kOwned, "Impulses [N·s].")
      .def_prop_ro(
          "largest_error", [](const FrictionResult& it) { return it.errors.largest(); },
          "The largest of three measures that do not depend on units.")
      .def_ro("factorisations", &FrictionResult::factorisations)
      .def_ro("sweeps", &FrictionResult::sweeps)
      .def_ro("seconds", &FrictionResult::seconds)
      .def_prop_ro(
          "certificate",
          [](const FrictionResult& it) -> std::optional<Array> {
            if (!it.certificate) return std::nullopt;
            return to_array(*it.certificate);
          },
          kOwned, "d with W d = 0, d_N ≥ 0, d_T = 0 and d·q < 0 where there is no solution, else None.");
  m.def(
      "solve_friction",
      [](nb::object W, const std::vector<double>& q, const std::vector<double>& mu, int equalities,
         double accuracy, const std::optional<std::vector<double>>& guess) {
        const FrictionProblem problem{read_matrix(W), to_eigen(q), to_eigen(mu), equalities};
        const Eigen::VectorXd start = guess ? to_eigen(*guess) : Eigen::VectorXd();
        const nb::gil_scoped_release released;
        return solve_friction(problem, {accuracy}, guess ? &start : nullptr);
      },
      nb::arg("W"), nb::arg("q"), nb::arg("mu"), nb::arg("equalities") = 0, nb::arg("accuracy") = 1e-8,
      nb::arg("guess") = nb::none(),
      "Impulses r of frictional contact given by matrices: of u = W r + q the first `equalities` rows are 0; "
      "then each contact has "
      "three, normal and two tangents, with Signorini's and Coulomb's law, mu its coefficient.  W is n × n, "
      "sparse or dense.",
      nb::sig("def solve_friction(W: typing.Any, q: collections.abc.Sequence[float], mu: "
              "collections.abc.Sequence[float], "
              "equalities: int = 0, accuracy: float = 1e-8, guess: collections.abc.Sequence[float] | None = "
              "None) -> "
              "FrictionResult"));
}

}  // namespace

void bind_analysis(nb::module_& m) {
  bind_contact_finder(m);
  m.def("tree_accelerations", &tree_accelerations, nb::arg("world"), nb::arg("lagrangian") = false,
        "V̇ of all bodies, n×6 (angular, then linear), in reduced coordinates: by recursion, or by Lagrange's "
        "equations; joints that close loops by multipliers.  A reference, with no S in it.");
  bind_friction(m);
}

}  // namespace taut::python
