#include "core/joints/joints.h"

#include <nanobind/stl/array.h>

#include "scenes/python/callbacks.h"
#include "scenes/python/parts.h"

// In docstrings: P is a point of A, Q one of B, p_WP where it is in the world; λ is what the joint does to B.
namespace taut::python {
namespace {

constexpr const char* kAt =
    "The joint in the bodies' present poses, by a world point [m] and unit world axes.";
constexpr const char* kParts =
    "Points from the centres of mass [m] and unit axes, in body axes; for the ground, in world axes.";
const auto kWorld = nb::arg("world"), kA = nb::arg("a"), kB = nb::arg("b"), kPoint = nb::arg("p_W");

void bind_point_joints(nb::module_& m) {
  nb::class_<Ball, Joint>(
      m, "Ball",
      "Point P of A stays on point Q of B:  φ = p_WQ − p_WP ∈ ℝ³ [m].  λ is the force on B at Q, world axes. "
      " "
      "Free axes only after with_axes(): swing, twist, turn_x, turn_y, turn_z, swing_x, swing_y [rad].")
      .def(nb::init<BodyId, BodyId, const Vec3&, const Vec3&>(), kA, kB, nb::arg("p_AP"), nb::arg("p_BQ"),
           kParts)
      .def_static("at", &Ball::at, kWorld, kA, kB, kPoint,
                  "The joint at a world point [m] in the bodies' present poses.")
      .def(
          "with_axes",
          [](const Ball& ball, const World& world, const Vec3& axis) { return ball.with_axes(world, axis); },
          kWorld, nb::arg("axis_W"),
          "This joint with free axes: swing and twist from a unit world direction, 0 in the present poses.")
      .def(
          "with_axes",
          [](const Ball& ball, const Quat& q_AF, const Quat& q_BG) { return ball.with_axes(q_AF, q_BG); },
          nb::arg("q_AF"), nb::arg("q_BG"),
          "This joint with free axes: z of the frames F in A and G in B (w, x, y, z) are the directions of "
          "swing and twist.");
  nb::class_<Distance, Joint>(
      m, "Distance",
      "A massless rod: P of A and Q of B keep the distance L:  φ = |p_WQ − p_WP| − L [m].  λ > 0 pushes the "
      "points apart, λ < 0 pulls them together.")
      .def(nb::init<BodyId, BodyId, const Vec3&, const Vec3&, double>(), kA, kB, nb::arg("p_AP"),
           nb::arg("p_BQ"), nb::arg("length"), kParts)
      .def_static("between", &Distance::between, kWorld, kA, kB, nb::arg("p_a_W"), nb::arg("p_b_W"),
                  "The rod between two world points of A and B in their present poses.");
  nb::class_<PointOnLine, Joint>(
      m, "PointOnLine",
      "Point Q of B stays on the line of A through P along the axis, free to turn:  φ = (u·d, v·d) [m], d = "
      "p_WQ − p_WP, u and v two normals of the axis in A.  Free axis: displacement [m].")
      .def(nb::init<BodyId, BodyId, const Vec3&, const Vec3&, const Vec3&>(), kA, kB, nb::arg("p_AP"),
           nb::arg("axis_A"), nb::arg("p_BQ"), kParts)
      .def_static("at", &PointOnLine::at, kWorld, kA, kB, kPoint, nb::arg("axis_W"), kAt);
  nb::class_<PointOnCurve, Joint>(
      m, "PointOnCurve",
      "Point Q of B stays on a twice continuously differentiable spline fixed in A, free to turn.  Free "
      "axis: parameter, where Q is on the curve; rounds of a closed curve are counted.")
      .def(
          "__init__",
          [](PointOnCurve* it, BodyId a, BodyId b, const std::vector<double>& parameters,
             const std::vector<Vec3>& points, const Vec3& p_BQ,
             bool closed) { new (it) PointOnCurve(a, b, CubicSpline<3>(parameters, points, closed), p_BQ); },
          kA, kB, nb::arg("parameters"), nb::arg("points_A"), nb::arg("p_BQ"), nb::arg("closed") = false,
          "The spline through points of A at increasing parameters.")
      .def_static("through", &PointOnCurve::through, kWorld, kA, kB, nb::arg("points_W"), nb::arg("p_b_W"),
                  nb::arg("closed") = false,
                  "The curve through world points in the present pose of A; a closed one must end with its "
                  "first point.");
}

void bind_axis_joints(nb::module_& m) {
  nb::class_<Hinge, Joint>(m, "Hinge",
                           "Point P of A stays on point Q of B and axis a of A along axis b of B:  φ = (p_WQ "
                           "− p_WP, u·b, v·b) [m, m, m, "
                           "rad, rad], u, v, a a frame of A.  Free axis: angle [rad], the turn of B against "
                           "A about a, 0 in the pose "
                           "where at() made the joint.")
      .def(nb::init<BodyId, BodyId, const Vec3&, const Vec3&, const Vec3&, const Vec3&>(), kA, kB,
           nb::arg("p_AP"), nb::arg("axis_A"), nb::arg("p_BQ"), nb::arg("axis_B"), kParts)
      .def(nb::init<BodyId, BodyId, const Vec3&, const Vec3&, const Vec3&, const Vec3&, const Vec3&,
                    const Vec3&>(),
           kA, kB, nb::arg("p_AP"), nb::arg("axis_A"), nb::arg("reference_A"), nb::arg("p_BQ"),
           nb::arg("axis_B"), nb::arg("reference_B"),
           "The angle is 0 where the references, unit vectors across the axes, point the same way.")
      .def("zeroed", &Hinge::zeroed, nb::arg("A"), nb::arg("B"),
           "A copy whose angles are 0 in these poses of A and B.")
      .def_static("at", &Hinge::at, kWorld, kA, kB, kPoint, nb::arg("axis_W"), kAt);
  nb::class_<Slider, Joint>(m, "Slider",
                            "B moves along an axis of A without turning:  φ = (u·d, v·d, 2 vec q_FG) ∈ ℝ⁵ "
                            "[m, m, rad, rad, rad].  Free "
                            "axis: displacement [m], 0 where at() made the joint.")
      .def(nb::init<BodyId, BodyId, const Vec3&, const Vec3&, const Vec3&, const Quat&>(), kA, kB,
           nb::arg("p_AP"), nb::arg("axis_A"), nb::arg("p_BQ"), nb::arg("q_AB"),
           "Points from the centres of mass [m], unit axis in A, q_AB the orientation of B in A (w, x, y, z) "
           "that is kept.")
      .def_static("at", &Slider::at, kWorld, kA, kB, kPoint, nb::arg("axis_W"), kAt);
  nb::class_<Cylindrical, Joint>(
      m, "Cylindrical",
      "B turns about an axis of A and slides along it:  φ ∈ ℝ⁴ [m, m, rad, rad].  Free axes: angle [rad], "
      "displacement [m].")
      .def(nb::init<BodyId, BodyId, const Vec3&, const Vec3&, const Vec3&, const Vec3&>(), kA, kB,
           nb::arg("p_AP"), nb::arg("axis_A"), nb::arg("p_BQ"), nb::arg("axis_B"), kParts)
      .def("zeroed", &Cylindrical::zeroed, nb::arg("A"), nb::arg("B"),
           "A copy whose angles are 0 in these poses of A and B.")
      .def_static("at", &Cylindrical::at, kWorld, kA, kB, kPoint, nb::arg("axis_W"), kAt);
  nb::class_<Screw, Joint>(
      m, "Screw",
      "B turns about an axis of A and moves along it by `pitch` [m] per turn, negative for a left-handed "
      "thread.  Free axis: angle [rad].")
      .def(nb::init<BodyId, BodyId, const Vec3&, const Vec3&, const Vec3&, const Vec3&, const Vec3&,
                    const Vec3&, double>(),
           kA, kB, nb::arg("p_AP"), nb::arg("axis_A"), nb::arg("reference_A"), nb::arg("p_BQ"),
           nb::arg("axis_B"), nb::arg("reference_B"), nb::arg("pitch"),
           "The angle is 0 where the references, unit vectors across the axes, point the same way.")
      .def_static("at", &Screw::at, kWorld, kA, kB, kPoint, nb::arg("axis_W"), nb::arg("pitch"), kAt);
  nb::class_<Planar, Joint>(m, "Planar",
                            "B slides on a plane of A and turns about its normal:  φ ∈ ℝ³ [m, rad, rad].  "
                            "Free axes: x, y [m], angle "
                            "[rad].")
      .def(nb::init<BodyId, BodyId, const Vec3&, const Vec3&, const Vec3&, const Vec3&, const Vec3&,
                    const Vec3&>(),
           kA, kB, nb::arg("p_AP"), nb::arg("normal_A"), nb::arg("x_A"), nb::arg("p_BQ"), nb::arg("normal_B"),
           nb::arg("x_B"), "Points from the centres of mass [m], normal and x direction of either body.")
      .def_static("at", &Planar::at, kWorld, kA, kB, kPoint, nb::arg("normal_W"), nb::arg("x_W"), kAt);
  nb::class_<Universal, Joint>(m, "Universal",
                               "Cardan joint: P of A stays on Q of B, axis a of A perpendicular to axis b of "
                               "B:  φ = (p_WQ − p_WP, a·b) "
                               "[m, m, m, rad].  Free axes: angle_1, angle_2, swing, swing_1, swing_2 [rad].")
      .def(nb::init<BodyId, BodyId, const Vec3&, const Vec3&, const Vec3&, const Vec3&>(), kA, kB,
           nb::arg("p_AP"), nb::arg("axis_A"), nb::arg("p_BQ"), nb::arg("axis_B"), kParts)
      .def("zeroed", &Universal::zeroed, nb::arg("A"), nb::arg("B"),
           "A copy whose angles are 0 in these poses of A and B.")
      .def_static("at", &Universal::at, kWorld, kA, kB, kPoint, nb::arg("axis_a_W"), nb::arg("axis_b_W"),
                  kAt);
  nb::class_<Hinge2, Joint>(
      m, "Hinge2",
      "Car wheel: A is the chassis, B the wheel, whose centre moves along the steering axis of A; it is "
      "steered "
      "about that and spins about its own.  Free axes: travel [m], steering, spin [rad].")
      .def(nb::init<BodyId, BodyId, const Vec3&, const Vec3&, const Vec3&, const Vec3&>(), kA, kB,
           nb::arg("p_AP"), nb::arg("steering_A"), nb::arg("p_BQ"), nb::arg("spin_B"), kParts)
      .def("zeroed", &Hinge2::zeroed, nb::arg("A"), nb::arg("B"),
           "A copy whose angles are 0 in these poses of A and B.")
      .def_static("at", &Hinge2::at, kWorld, kA, kB, kPoint, nb::arg("steering_W"), nb::arg("spin_W"), kAt);
}

void bind_held_joints(nb::module_& m) {
  nb::class_<Fixed, Joint>(
      m, "Fixed",
      "B keeps its pose relative to A:  φ = (p_WQ − p_WP, 2 vec q_FG) ∈ ℝ⁶ [m, m, m, rad, rad, rad].")
      .def(nb::init<BodyId, BodyId, const Vec3&, const Vec3&, const Quat&>(), kA, kB, nb::arg("p_AP"),
           nb::arg("p_BQ"), nb::arg("q_AB"),
           "Points from the centres of mass [m]; q_AB the orientation of B in A (w, x, y, z) that is kept.")
      .def_static("at", &Fixed::at, kWorld, kA, kB, kPoint,
                  "The joint at a world point [m] that keeps the present poses.");
  nb::class_<SixDof, Joint>(m, "SixDof",
                            "Frame G of B moves against frame F of A, with any of the translations along and "
                            "rotations about the axes "
                            "of F locked.  Free axes: x, y, z [m], angle_x, angle_y, angle_z [rad] where "
                            "free, 0 where at() made it.")
      .def(
          "__init__",
          [](SixDof* it, BodyId a, BodyId b, const Vec3& p_AF, const Quat& q_AF, const Vec3& p_BG,
             const Quat& q_BG, const std::array<bool, 3>& translation, const std::array<bool, 3>& rotation) {
            new (it) SixDof(a, b, p_AF, q_AF, p_BG, q_BG, {translation, rotation});
          },
          kA, kB, nb::arg("p_AF"), nb::arg("q_AF"), nb::arg("p_BG"), nb::arg("q_BG"), nb::arg("translation"),
          nb::arg("rotation"),
          "Points from the centres of mass [m] and orientations of the frames (w, x, y, z), in body axes.")
      .def_static(
          "at",
          [](const World& world, BodyId a, BodyId b, const Vec3& p_W, const Quat& q_WF,
             const std::array<bool, 3>& translation, const std::array<bool, 3>& rotation) {
            return SixDof::at(world, a, b, p_W, q_WF, {translation, rotation});
          },
          kWorld, kA, kB, kPoint, nb::arg("q_WF"), nb::arg("translation"), nb::arg("rotation"),
          "Both frames at (p_W, q_WF), q_WF as w, x, y, z; `translation` and `rotation`: which of x, y, z "
          "are locked.");
  nb::class_<PoseDriver, Joint>(m, "PoseDriver",
                                "B has a prescribed pose relative to A as a function of time.")
      .def(
          "__init__",
          [](PoseDriver* it, BodyId a, BodyId b, const BoundPoseMotion& motion) {
            new (it) PoseDriver(a, b, motion.function);
          },
          kA, kB, nb::arg("motion"),
          nb::sig("def __init__(self, a: BodyId, b: BodyId, motion: PoseMotion | "
                  "collections.abc.Callable[[float], tuple[Pose, Twist, Twist]]) -> None"));
}

std::vector<WirePoint> wire_points(const std::vector<std::pair<BodyId, Vec3>>& pairs) {
  std::vector<WirePoint> points;
  for (const auto& [body, p_BP] : pairs) points.push_back({body, p_BP});
  return points;
}

void bind_wires(nb::module_& m) {
  nb::class_<Rope, Joint>(
      m, "Rope",
      "The way from point to point is never longer than the rope, which slides without friction through the "
      "points between its ends.  Free axis: length [m], with the upper limit from the start; −λ [N] is the "
      "tension.")
      .def(
          "__init__",
          [](Rope* it, const std::vector<std::pair<BodyId, Vec3>>& points, double length, double restitution,
             std::optional<double> stop) { new (it) Rope(wire_points(points), length, restitution, stop); },
          nb::arg("points"), nb::arg("length"), nb::arg("restitution") = 0, nb::arg("stop") = nb::none(),
          "Points as pairs of a body and p_BP [m] from its centre of mass, body axes.  `stop`: the shortest "
          "that a section over guide points becomes [m], None: 0.01 or a hundredth of the length, 0: none.")
      .def_static("between", &Rope::between, kWorld, kA, kB, nb::arg("p_a_W"), nb::arg("p_b_W"),
                  "A rope that is just taut between two world points in the present poses.");
  nb::class_<Pulley, Joint>(m, "Pulley",
                            "A wire from A over points of a third body C to B keeps its length:  φ = |p_C1 − "
                            "p_A| + ratio |p_B − p_C2| "
                            "− L [m].  −λ [N] is the tension on the side of A.")
      .def(
          "__init__",
          [](Pulley* it, const std::vector<std::pair<BodyId, Vec3>>& points, double length, double ratio) {
            if (points.size() != 4) throw std::invalid_argument("pulley: must have four points");
            const std::vector<WirePoint> w = wire_points(points);
            new (it) Pulley(w[0], w[1], w[2], w[3], length, ratio);
          },
          nb::arg("points"), nb::arg("length"), nb::arg("ratio") = 1,
          "Four points, of A, twice of C, and of B, as pairs of a body and p_BP [m].")
      .def_static("at", &Pulley::at, kWorld, kA, nb::arg("p_a_W"), nb::arg("c"), nb::arg("p_c1_W"),
                  nb::arg("p_c2_W"), kB, nb::arg("p_b_W"), nb::arg("ratio") = 1,
                  "The wire through four world points, with the length that it has there.");
}

void bind_couplings(nb::module_& m) {
  nb::class_<Gear, Joint>(m, "Gear", "θ_driven = ratio θ_driving + const.")
      .def(nb::init<const World&, AxisId, AxisId, double>(), kWorld, nb::arg("driving"), nb::arg("driven"),
           nb::arg("ratio"));
  nb::class_<RackAndPinion, Joint>(m, "RackAndPinion",
                                   "Displacement of the rack = radius [m] × angle of the pinion + const.")
      .def(nb::init<const World&, AxisId, AxisId, double>(), kWorld, nb::arg("pinion"), nb::arg("rack"),
           nb::arg("radius"));
  nb::class_<Differential, Joint>(m, "Differential",
                                  "The angle of the case is the mean of those of its two shafts.")
      .def(nb::init<const World&, AxisId, AxisId, AxisId>(), kWorld, nb::arg("input"), nb::arg("left"),
           nb::arg("right"));
  nb::class_<Driver, Joint>(m, "Driver", "A free axis has a prescribed value, θ = f(t).")
      .def(
          "__init__",
          [](Driver* it, const World& world, AxisId axis, const BoundMotion& motion) {
            new (it) Driver(world, axis, motion.function);
          },
          kWorld, nb::arg("axis"), nb::arg("motion"),
          nb::sig("def __init__(self, world: World, axis: AxisId, motion: Motion | "
                  "collections.abc.Callable[[float], tuple[float, float, float]]) -> None"));
}

}  // namespace

void bind_joints(nb::module_& m) {
  bind_point_joints(m);
  bind_axis_joints(m);
  bind_held_joints(m);
  bind_wires(m);
  bind_couplings(m);
}

}  // namespace taut::python
