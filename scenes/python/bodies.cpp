#include <sstream>

#include "core/world/rigid_body.h"
#include "scenes/python/parts.h"

namespace taut::python {
namespace {

/// A mass [kg], or a density [kg/m³]: exactly one of the two.
MassProperties uniform(std::optional<double> mass, std::optional<double> density, const char* solid,
                       auto make) {
  if (mass.has_value() == density.has_value())
    throw std::invalid_argument(std::string(solid) + ": give either a mass or a density");
  return mass ? make(*mass) : make(Density{*density});
}

const auto kMass = nb::arg("mass") = nb::none();

}  // namespace

void bind_bodies(nb::module_& m) {
  using Maybe = std::optional<double>;
  nb::class_<MassProperties>(
      m, "MassProperties",
      "Mass [kg] and rotational inertia [kg m²] about the centre of mass in the axes of the body: a 3×3 "
      "matrix, or three moments along the body axes.  Uniform solids from a mass [kg] or a density "
      "[kg/m³]; lengths in metres.")
      .def(nb::init<double, const Mat3&>(), nb::arg("mass"), nb::arg("inertia_B"))
      .def(nb::init<double, const Vec3&>(), nb::arg("mass"), nb::arg("principal_moments"))
      .def_static(
          "box",
          [](const Vec3& size, Maybe mass, Maybe density) {
            return uniform(mass, density, "box",
                           [&](auto amount) { return MassProperties::box(size, amount); });
          },
          nb::arg("size"), kMass, nb::arg("density") = nb::none(), "Full edge lengths.")
      .def_static(
          "sphere",
          [](double radius, Maybe mass, Maybe density) {
            return uniform(mass, density, "sphere",
                           [&](auto amount) { return MassProperties::sphere(radius, amount); });
          },
          nb::arg("radius"), kMass, nb::arg("density") = nb::none())
      .def_static(
          "ellipsoid",
          [](const Vec3& radii, Maybe mass, Maybe density) {
            return uniform(mass, density, "ellipsoid",
                           [&](auto amount) { return MassProperties::ellipsoid(radii, amount); });
          },
          nb::arg("radii"), kMass, nb::arg("density") = nb::none())
      .def_static(
          "rod",
          [](double length, double radius, Maybe mass, Maybe density) {
            return uniform(mass, density, "rod",
                           [&](auto amount) { return MassProperties::rod(length, radius, amount); });
          },
          nb::arg("length"), nb::arg("radius"), kMass, nb::arg("density") = nb::none(),
          "A cylinder along body x.")
      .def_static(
          "cylinder",
          [](double radius, double length, Maybe mass, Maybe density) {
            return uniform(mass, density, "cylinder",
                           [&](auto amount) { return MassProperties::cylinder(radius, length, amount); });
          },
          nb::arg("radius"), nb::arg("length"), kMass, nb::arg("density") = nb::none(), "Along body z.")
      .def_static(
          "capsule",
          [](double radius, double length, Maybe mass, Maybe density) {
            return uniform(mass, density, "capsule",
                           [&](auto amount) { return MassProperties::capsule(radius, length, amount); });
          },
          nb::arg("radius"), nb::arg("length"), kMass, nb::arg("density") = nb::none(),
          "Along body z, length without the caps.")
      .def_static(
          "cone",
          [](double radius, double height, Maybe mass, Maybe density) {
            return uniform(mass, density, "cone",
                           [&](auto amount) { return MassProperties::cone(radius, height, amount); });
          },
          nb::arg("radius"), nb::arg("height"), kMass, nb::arg("density") = nb::none(),
          "Along body z, apex towards +z, the centre of mass a quarter of the height above the base.")
      .def_prop_ro(
          "mass", [](const MassProperties& it) { return it.mass(); }, "[kg].")
      .def_prop_ro(
          "inertia_B", [](const MassProperties& it) -> Mat3 { return it.inertia_B(); },
          "About the centre of mass, body axes, 3×3 [kg m²].")
      .def_prop_ro(
          "principal_moments", [](const MassProperties& it) -> Vec3 { return it.principal_moments(); },
          "[kg m²].")
      .def_prop_ro(
          "q_BP", [](const MassProperties& it) -> Quat { return it.q_BP(); },
          "Body axes to principal axes, w, x, y, z.")
      .def("__repr__", [](const MassProperties& it) {
        std::ostringstream text;
        text << "MassProperties(mass=" << it.mass() << ", principal_moments=[" << it.principal_moments()[0]
             << ", " << it.principal_moments()[1] << ", " << it.principal_moments()[2] << "])";
        return text.str();
      });
}

}  // namespace taut::python
