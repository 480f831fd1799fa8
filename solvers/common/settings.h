#pragma once

namespace taut {

/// How a step advances the state; see solvers/integrators/README.md.
enum class Integrator {
  kRattle,           ///< RATTLE on rigid bodies: order 2, symplectic, closed in position and velocity
  kRattle4,          ///< composition of 5 steps of kRattle, of order 4
  kRattle6,          ///< composition of 9 steps of kRattle, of order 6
  kRattle8,          ///< composition of 17 steps of kRattle, of order 8
  kForceEuler,       ///< joint forces from the acceleration equation, semi-implicit Euler
  kForceRungeKutta,  ///< joint forces from the acceleration equation, classical RK4
  kMoreauJean,       ///< Moreau–Jean: impulses of a whole step, laws on the velocities at its end; order 1
  // Reduced coordinates, in which joints are closed in position and velocity; c rows of loops and axes that
  // are held add O(c n + c³) to a step.
  kRecursive,           ///< accelerations by recursion over the joints in O(n), classical RK4: order 4
  kRecursiveMidpoint,   ///< recursion in O(n), implicit midpoint rule: order 2, time-reversible
  kLagrangian,          ///< accelerations by Lagrange's equations, dense in O(n³), classical RK4: order 4
  kLagrangianMidpoint,  ///< Lagrange's equations in O(n³), implicit midpoint rule: order 2
};

/// What keeps the joints of a force-level integrator or of Moreau–Jean from drifting apart.  RATTLE needs
/// none and ignores it.
enum class DriftCure {
  kAuto,  ///< kBaumgarte at force level, kPositionPush with Moreau–Jean, which knows only this one and kNone
  kNone,             ///< nothing: joints drift
  kBaumgarte,        ///< acceleration feedback with `erp` and `cfm`
  kVelocityImpulse,  ///< an impulse after each step gives J V = −erp φ / dt
  kPositionPush,     ///< positions are pushed back by `erp` φ after each step, velocities made tangent;
                     ///< with Moreau–Jean: until joints are closed, and velocities are left alone
  kPenalty,          ///< no multipliers: springs and dampers in place of the joints
};

/// What is done where tension makes explicit constraint directions unstable (solvers/integrators, "Tension").
enum class TensionPolicy {
  kSubstep,   ///< sub-steps so small that ω h ≤ max_tension_number
  kImplicit,  ///< implicit geometric stiffness: stable at any step, dissipative
  kIgnore,    ///< nothing: the step may be unstable, which StepReport::tension_number tells
};

inline constexpr int kMostDenseRows = 10000;  ///< of FactorChoice::kDense, whose matrix takes 800 MB then

enum class FactorChoice {  ///< What factorises the symmetric positive definite matrix of the joints.
  kAuto,                   ///< the fastest measured: multifrontal
  kCholmod,                ///< CHOLMOD, simplicial or supernodal by flop count
  kSimplicial,             ///< CHOLMOD simplicial LDLᵀ
  kSupernodal,             ///< CHOLMOD supernodal LLᵀ; simplicial if this CHOLMOD lacks its GPL modules
  kMultifrontal,           ///< taut's own LLᵀ
  kDense,                  ///< LLᵀ of the whole matrix, zeros too, to compare with; up to kMostDenseRows
};

/// How the impulses of a stage are found: by the factor and the active set, or, to compare with, by impulses
/// on one joint or contact after the other (solvers/complementarity/impulse_iteration.h), with RATTLE's two
/// stages as stabilisation of positions before the drift and of velocities after it [Weinstein2006].  These
/// take each step as it is: how open the joints are is in the report, and no failure.
enum class Solver {
  kDirect,       ///< all at once, by a sparse factor and the active set
  kGaussSeidel,  ///< projected Gauss–Seidel, over-relaxed by `relaxation`
  kPairwise,     ///< joint by joint, the most violated first
  kPropagation,  ///< joint by joint from the ground upwards, at last with what lies below held fast
};

struct Settings {  ///< How a Simulator steps; its constructor refuses what is out of range.
  Integrator integrator = Integrator::kRattle;  ///< how a step advances the state

