#include <nanobind/stl/array.h>

#include <cctype>

#include "core/axes/axis.h"
#include "core/world/joint_properties.h"
#include "scenes/python/callbacks.h"
#include "scenes/python/parts.h"

namespace taut::python {
namespace {

/// A function of time that calls one of Python, which returns the parts of a Point, or else raises
/// `complaint`.
template <typename Point, typename... Parts>
auto that_calls(nb::callable function, const char* complaint) {
  return [held = HeldObject(std::move(function)), complaint](double time) {
    const nb::gil_scoped_acquire gil;
    const nb::object result = held.get()(time);
    std::tuple<Parts...> parts;
    if (!nb::try_cast(result, parts)) throw nb::type_error(complaint);
    return std::apply([](const Parts&... part) { return Point{part...}; }, parts);
  };
}

Motion motion_that_calls(nb::callable function) {
  return that_calls<MotionPoint, double, double, double>(std::move(function),
                                                         "a motion must return (value, rate, acceleration)");
}

PoseMotion pose_motion_that_calls(nb::callable function) {
  return that_calls<PosePoint, Pose, Twist, Twist>(
      std::move(function),
      "a motion of a pose must return (Pose, Twist of velocities, Twist of accelerations)");
}

void bind_motions(nb::module_& m) {
  nb::class_<BoundMotion>(
      m, "Motion",
      "A function of time f(t) with its first two derivatives.  Wherever one is wanted, a callable that "
      "returns (value, rate, acceleration) will do.")
      .def(
          "__init__",
          [](BoundMotion* motion, nb::callable function) {
            new (motion) BoundMotion{motion_that_calls(std::move(function))};
          },
          nb::arg("function"))
      .def(
          "__call__",
          [](const BoundMotion& motion, double time) {
            const MotionPoint at = motion.function(time);
            return std::tuple(at.value, at.rate, at.acceleration);
          },
          nb::arg("time"), "(f, ḟ, f̈) at a time [s].");
  nb::implicitly_convertible<nb::callable, BoundMotion>();
  m.def(
      "linear_motion",
      [](double value, double rate, double start) { return BoundMotion{linear_motion(value, rate, start)}; },
      nb::arg("value"), nb::arg("rate"), nb::arg("start") = 0, "f(t) = value + rate (t − start).");
  m.def(
      "harmonic_motion",
      [](double mean, double amplitude, double omega, double phase) {
        return BoundMotion{harmonic_motion(mean, amplitude, omega, phase)};
      },
      nb::arg("mean"), nb::arg("amplitude"), nb::arg("omega"), nb::arg("phase") = 0,
      "f(t) = mean + amplitude sin(omega t + phase), omega [rad/s], phase [rad].");
  m.def(
      "spline_motion",
      [](const std::vector<double>& times, const std::vector<double>& values) {
        return BoundMotion{spline_motion(times, values)};
      },
      nb::arg("times"), nb::arg("values"),
      "A cubic spline through (time, value), with straight lines before and after it.");
  m.def(
      "speed_motion",
      [](const Curve& speed, double value) { return BoundMotion{speed_motion(speed, value)}; },
      nb::arg("speed"), nb::arg("value"),
      "A velocity given by points (linear between them, held beyond): `value` at the first point, then its "
      "exact integral.");

  m.def(
      "harmonics_motion",
      [](double mean, const std::vector<std::tuple<double, double, double>>& terms) {
        std::vector<Harmonic> harmonics;
        for (const auto& [amplitude, omega, phase] : terms) harmonics.push_back({amplitude, omega, phase});
        return BoundMotion{harmonics_motion(mean, std::move(harmonics))};
      },
      nb::arg("mean"), nb::arg("terms"),
      "f(t) = mean + Σ amplitude sin(omega t + phase) over terms (amplitude, omega [rad/s], phase [rad]).");
  m.def(
      "table_motion",
      [](const Curve& table, bool periodic) { return BoundMotion{table_motion(table, periodic)}; },
      nb::arg("table"), nb::arg("periodic") = false,
      "Piecewise linear, held beyond the ends or repeated.  Its rate jumps at the points.");
  m.def(
      "ramp_motion",
      [](double from, double to, double start, double duration, bool smooth) {
        return BoundMotion{ramp_motion(from, to, start, duration, smooth)};
      },
      nb::arg("from_"), nb::arg("to"), nb::arg("start"), nb::arg("duration"), nb::arg("smooth") = false,
      "From one value to another, linear or, with smooth, by half a cosine.");
  m.def(
      "gust_motion",
      [](double peak, double start, double duration) {
        return BoundMotion{gust_motion(peak, start, duration)};
      },
      nb::arg("peak"), nb::arg("start"), nb::arg("duration"),
      "peak ½ (1 − cos 2π (t − start)/duration) from start on for the duration, otherwise 0.");

  nb::class_<BoundPoseMotion>(
      m, "PoseMotion",
      "A pose as a function of time, of one body relative to another.  Wherever one is wanted, a "
      "callable that returns (pose, velocity, acceleration) will do: Pose, Twist (ω, ṗ) and Twist (ω̇, "
      "p̈) in the axes of the other body.")
      .def(
          "__init__",
          [](BoundPoseMotion* motion, nb::callable function) {
            new (motion) BoundPoseMotion{pose_motion_that_calls(std::move(function))};
          },
          nb::arg("function"))
      .def(
          "__call__",
          [](const BoundPoseMotion& motion, double time) {
            const PosePoint at = motion.function(time);
            return std::tuple(at.pose, at.velocity, at.acceleration);
          },
          nb::arg("time"), "(pose, velocity, acceleration) at a time [s].");
  nb::implicitly_convertible<nb::callable, BoundPoseMotion>();
  m.def(
      "pose_motion",
      [](const std::array<std::optional<BoundMotion>, 3>& position,
         const std::vector<std::pair<Vec3, BoundMotion>>& turns, const Quat& orientation) {
        std::array<Motion, 3> along;
        for (int i = 0; i < 3; ++i)
          if (position[i]) along[i] = position[i]->function;
        std::vector<Turning> turnings;
        for (const auto& [axis, angle] : turns) turnings.push_back({axis, angle.function});
        return BoundPoseMotion{pose_motion(along, std::move(turnings), orientation)};
      },
      nb::arg("position"), nb::arg("turns") = std::vector<std::pair<Vec3, BoundMotion>>(),
      nb::arg("orientation") = Quat(1, 0, 0, 0),
      "p(t) along the axes of the other body, and q(t) = exp(a₁ θ₁(t)) exp(a₂ θ₂(t)) … orientation (w, x, y, "
      "z).  "
      "`position`: three motions or None (0); `turns`: pairs of a unit axis and a motion of its angle.");
}

void bind_curve(nb::module_& m) {
  nb::class_<Curve>(m, "Curve", "A function given by points (x, y) with increasing x, linear between them.")
      .def(
          "__init__",
          [](Curve* curve, const std::vector<std::pair<double, double>>& points) {
            std::vector<Curve::Point> all;
            for (const auto& [x, y] : points) all.push_back({x, y});
            new (curve) Curve(std::move(all));
          },
          nb::arg("points"))
      .def("held", &Curve::held, nb::arg("x"), "Value at x, held constant beyond the ends.")
      .def("extended", &Curve::extended, nb::arg("x"),
           "Value at x, where the first and last piece go on beyond the ends.")
      .def_prop_ro(
          "points",
          [](const Curve& curve) {
            std::vector<std::pair<double, double>> points;
            for (const Curve::Point& p : curve.points()) points.emplace_back(p.x, p.y);
            return points;
          },
          "As given.");
}

/// A field, one that may be None as a copy: what is there may go.
template <typename Property, typename Value>
void def_field(nb::class_<Property>& c, const AxisField<Property, Value>& field) {
  c.def_rw(field.name(), field.member, field.notes.text);
}
template <typename Property, typename Value>
void def_field(nb::class_<Property>& c, const AxisField<Property, std::optional<Value>>& field) {
  c.def_prop_rw(
      field.name(), [member = field.member](const Property& it) { return it.*member; },
      [member = field.member](Property& it, std::optional<Value> value) { it.*member = std::move(value); },
      nb::for_setter(nb::arg("value").none()), field.notes.text);
}

template <typename Property, typename Value>
auto with_default(const AxisField<Property, Value>& field) {
  return nb::arg(field.name()) = Property{}.*field.member;
}
template <typename Property, typename Value>
auto with_default(const AxisField<Property, std::optional<Value>>& field) {
  return nb::arg(field.name()) = nb::none();
}

template <typename Property>
void def_init(nb::class_<Property>& c) {
  Property::fields([&]<typename... Fields>(const Fields&... field) {
    c.def(
        "__init__",
        [](Property* it, typename Fields::Type... values) {
          Property made;
          Property::fields([&](const Fields&... its) { ((made.*its.member = std::move(values)), ...); });
          new (it) Property(std::move(made));
        },
        with_default(field)...);
  });
}
/// A mode and a trajectory are no fields.
template <>
void def_init<AxisMotor>(nb::class_<AxisMotor>& c) {
  nb::enum_<AxisMotor::Mode>(c, "Mode", "What the motor keeps.")
      .value("VELOCITY", AxisMotor::Mode::kVelocity)
      .value("POSITION", AxisMotor::Mode::kPosition)
      .value("TRAJECTORY", AxisMotor::Mode::kTrajectory);
  c.def(
       "__init__",
       [](AxisMotor* it, AxisMotor::Mode mode, double target, double max_force, double max_speed,
          std::optional<Curve> force_of_speed, std::optional<BoundMotion> trajectory, double stiffness,
          double damping, bool pulls_only) {
         new (it) AxisMotor{mode,
                            target,
                            max_force,
                            max_speed,
                            std::move(force_of_speed),
                            trajectory ? trajectory->function : Motion(),
                            stiffness,
                            damping,
                            pulls_only};
       },
       nb::arg("mode") = AxisMotor::Mode::kVelocity, nb::arg("target") = 0, nb::arg("max_force") = kUnlimited,
       nb::arg("max_speed") = kUnlimited, nb::arg("force_of_speed") = nb::none(),
       nb::arg("trajectory") = nb::none(), nb::arg("stiffness") = 0, nb::arg("damping") = 0,
       nb::arg("pulls_only") = false,
       nb::sig("def __init__(self, mode: Mode = ..., target: float = 0.0, "
               "max_force: float = float('inf'), max_speed: float = float('inf'), force_of_speed: Curve | "
               "None = None, trajectory: Motion | collections.abc.Callable[[float], tuple[float, float, "
               "float]] | None = None, stiffness: float = 0.0, damping: float = 0.0, pulls_only: bool = "
               "False) -> None"))
      .def_static("winch", &AxisMotor::winch, nb::arg("rate"), nb::arg("max_force") = kUnlimited,
                  "A winch on the length of a rope: winds it with this rate [m/s], < 0 shortens it.")
      .def_rw("mode", &AxisMotor::mode);
}

/// "AxisSpring" for "spring".
std::string class_name(const char* key) {
  std::string name = "Axis";
  bool begins = true;
  for (const char* letter = key; *letter; ++letter) {
    if (*letter != '_')
      name += begins ? static_cast<char>(std::toupper(static_cast<unsigned char>(*letter))) : *letter;
    begins = *letter == '_';
  }
  return name;
}

template <typename Property>
void bind_property(nb::module_& m) {
  nb::class_<Property> c(m, class_name(Property::kFacts.key).c_str(), Property::kFacts.text);
  def_init<Property>(c);
  each_axis_field<Property>([&](const auto& field) { def_field(c, field); });
}

template <typename... Properties>
void bind_properties(nb::module_& m, AxisTypes<Properties...>) {
  for_axis_types_backward([&]<typename Property>() { bind_property<Property>(m); });
  nb::class_<AxisProperties> c(m, "AxisProperties",
                               "All that acts along one axis; None where there is nothing.");
  c.def(
      "__init__",
      [](AxisProperties* it, std::optional<Properties>... values) {
        AxisProperties made;
        (made.set(std::move(values)), ...);
        new (it) AxisProperties(std::move(made));
      },
      (nb::arg(Properties::kFacts.key) = nb::none())...);
  (c.def_prop_ro(Properties::kFacts.key, [](const AxisProperties& it) { return it.get<Properties>(); }), ...);
}

void bind_erp_and_cfm(nb::module_& m) {
  m.def(
      "from_erp_cfm",
      [](double erp, double cfm, double dt) {
        const ComplianceDamping spring = from_erp_cfm(erp, cfm, dt);
        return std::pair(spring.compliance, spring.damping);
      },
      nb::arg("erp"), nb::arg("cfm"), nb::arg("dt"),
      "(compliance, damping) of the spring and damper that error reduction and constraint force mixing stand "
      "for at a step of "
      "dt: erp = h k/(h k + c), cfm = 1/(h k + c).");
  m.def(
      "to_erp_cfm",
      [](double compliance, double damping, double dt) {
        const ErpCfm both = to_erp_cfm({compliance, damping}, dt);
        return std::pair(both.erp, both.cfm);
      },
      nb::arg("compliance"), nb::arg("damping"), nb::arg("dt"), "(erp, cfm): the inverse of from_erp_cfm().");
}

void bind_joint_properties(nb::module_& m) {
  nb::class_<BreakLimits>(
      m, "BreakLimits",
      "The joint leaves when the force [N] or the torque about its anchor on B [N·m] of its reaction on B "
      "exceeds one of these, on the mean over a sub-step.")
      .def(
          "__init__",
          [](BreakLimits* it, double force, double torque) {
            new (it) BreakLimits{force, torque};
          },
          nb::arg("force") = kUnlimited, nb::arg("torque") = kUnlimited)
      .def_rw("force", &BreakLimits::force)
      .def_rw("torque", &BreakLimits::torque);
  nb::class_<JointCompliance>(
      m, "JointCompliance",
      "The rows of a joint give way as springs [m/N, rad/(N·m)] and dampers [N·s/m, N·m·s/rad]; 0: rigid, "
      "infinite: damper only.")
      .def(
          "__init__",
          [](JointCompliance* it, double translation, double rotation, double translation_damping,
             double rotation_damping) {
            new (it) JointCompliance{translation, rotation, translation_damping, rotation_damping};
          },
          nb::arg("translation") = 0, nb::arg("rotation") = 0, nb::arg("translation_damping") = 0,
          nb::arg("rotation_damping") = 0)
      .def_rw("translation", &JointCompliance::translation)
      .def_rw("rotation", &JointCompliance::rotation)
      .def_rw("translation_damping", &JointCompliance::translation_damping)
      .def_rw("rotation_damping", &JointCompliance::rotation_damping);
}

}  // namespace

void bind_axes(nb::module_& m) {
  bind_motions(m);
  bind_curve(m);
  bind_properties(m, AllAxisProperties{});
  bind_joint_properties(m);
  bind_erp_and_cfm(m);
}

}  // namespace taut::python
