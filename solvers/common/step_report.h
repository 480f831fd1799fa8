#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/state/state.h"
#include "core/world/diagnostics.h"
#include "core/world/world.h"
#include "solvers/common/axis_report.h"
#include "solvers/common/contact_report.h"
#include "solvers/common/energy_ledger.h"

namespace taut {

enum class Status {  ///< How a step ended.
  kSuccess,
  kInexact,  ///< the step is done and its joints are closed, but the laws of contacts, friction and limits
             ///< are met to `complementarity_residual` only, which is between 1e-8 and
             ///< Settings::inexact_tolerance
  kNotConverged,   ///< positions could not be closed down to the smallest sub-step; the state is that before
                   ///< the step
  kContradiction,  ///< some joints, limits, motors or contacts cannot hold together: see
                   ///< StepReport::contradiction; state as before the step
  kNotFinite,      ///< a force or a state is not finite, or beyond 1e30; state as before the step
  kInterrupted,    ///< Simulator::set_interrupt() asked for the end; state as before the step
  kCrowded,  ///< more contacts than Settings::max_contacts: see StepReport::crowd; state as before the step
};
std::string_view to_string(Status status);  ///< in words, as "not converged"

/// Wall time of the stages of a step [s]; islands that are solved at the same time count one by one.
struct StageTimes {
  double forces = 0;         ///< evaluation of force laws
  double positions = 0;      ///< drift, residuals and back-solves of the position stage
  double assembly = 0;       ///< Jacobian and Delassus matrix
  double factorization = 0;  ///< numeric
  double velocities = 0;     ///< back-solves of the velocity stage
  double analysis = 0;       ///< ordering and symbolic factorisation; 0 unless the topology changed
  double total = 0;          ///< of the step

  StageTimes& operator+=(const StageTimes& other);  ///< adds each stage
};

/// Joints, limits, motors and contacts that cannot hold together, and the gap that is left when they share
/// it; or joints that jam by their friction and the drivers and motors that force them, with no gap.
struct Contradiction {
  /// What else than its joint holds an axis.
  struct Bound {
    enum class Kind { kLowerLimit, kUpperLimit, kMotor };  ///< What holds the axis.
    AxisId axis;                                           ///< that is held
    Kind kind = Kind::kLowerLimit;                         ///< by what
    friend bool operator==(const Bound&, const Bound&) = default;
  };
  /// All contacts of two bodies, a.index < b.index.
  struct Touch {
    BodyId a, b;  ///< the two bodies
    friend bool operator==(const Touch&, const Touch&) = default;
  };

  std::vector<JointId> joints;  ///< by their equality rows
  std::vector<Bound> bounds;    ///< limits and motors of axes
  std::vector<Touch> contacts;  ///< pairs of bodies
  double residual = 0;          ///< [m or rad]