  double position_tolerance = 1e-10;  ///< largest |φ| after a step [m or rad]
  /// Of |J V| [m/s or rad/s].  An aim where there are no laws, and with them where rows depend on each other:
  /// up to 1e-6 may be left along directions that these hold weakly; see StepReport::velocity_residual.
  double velocity_tolerance = 1e-9;
  int max_newton_iterations = 12;  ///< of the position stage of a sub-step
  int max_substeps = 1024;         ///< of one call of step(); then the status says so

  TensionPolicy tension = TensionPolicy::kSubstep;  ///< what is done under high tension
  double max_tension_number =
      0.7;                    ///< ω h with ω the fastest transverse frequency that the multipliers imply
  double max_rotation = 0.4;  ///< rotation of any body in one sub-step [rad]

  DriftCure drift_cure = DriftCure::kAuto;  ///< against drift of the joints
  double erp = 0.8;                         ///< part of the joint error taken out in one step
  double cfm = 0;                           ///< compliance added to each row, as a fraction of its own S_ii
  double penalty_frequency = 50;            ///< [Hz] of the penalty springs on the bodies' own inertia
  double penalty_damping_ratio = 1;         ///< of the penalty springs; 1: critical

  /// θ of Moreau–Jean, q₁ = q₀ + h (θ V₁ + (1 − θ) V₀), from ½ to 1; 1 in steps that are too long for a
  /// spring (solvers/integrators, "Moreau–Jean").
  double theta = 0.5;

  bool contacts = true;           ///< shapes of the world touch; false: they pass through each other
  double contact_margin = 0.005;  ///< [m] contacts exist up to this gap
  double resting_speed = 1e-3;    ///< [m/s] slower impacts have no restitution
  /// Impacts without restitution, too, end a sub-step when they happen, of contacts faster than
  /// `resting_speed` and of axes at rigid limits: order 2 between impacts, where they otherwise happen at the
  /// ends of steps and leave errors of order 1, at the price of a sub-step for each.  At most 16 in a step
  /// are located.  RATTLE with Solver::kDirect does this.
  bool locate_plastic_impacts = false;
  /// Contacts, and a quarter of the pairs of near shapes, that a step takes on; 0: 10,000 + 50 per shape.
  /// With more it is not done (Status::kCrowded).
  int max_contacts = 0;
  /// Where, in a world with contacts, the laws of contacts, friction and limits cannot be met to 1e-8 of the
  /// largest impulse, a residual up to this is taken, with Status::kInexact; 0: such a step fails.
  double inexact_tolerance = 1e-4;

  /// Islands (bodies that joints, forces and contacts connect) whose bodies have been slower than
  /// `sleep_speed` [m/s] for `sleep_time` [s] stay where they are, at no cost, until something wakes them;
  /// see solvers/simulator, "Sleep".
  bool sleep = false;
  double sleep_speed = 1e-4, sleep_time = 0.5;  ///< [m/s], or [s]

  /// Bodies that fixed joints hold together move as one; see solvers/simulator, "Merged bodies".
  bool merge_fixed_joints = false;

  FactorChoice factor = FactorChoice::kAuto;  ///< with Solver::kDirect
  Solver solver = Solver::kDirect;            ///< how impulses are found
  int iterations = 50;    ///< sweeps of an iterative solver over all joints and contacts, per stage
  double relaxation = 1;  ///< ω of kGaussSeidel, between 0 and 2
  /// For finding contacts, solving islands, and large systems of one island; at most 1024; 0: as many as the
  /// machine has.  The results have the same bits with any number.
  int threads = 0;
  /// Energies, momenta and the work of the constraint forces in each report.
  bool report_energy = true;
  /// Redundant rows, who holds them and reactions that are not unique in each report, at the price of some
  /// factorisations.
  bool report_rank = false;
};

}  // namespace taut
