#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/variant.h>

#include <filesystem>

#include "collision/contact_finder.h"
#include "collision/mesh/mesh_file.h"
#include "core/world/material.h"
#include "core/world/shape.h"
#include "core/world/solid.h"
#include "scenes/python/parts.h"

namespace taut::python {
namespace {

void bind_primitives(nb::module_& m) {
  nb::class_<Sphere>(m, "Sphere", "A ball.")
      .def(
          "__init__", [](Sphere* it, double radius) { new (it) Sphere{radius}; }, nb::arg("radius"))
      .def_rw("radius", &Sphere::radius, "[m].");
  nb::class_<Box>(m, "Box", "A cuboid with edges along the axes of its frame.")
      .def(
          "__init__", [](Box* it, const Vec3& size) { new (it) Box{size}; }, nb::arg("size"))
      .def_rw("size", &Box::size, "Full edge lengths [m].");
  nb::class_<Capsule>(
      m, "Capsule", "A cylinder along z of this length with a half-sphere at each end; length 0 is a sphere.")
      .def(
          "__init__",
          [](Capsule* it, double radius, double length) {
            new (it) Capsule{radius, length};
          },
          nb::arg("radius"), nb::arg("length"))
      .def_rw("radius", &Capsule::radius, "[m].")
      .def_rw("length", &Capsule::length, "Between the centres of the caps [m].");
  nb::class_<Cylinder>(m, "Cylinder", "A cylinder between z = ±½ length.")
      .def(
          "__init__",
          [](Cylinder* it, double radius, double length) {
            new (it) Cylinder{radius, length};
          },
          nb::arg("radius"), nb::arg("length"))
      .def_rw("radius", &Cylinder::radius, "[m].")
      .def_rw("length", &Cylinder::length, "[m].");
  nb::class_<Ellipsoid>(m, "Ellipsoid", "An ellipsoid with its principal axes along the axes of its frame.")
      .def(
          "__init__", [](Ellipsoid* it, const Vec3& radii) { new (it) Ellipsoid{radii}; }, nb::arg("radii"))
      .def_rw("radii", &Ellipsoid::radii, "Along x, y and z [m].");
  nb::class_<Cone>(m, "Cone", "Apex at z = ¾ height, base at z = −¼ height.")
      .def(
          "__init__",
          [](Cone* it, double radius, double height) {
            new (it) Cone{radius, height};
          },
          nb::arg("radius"), nb::arg("height"))
      .def_rw("radius", &Cone::radius, "Of the base [m].")
      .def_rw("height", &Cone::height, "[m].");
}

void bind_surfaces(nb::module_& m) {
  nb::class_<ConvexHull>(m, "ConvexHull",
                         "The smallest convex body around four or more points, not in one plane [m].")
      .def(
          "__init__",
          [](ConvexHull* it, std::vector<Vec3> points) { new (it) ConvexHull{std::move(points)}; },
          nb::arg("points"))
      .def_rw("points", &ConvexHull::points);
  nb::class_<TriangleMesh>(
      m, "TriangleMesh",
      "Vertices [m] and triangles of three indices each, counter-clockwise seen from outside.  It need not "
      "be closed; only its outside is solid to the touch, and only a closed one has a mass.")
      .def(
          "__init__",
          [](TriangleMesh* it, std::vector<Vec3> vertices, std::vector<std::array<int, 3>> triangles) {
            new (it) TriangleMesh{std::move(vertices), std::move(triangles)};
          },
          nb::arg("vertices"), nb::arg("triangles"))
      .def_rw("vertices", &TriangleMesh::vertices)
      .def_rw("triangles", &TriangleMesh::triangles);
  nb::class_<HalfSpace>(m, "HalfSpace", "All points with z ≤ 0: the ground, with the outward normal +z.")
      .def(nb::init<>());
  nb::class_<HeightField>(
      m, "HeightField",
      "Ground whose height is z = heights[i + nx j] at x = (i − (nx − 1)/2) dx, y = (j − (ny − 1)/2) dy, "
      "linear on two triangles per cell, and solid below.")
      .def(
          "__init__",
          [](HeightField* it, int nx, int ny, double dx, double dy, std::vector<double> heights) {
            new (it) HeightField{nx, ny, dx, dy, std::move(heights)};
          },
          nb::arg("nx"), nb::arg("ny"), nb::arg("dx"), nb::arg("dy"), nb::arg("heights"))
      .def_rw("nx", &HeightField::nx)
      .def_rw("ny", &HeightField::ny)
      .def_rw("dx", &HeightField::dx)
      .def_rw("dy", &HeightField::dy)
      .def_rw("heights", &HeightField::heights);
  m.def(
      "read_mesh",
      [](const std::filesystem::path& file, double scale) { return read_mesh(file.string(), scale); },
      nb::arg("file"), nb::arg("scale") = 1,
      "Reads a TriangleMesh from an OBJ or STL file; coordinates are multiplied by `scale` (1e-3 for "
      "millimetres).");
}

void bind_material(nb::module_& m) {
  nb::class_<Material>(
      m, "Material",
      "What a surface is made of: Newton's restitution from 0 to 1, Coulomb's coefficients while sticking "
      "and "
      "sliding, arms of rolling and spinning friction [m], compliance [m/N] along the normal; 0: rigid. "
      "Beside the arms, friction of turning proportional to the angular velocity: with `..._linear` c [m s] "
      "the torque is c times the normal force times that velocity.")
      .def(
          "__init__",
          [](Material* it, double restitution, double static_friction, double dynamic_friction,
             double rolling_friction, double spinning_friction, double compliance,
             double rolling_friction_linear, double spinning_friction_linear) {
            new (it) Material{.restitution = restitution,
                              .static_friction = static_friction,
                              .dynamic_friction = dynamic_friction,
                              .rolling_friction = rolling_friction,
                              .spinning_friction = spinning_friction,
                              .compliance = compliance,
                              .rolling_friction_linear = rolling_friction_linear,
                              .spinning_friction_linear = spinning_friction_linear};
          },
          nb::arg("restitution") = 0, nb::arg("static_friction") = 0.5, nb::arg("dynamic_friction") = 0.5,
          nb::arg("rolling_friction") = 0, nb::arg("spinning_friction") = 0, nb::arg("compliance") = 0,
          nb::arg("rolling_friction_linear") = 0, nb::arg("spinning_friction_linear") = 0)
      .def_rw("restitution", &Material::restitution)
      .def_rw("static_friction", &Material::static_friction)
      .def_rw("dynamic_friction", &Material::dynamic_friction)
      .def_rw("rolling_friction", &Material::rolling_friction)
      .def_rw("spinning_friction", &Material::spinning_friction)
      .def_rw("compliance", &Material::compliance)
      .def_rw("rolling_friction_linear", &Material::rolling_friction_linear)
      .def_rw("spinning_friction_linear", &Material::spinning_friction_linear)
      .def(
          "__eq__", [](const Material& a, const Material& b) { return a == b; }, nb::is_operator(),
          nb::sig("def __eq__(self, arg: object, /) -> bool"));
  m.def("combined", &combined, nb::arg("a"), nb::arg("b"),
        "The material of the contact between two: the lower restitution, the geometric mean of the Coulomb "
        "coefficients, the "
        "larger arms and linear coefficients of turning, the sum of the compliances.");
  nb::class_<CollisionFilter>(
      m, "CollisionFilter",
      "Who may touch whom: a pair is considered if each one's groups share a bit with the other's mask.")
      .def(
          "__init__",
          [](CollisionFilter* it, std::uint32_t groups, std::uint32_t mask) {
            new (it) CollisionFilter{groups, mask};
          },
          nb::arg("groups") = 1, nb::arg("mask") = 0xffffffffu)
      .def_rw("groups", &CollisionFilter::groups)
      .def_rw("mask", &CollisionFilter::mask);
}

void bind_placed(nb::module_& m) {
  nb::class_<PlacedShape>(m, "PlacedShape",
                          "A shape at a pose X_BS in the frame of a body, with a density [kg/m³].")
      .def(
          "__init__",
          [](PlacedShape* it, Shape shape, const Pose& pose, double density) {
            new (it) PlacedShape{std::move(shape), pose, density};
          },
          nb::arg("shape"), nb::arg("pose") = Pose(), nb::arg("density") = 1000)
      // A copy: another shape in its place may be of another type.
      .def_prop_rw(
          "shape", [](const PlacedShape& it) { return it.shape; },
          [](PlacedShape& it, Shape shape) { it.shape = std::move(shape); }, "A copy.")
      .def_rw("pose", &PlacedShape::pose)
      .def_rw("density", &PlacedShape::density);
  nb::class_<ShapeRecord>(m, "ShapeRecord", "A shape as the World holds it; a copy.")
      .def_ro("body", &ShapeRecord::body)
      .def_prop_ro("shape", [](const ShapeRecord& it) { return *it.shape; })
      .def_ro("pose", &ShapeRecord::pose, "X_BS.")
      .def_ro("material", &ShapeRecord::material)
      .def_ro("filter", &ShapeRecord::filter);
  nb::class_<Solid>(m, "Solid", "Mass properties of one or several shapes on one body.")
      .def_ro("mass", &Solid::mass, "About the centre, in the axes of the frame given.")
      .def_ro("centre", &Solid::centre, "Centre of mass in that frame [m].")
      .def_ro("parts", &Solid::parts,
              "The parts with poses from the centre of mass, as World.add_shape() wants them.");
  nb::class_<SolidProperties>(m, "SolidProperties",
                              "Volume integrals of a uniform solid of density 1, in the frame of its shape.")
      .def_ro("volume", &SolidProperties::volume, "[m³].")
      .def_ro("centre", &SolidProperties::centre, "[m].")
      .def_ro("inertia", &SolidProperties::inertia, "About the centre, 3×3 [m⁵].");
  m.def("solid_properties", &solid_properties, nb::arg("shape"),
        "Closed forms for the primitives, exact sums for hulls and closed meshes.");
  m.def(
      "have_contacts", &have_contacts, nb::arg("a"), nb::arg("b"),
      "Whether there are contacts between two shapes; not between two surfaces of triangles or two grounds.");
  m.def(
      "solid_of", [](const std::vector<PlacedShape>& parts) { return solid_of(parts); }, nb::arg("parts"),
      "Sum of the parts by their densities; where they overlap, the overlap counts twice.");
}

}  // namespace

void bind_shapes(nb::module_& m) {
  bind_primitives(m);
  bind_surfaces(m);
  bind_material(m);
  bind_placed(m);
}

}  // namespace taut::python