  bool empty() const { return joints.empty() && bounds.empty() && contacts.empty(); }  ///< nothing
};
/// Names of its members, in their order, for messages: "hinge elbow", "upper limit of hinge elbow angle",
/// "motor of slider lift displacement", "contact of box and ground".
std::vector<std::string> names_of(const Contradiction& contradiction, const World& world);

/// Who has a large share in what a step could not do, or did inexactly.
struct Culprit {
  enum class Kind {  ///< What it is, and which members name it.
    kJoint,          ///< axis.joint is open, or what it follows is not finite
    kAxis,           ///< the law of a free axis is not met, or what its motor follows is not finite
    kSpring,         ///< the law of a spring between two bodies, `force`, is not met
    kContact,        ///< the law of the contacts of bodies a and b is not met
    kForce,          ///< what the law `force` gives is not finite
    kBody,           ///< the state of body a, or the force on it, is not finite
  };
  Kind kind = Kind::kBody;  ///< what it is
  AxisId axis{};            ///< of kJoint and kAxis
  ForceId force{};          ///< of kSpring and kForce
  BodyId a{}, b{};          ///< of kContact and kBody
  /// How far a joint is open [m or rad]; of a law that is not met its natural residual, relative as in
  /// StepReport::natural_residual; infinite for what is not finite.
  double share = 0;
};
/// For messages: "hinge elbow", "hinge elbow angle", "spring between a and b", "contact of box and ground",
/// "force law 2 on bob", "body bob".
std::string name_of(const Culprit& culprit, const World& world);

/// A row of a joint that other rows hold already.
struct DependentRow {
  JointId joint;  ///< whose row it is
  int row = 0;    ///< within the joint
  friend auto operator<=>(const DependentRow&, const DependentRow&) = default;
};
/// For messages: "hinge seam_3: translation along world y".  Good while the world's topology is that of the
/// step.
std::vector<std::string> names_of(std::span<const DependentRow> rows, const World& world);

/// A row that other rows already hold, and the joints that hold it.
struct RedundantRow {
  JointId joint;                 ///< whose row it is
  int row = 0;                   ///< within the joint
  std::string name;              ///< the motion that it would hold
  std::vector<JointId> held_by;  ///< those with the largest share first
};

/// Freedoms and redundancy of a world in its present pose.
struct RankReport {
  int rows = 0;                         ///< of all joints
  int rank = 0;                         ///< number of independent ones
  int freedoms = 0;                     ///< 6 × moving bodies − rank
  std::vector<RedundantRow> redundant;  ///< the dependent ones
  /// Joints whose reactions are not unique, in ascending order: those that a self-stress of the mechanism
  /// loads.
  std::vector<JointId> not_unique;
};

/// For messages: "triangle_mesh of rock and height_field of ground".
std::string name_of(const std::pair<ShapeId, ShapeId>& pair, const World& world);
/// For messages: "more than 25000 pairs of shapes near each other, or contacts, most of them of b1, b2 …".
std::string text_of(const Crowd& crowd, const World& world);

/// A joint that broke in a step, or left with one that did.
struct BreakEvent {
  JointId joint;                 ///< that is detached now
  double time = 0;               ///< [s]
  double force = 0, torque = 0;  ///< the load that it did not bear: mean over a sub-step [N], [N·m]
  double energy = 0;             ///< that was in its springs and its compliance, and is lost [J]
  JointId with{};  ///< the joint that broke whose axes it coupled; index −1 if it broke itself
};

/// An event that has happened (Simulator::set_events()).
struct EventRecord {
  int event = 0;                ///< its place in the list
  std::string name;             ///< of the event
  std::string what;             ///< what it did: "detach hook"; empty: it warns
  double time = 0;              ///< when [s]
  std::optional<double> value;  ///< of what it watches, then; none for a time
  bool ends_run = false;        ///< it ends the run
};

/// How often the solvers of a step did what costs time.
struct SolverCounts {
  int analyses = 0;            ///< of patterns: ordering and symbolic factorisation
  int factorizations = 0;      ///< numeric
  int backsolves = 0;          ///< with a factor
  int refactorizations = 0;    ///< factorizations at Newton iterates that converged too slowly
  int pivots = 0;              ///< rows that changed their place in the active sets of the step
  int contact_iterations = 0;  ///< of Newton's method for contacts; 0: the active set did it
  int sweeps = 0;              ///< of an iterative solver, both stages

  SolverCounts& operator+=(const SolverCounts& other);  ///< adds each
};

/// Works of a step [J], each impulse j of a kick from V₀ to V₁ doing j·½ (V₀ + V₁).
struct StepWorks {
  double constraint = 0;   ///< of all ideal joints' impulses
  AxisImpulse axes;        ///< of motors, friction, limits, springs and dampers of the axes
  ContactWork contacts;    ///< of contacts
  double stiffness = 0;    ///< energy taken by implicit geometric stiffness
  double drivers = 0;      ///< of joints that follow the time, a part of `constraint`
  double forces = 0;       ///< of gravity and the force laws
  double dissipative = 0;  ///< of those that are not conservative, a part of `forces`
  double flow = 0;         ///< kinetic energy that is gained between kicks, where free flow is approximate

  /// Adds each but `axes` and `contacts`, whose reports are sums over the step.
  StepWorks& operator+=(const StepWorks& next);
};

/// What a sub-step comes to; the sum of those that were kept, and what the others have cost, is what a step
/// comes to.
struct SubstepReport {
  Status status = Status::kSuccess;  ///< how the step ended
  std::string message;               ///< empty on success

