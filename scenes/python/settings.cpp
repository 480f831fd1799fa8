#include "solvers/common/settings.h"

#include "scenes/python/parts.h"

namespace taut::python {
namespace {

void bind_choices(nb::module_& m) {
  nb::enum_<Integrator>(m, "Integrator", "How a step advances the state.")
      .value("RATTLE", Integrator::kRattle,
             "RATTLE on rigid bodies: order 2, symplectic, closed in position and velocity.")
      .value("RATTLE4", Integrator::kRattle4, "Composition of 5 steps of RATTLE, of order 4.")
      .value("RATTLE6", Integrator::kRattle6, "Composition of 9 steps of RATTLE, of order 6.")
      .value("RATTLE8", Integrator::kRattle8, "Composition of 17 steps of RATTLE, of order 8.")
      .value("FORCE_EULER", Integrator::kForceEuler,
             "Joint forces from the acceleration equation, semi-implicit Euler.")
      .value("FORCE_RUNGE_KUTTA", Integrator::kForceRungeKutta,
             "Joint forces from the acceleration equation, classical RK4.")
      .value("MOREAU_JEAN", Integrator::kMoreauJean,
             "Impulses of a whole step, laws on the velocities at its end; order 1.")
      .value("RECURSIVE", Integrator::kRecursive,
             "Reduced coordinates: accelerations by recursion in O(n), classical RK4.")
      .value("RECURSIVE_MIDPOINT", Integrator::kRecursiveMidpoint,
             "Reduced coordinates by recursion, implicit midpoint rule: order 2, time-reversible.")
      .value("LAGRANGIAN", Integrator::kLagrangian,
             "Reduced coordinates: Lagrange's equations, dense in O(n³), classical RK4.")
      .value("LAGRANGIAN_MIDPOINT", Integrator::kLagrangianMidpoint,
             "Lagrange's equations, implicit midpoint rule: order 2, time-reversible.");
  nb::enum_<DriftCure>(m, "DriftCure",
                       "What keeps joints from drifting apart at force level or with Moreau–Jean.")
      .value("AUTO", DriftCure::kAuto)
      .value("NONE", DriftCure::kNone)
      .value("BAUMGARTE", DriftCure::kBaumgarte)
      .value("VELOCITY_IMPULSE", DriftCure::kVelocityImpulse)
      .value("POSITION_PUSH", DriftCure::kPositionPush)
      .value("PENALTY", DriftCure::kPenalty);
  nb::enum_<TensionPolicy>(m, "TensionPolicy",
                           "What is done where tension makes explicit constraint directions unstable.")
      .value("SUBSTEP", TensionPolicy::kSubstep, "Sub-steps so small that ω h ≤ max_tension_number.")
      .value("IMPLICIT", TensionPolicy::kImplicit,
             "Implicit geometric stiffness: stable at any step, dissipative.")
      .value("IGNORE", TensionPolicy::kIgnore, "Nothing.");
  nb::enum_<FactorChoice>(m, "FactorChoice", "What factorises the matrix of the joints.")
      .value("AUTO", FactorChoice::kAuto)
      .value("CHOLMOD", FactorChoice::kCholmod)
      .value("SIMPLICIAL", FactorChoice::kSimplicial)
      .value("SUPERNODAL", FactorChoice::kSupernodal)
      .value("MULTIFRONTAL", FactorChoice::kMultifrontal)
      .value("DENSE", FactorChoice::kDense);
  nb::enum_<Solver>(m, "Solver", "How the impulses of a stage are found.")
      .value("DIRECT", Solver::kDirect, "All at once, by a sparse factor and the active set.")
      .value("GAUSS_SEIDEL", Solver::kGaussSeidel)
      .value("PAIRWISE", Solver::kPairwise)
      .value("PROPAGATION", Solver::kPropagation);
}

void bind_tolerances(nb::class_<Settings>& c) {
  c.def_rw("integrator", &Settings::integrator)
      .def_rw("position_tolerance", &Settings::position_tolerance,
              "Largest |φ| after a step [m or rad]; 1e-10.")
      .def_rw("velocity_tolerance", &Settings::velocity_tolerance, "Of |J V| [m/s or rad/s]; 1e-9.")
      .def_rw("max_newton_iterations", &Settings::max_newton_iterations,
              "Of the position stage of a sub-step.")
      .def_rw("max_substeps", &Settings::max_substeps, "Of one call of step().")
      .def_rw("tension", &Settings::tension)
      .def_rw("max_tension_number", &Settings::max_tension_number, "ω h of the fastest transverse frequency.")
      .def_rw("max_rotation", &Settings::max_rotation, "Rotation of any body in one sub-step [rad].")
      .def_rw("drift_cure", &Settings::drift_cure)
      .def_rw("erp", &Settings::erp, "Part of the joint error taken out in one step.")
      .def_rw("cfm", &Settings::cfm, "Compliance added to each row, as a fraction of its own S_ii.")
      .def_rw("penalty_frequency", &Settings::penalty_frequency, "[Hz].")
      .def_rw("penalty_damping_ratio", &Settings::penalty_damping_ratio)
      .def_rw("theta", &Settings::theta, "θ of Moreau–Jean, from ½ to 1.");
}

void bind_rest_of_settings(nb::class_<Settings>& c) {
  c.def_rw("contacts", &Settings::contacts, "Shapes of the world touch; False: they pass through each other.")
      .def_rw("contact_margin", &Settings::contact_margin, "Contacts exist up to this gap [m].")
      .def_rw("resting_speed", &Settings::resting_speed, "Slower impacts have no restitution [m/s].")
      .def_rw("locate_plastic_impacts", &Settings::locate_plastic_impacts,
              "Impacts without restitution end a sub-step when they happen, too: order 2 between impacts.")
      .def_rw("max_contacts", &Settings::max_contacts, "That a step takes on; 0: 10,000 + 50 per shape.")
      .def_rw("inexact_tolerance", &Settings::inexact_tolerance,
              "A residual up to this is taken, with Status.INEXACT.")
      .def_rw("sleep", &Settings::sleep, "Islands at rest stay where they are, at no cost.")
      .def_rw("sleep_speed", &Settings::sleep_speed, "[m/s].")
      .def_rw("sleep_time", &Settings::sleep_time, "[s].")
      .def_rw("merge_fixed_joints", &Settings::merge_fixed_joints,
              "Bodies that fixed joints hold together move as one.")
      .def_rw("factor", &Settings::factor)
      .def_rw("solver", &Settings::solver)
      .def_rw("iterations", &Settings::iterations, "Sweeps of an iterative solver.")
      .def_rw("relaxation", &Settings::relaxation, "ω of GAUSS_SEIDEL, between 0 and 2.")
      .def_rw("threads", &Settings::threads,
              "At most 1024; 0: as many as the machine has.  The bits do not depend on it.")
      .def_rw("report_energy", &Settings::report_energy, "Energies, momenta and works in each report.")
      .def_rw("report_rank", &Settings::report_rank, "Redundant rows and who holds them in each report.");
}

}  // namespace

void bind_settings(nb::module_& m) {
  bind_choices(m);
  nb::class_<Settings> settings(
      m, "Settings",
      "How a Simulator steps; its constructor refuses what is out of range.  Settings(threads=1, sleep=True) "
      "sets attributes by name.");
  settings.def(
      "__init__",
      [](nb::pointer_and_handle<Settings> self, const nb::kwargs& values) {
        new (self.p) Settings();
        nb::inst_mark_ready(self.h);
        for (const auto& [name, value] : values) {
          if (!nb::hasattr(self.h.type(), name))
            throw nb::type_error(("there is no setting " + nb::cast<std::string>(name)).c_str());
          nb::setattr(self.h, name, value);
        }
      },
      nb::sig("def __init__(self, **values: typing.Any) -> None"));
  bind_tolerances(settings);
  bind_rest_of_settings(settings);
}

}  // namespace taut::python
