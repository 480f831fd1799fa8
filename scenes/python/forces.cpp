#include <optional>

#include "core/state/force.h"
#include "scenes/python/arrays.h"
#include "scenes/python/callbacks.h"
#include "scenes/python/parts.h"

namespace taut::python {
namespace {

/// A State of its own, so that nothing a callback keeps is stale.
nb::object copied(const State& state) { return nb::cast(State(state)); }

/// Calls a Python function with a state and a zeroed array, and adds what that is then.
struct WrenchFunction {
  HeldObject function;

  void operator()(const State& state, std::span<Wrench> wrenches) const {
    const nb::gil_scoped_acquire gil;
    auto added = owning(std::vector<double>(6 * wrenches.size()), 6);
    const double* const values = added.data();
    const nb::object array = nb::cast(std::move(added));
    const nb::object result = function.get()(copied(state), array);
    if (!result.is_none()) throw nb::type_error("a force must add to its second argument and return None");
    for (std::size_t b = 0; b < wrenches.size(); ++b) {
      const double* const row = values + 6 * b;
      wrenches[b].torque += Vec3(row[0], row[1], row[2]);
      wrenches[b].force += Vec3(row[3], row[4], row[5]);
    }
  }
};

struct PotentialFunction {
  HeldObject function;

  double operator()(const State& state) const {
    const nb::gil_scoped_acquire gil;
    const nb::object result = function.get()(copied(state));
    double energy = 0;
    if (!nb::try_cast(result, energy)) throw nb::type_error("a potential must return a number");
    return energy;
  }
};

}  // namespace

void bind_forces(nb::module_& m) {
  const auto function_of = [](const std::optional<BoundMotion>& factor) {
    return factor ? factor->function : Motion();
  };
  nb::class_<PointForce, Force>(
      m, "PointForce",
      "Force [N] at point P of a body (from its centre of mass, body axes [m]), in world axes; with "
      "follows_body in body axes.  Constant, or times a factor, a function of time (Motion).  Potential "
      "−f·p_WP, none for a follower or with a factor.")
      .def(
          "__init__",
          [function_of](PointForce* it, BodyId body, const Vec3& p_BP, const Vec3& force, bool follows_body,
                        std::optional<BoundMotion> factor) {
            new (it) PointForce(body, p_BP, force, follows_body, function_of(factor));
          },
          nb::arg("body"), nb::arg("p_BP"), nb::arg("force"), nb::arg("follows_body") = false,
          nb::arg("factor") = nb::none());
  nb::class_<BodyTorque, Force>(m, "BodyTorque",
                                "Torque [N·m] in world axes, or with follows_body in body axes; constant, or "
                                "times a factor, a function of time (Motion).")
      .def(
          "__init__",
          [function_of](BodyTorque* it, BodyId body, const Vec3& torque, bool follows_body,
                        std::optional<BoundMotion> factor) {
            new (it) BodyTorque(body, torque, follows_body, function_of(factor));
          },
          nb::arg("body"), nb::arg("torque"), nb::arg("follows_body") = false,
          nb::arg("factor") = nb::none());
  nb::class_<AccelerationField, Force>(
      m, "AccelerationField",
      "A field of acceleration a [m/s²], world axes, on bodies given with their masses (body, mass [kg]): "
      "the "
      "force m a, constant or times a factor, a function of time (Motion).  A frame that shakes with the "
      "acceleration x¨ is the field −x¨.")
      .def(
          "__init__",
          [function_of](AccelerationField* it, const std::vector<std::pair<BodyId, double>>& masses,
                        const Vec3& acceleration, std::optional<BoundMotion> factor) {
            std::vector<FieldMass> its;
            for (const auto& [body, mass] : masses) its.push_back({body, mass});
            new (it) AccelerationField(std::move(its), acceleration, function_of(factor));
          },
          nb::arg("masses"), nb::arg("acceleration"), nb::arg("factor") = nb::none());
  nb::class_<SpringDamper, Force>(
      m, "SpringDamper",
      "Spring and damper between point P of A and point Q of B, L = |p_WQ − p_WP|: tension k (L − L₀) + c "
      "dL/dt "
      "[N] along the line, or both parts by the tables of an AxisSpring over the distance.")
      .def(nb::init<BodyId, BodyId, const Vec3&, const Vec3&, double, double, double>(), nb::arg("a"),
           nb::arg("b"), nb::arg("p_AP"), nb::arg("p_BQ"), nb::arg("stiffness"), nb::arg("rest_length"),
           nb::arg("damping") = 0)
      .def(nb::init<BodyId, BodyId, const Vec3&, const Vec3&, AxisSpring>(), nb::arg("a"), nb::arg("b"),
           nb::arg("p_AP"), nb::arg("p_BQ"), nb::arg("law"));
  nb::class_<ForceCallback, Force>(
      m, "ForceCallback",
      "Any law in Python: function(state, wrenches) adds to `wrenches`, n×6: torque x, y, z about the centre "
      "of mass [N·m], "
      "then force x, y, z [N], world axes, one row per body.  It must depend on its arguments alone: solvers "
      "call it at trial "
      "states too.  What it raises comes out of step(), and the world is then as before it.  With "
      "`depends_on_velocity` "
      "False it is not asked twice a step; potential(state) returns an energy [J].")
      .def(
          "__init__",
          [](ForceCallback* it, nb::callable function, bool depends_on_velocity,
             std::optional<nb::callable> potential) {
            std::function<double(const State&)> energy;
            if (potential) energy = PotentialFunction{HeldObject(std::move(*potential))};
            new (it) ForceCallback(WrenchFunction{HeldObject(std::move(function))}, depends_on_velocity,
                                   std::move(energy));
          },
          nb::arg("function"), nb::arg("depends_on_velocity") = true, nb::arg("potential") = nb::none());
}

}  // namespace taut::python