  double velocity_residual = 0;         ///< largest |J V| [m/s or rad/s]
  int newton_iterations = 0;            ///< position stage, all sub-steps
  int substeps = 0;                     ///< that were taken
  SolverCounts counts;                  ///< what the solvers did
  double tension_number = 0;            ///< largest ω h of the sub-steps taken
  double complementarity_residual = 0;  ///< largest of the active sets of the step, relative (active_set.h)
  /// The natural residual of the laws of axes and contacts at the impulses and rates that each stage ended
  /// with, no tolerance taken off, over the size of both: at most 1e-9 on success, 1e-8 in steps with
  /// contacts (solvers/complementarity, "Natural residual").  Joints have `gap` and `velocity_residual`.
  double natural_residual = 0;
  StageTimes times;  ///< where the time went
  StepWorks works;   ///< of what acted, with Settings::report_energy
  /// With all other statuses but kSuccess: who has the largest shares in it, the largest first; empty if
  /// nobody stands out.
  std::vector<Culprit> culprits;
};
/// The next sub-step, which was taken, to the sum of those before: works, counts and times are summed,
/// residuals the largest, but for that of velocities, which is where they are now.
void add_taken(SubstepReport& sum, const SubstepReport& next);
/// One that was not taken: Newton iterations, counts and times.
void add_cost(SubstepReport& sum, const SubstepReport& next);

/// The proof of quality of one step.
struct StepReport : SubstepReport {
  double time = 0;  ///< at the end of the step [s]
  double dt = 0;    ///< as given to step() [s]

  /// Largest error at the end of all that should hold, of bodies that are awake: of joints, merged ones too,
  /// and of axes, as the length of a rope, beyond their rigid limits.  On success joints are within
  /// Settings::position_tolerance, but for iterative solvers, force level and DriftCure::kNone, and so are
  /// limits, but for those that a step began beyond: an axis comes back by no more than 1 m/s or 1 rad/s.
  Gap gap;
  int rank_deficiency = 0;        ///< dependent rows at the end of the step
  double condition_estimate = 0;  ///< of S, from the pivots: a lower bound
  int contacts = 0;               ///< points at the end of the step, touching or near
  double penetration = 0;         ///< deepest of them, ≥ 0 [m]
  int asleep = 0;                 ///< bodies that did not move because they sleep (Settings::sleep)

  // With Settings::report_energy:
  double kinetic_energy = 0, potential_energy = 0;  ///< the latter without that of springs [J]
  double spring_energy = 0;                         ///< in springs, soft limits and soft joints [J]
  Vec3 linear_momentum = Vec3::Zero();              ///< [N·s]
  Vec3 angular_momentum = Vec3::Zero();             ///< about the world origin [N·m·s]
  EnergyLedger ledger;                              ///< where the energy went

  /// Rows of joints that others hold already, as many as rank_deficiency but for those of contacts;
  /// names_of() says which.
  std::vector<DependentRow> dependent_rows;
  /// With Settings::report_rank, at the end of the step: who holds those rows, and whose reactions are not
  /// unique.
  std::optional<RankReport> rank;
  std::vector<BreakEvent> breaks;   ///< in the order in which they happened; the joints are detached now
  std::vector<EventRecord> events;  ///< that happened in the step, in this order
  Contradiction contradiction;      ///< with Status::kContradiction
  Crowd crowd;                      ///< with Status::kCrowded

  /// Pairs of shapes near each other at the end of the step that pass through each other, since there is no
  /// law for their contact (have_contacts()): the first eight, and how many there are.
  std::vector<std::pair<ShapeId, ShapeId>> unsupported;
  int unsupported_pairs = 0;  ///< number of such pairs
  /// Threads that Settings::threads asks for and that could not be started: the others did their work.
  int missing_threads = 0;

  /// The step was taken and the world has moved on, for loops: kSuccess or kInexact.
  bool ok() const { return exact() || status == Status::kInexact; }
  /// The step was taken and all laws are met to their tolerances: kSuccess.
  bool exact() const { return status == Status::kSuccess; }
  double energy() const { return kinetic_energy + potential_energy + spring_energy; }  ///< [J]
};

}  // namespace taut
